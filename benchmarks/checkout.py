"""A checkout of kerfwise, run by this Python in processes of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path


class Checkout:
    """A checkout under the name of the package, with compiled Python files and kernels of its own in a folder.

    What is compiled there is found again as long as the folder is.
    """

    def __init__(self, tree: Path, folder: Path) -> None:
        self.tree, self.folder, self.package = tree, folder, folder / "package"
        self.package.mkdir(parents=True, exist_ok=True)
        link = self.package / "kerfwise"
        if link.is_symlink():
            link.unlink()
        link.symlink_to(tree, target_is_directory=True)

    def run(
        self, words: Sequence[str], kept: str = "warm", cwd: Path | None = None
    ) -> subprocess.CompletedProcess[str]:
        """Run Python with what was compiled under a name; whether it ended well is not looked at."""
        places = {
            "PYTHONPATH": str(self.package),
            "PYTHONPYCACHEPREFIX": str(self.folder / kept / "python"),
            "NUMBA_CACHE_DIR": str(self.folder / kept / "kernels"),
        }
        unset = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
        return subprocess.run(
            [sys.executable, *words],
            cwd=cwd or self.folder,
            env={**unset, **places},
            capture_output=True,
            encoding="utf-8",
            check=False,
        )
