"""The command line answers at once: nothing heavy is imported for help."""

from __future__ import annotations

import subprocess
import sys

HEAVY = ("numpy", "shapely", "numba", "ortools", "matplotlib", "ezdxf", "svgelements", "scipy", "rich", "yaml")


def test_help_imports_nothing_heavy() -> None:
    script = (
        "import sys\n"
        "from kerfwise.cli import main\n"
        "try: main(['--help'])\n"
        "except SystemExit as end: assert end.code == 0, end.code\n"
        f"print([m for m in {HEAVY!r} if m in sys.modules], file=sys.stderr)\n"
    )
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert "solve" in run.stdout
    assert run.stderr.strip() == "[]"
