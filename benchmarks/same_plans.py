"""Whether two checkouts plan the same: every example nest under every shipped profile, files compared byte by byte.

Usage: python benchmarks/same_plans.py OTHER [--work W] [--nest FILE …] [--profile NAME …]

OTHER is an earlier checkout; this file's own is the other side. Both are run by this Python, each as its own program.
Prints a line for each nest and profile; exit code 1 if any file, message or exit code differs.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parents[1]
NESTS = HERE / "examples" / "nests"
OUT = ("-o", "made.nc", "--plan", "made.plan.json", "--picture", "made.svg")
MAIN = "from kerfwise.cli import main; main()"


def solved(checkout: Path, nest: Path, profile: str, work: float) -> dict[str, bytes]:
    """What one checkout makes of a nest: file name → bytes, and under "exit", "said" how it ended and its words."""
    with tempfile.TemporaryDirectory() as folder:
        package = Path(folder) / "package"
        package.mkdir()
        (package / "kerfwise").symlink_to(checkout, target_is_directory=True)
        out = Path(folder) / "out"
        out.mkdir()
        done = subprocess.run(
            [sys.executable, "-c", MAIN, "solve", str(nest), "-p", profile, "--work", f"{work:g}", *OUT],
            cwd=out,
            env={**os.environ, "PYTHONPATH": str(package)},
            capture_output=True,
            check=False,
        )
        made = {file.name: file.read_bytes() for file in sorted(out.iterdir())}
        return {**made, "exit": b"%d" % done.returncode, "said": _steady(done.stdout + done.stderr)}


def _steady(said: bytes) -> bytes:
    """Without lines that tell seconds of this run."""
    return b"\n".join(line for line in said.splitlines() if b" s " not in line and not line.endswith(b" s"))


def main() -> None:
    """Compare, print, and say by the exit code whether all is the same."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("other", type=Path)
    parser.add_argument("--work", type=float, default=2.0)
    parser.add_argument("--nest", type=Path, nargs="*", default=sorted(p for p in NESTS.iterdir() if p.suffix != ".md"))
    parser.add_argument(
        "--profile", nargs="*", default=sorted(p.stem for p in (HERE / "rules").rglob("shipped/*.yaml"))
    )
    given = parser.parse_args()
    differ = 0
    for nest in given.nest:
        if nest.suffix not in (".json", ".dxf", ".svg"):
            continue
        for profile in given.profile:
            one, two = (solved(tree, nest.resolve(), profile, given.work) for tree in (given.other.resolve(), HERE))
            unlike = sorted(name for name in {*one, *two} if one.get(name) != two.get(name))
            differ += bool(unlike)
            files = ", ".join(sorted({*two} - {"exit", "said"})) or "refused"
            print(
                f"{nest.name} {profile}: {'DIFFERS in ' + ', '.join(unlike) if unlike else 'same'} ({files})",
                flush=True,
            )
    sys.exit(1 if differ else 0)


if __name__ == "__main__":
    main()
