"""Whether two checkouts plan the same: every example nest under every shipped profile, files compared byte by byte.

Usage: python benchmarks/same_plans.py OTHER [--work W] [--nest FILE …] [--profile NAME …] [--kept FOLDER]

OTHER is an earlier checkout; this file's own is the other side. Both are run by this Python, each as its own program.
Kernels are compiled once for each side, and found compiled by a later run where --kept names the same folder.
Prints a line for each nest and profile; exit code 1 if any file, message or exit code differs.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from kerfwise.benchmarks.checkout import Checkout

HERE = Path(__file__).resolve().parents[1]
NESTS = HERE / "examples" / "nests"
OUT = ("-o", "made.nc", "--plan", "made.plan.json", "--picture", "made.svg")
MAIN = "from kerfwise.cli import main; main()"


def solved(checkout: Checkout, nest: Path, profile: str, work: float) -> dict[str, bytes]:
    """What one checkout makes of a nest: file name → bytes, and under "exit", "said" how it ended and its words."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        words = ["-c", MAIN, "solve", str(nest), "-p", profile, "--work", f"{work:g}", *OUT]
        done = checkout.run(words, "warm", out)
        made = {file.name: file.read_bytes() for file in sorted(out.iterdir())}
        return {**made, "exit": b"%d" % done.returncode, "said": _steady(f"{done.stdout}{done.stderr}".encode())}


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
    parser.add_argument("--kept", type=Path, metavar="FOLDER")
    given = parser.parse_args()
    differ = 0
    with tempfile.TemporaryDirectory() as folder:
        kept = (given.kept or Path(folder)).resolve()
        before, after = Checkout(given.other.resolve(), kept / "before"), Checkout(HERE, kept / "after")
        for nest in (nest.resolve() for nest in given.nest if nest.suffix in (".json", ".dxf", ".svg")):
            for profile in given.profile:
                one, two = (solved(side, nest, profile, given.work) for side in (before, after))
                unlike = sorted(name for name in {*one, *two} if one.get(name) != two.get(name))
                differ += bool(unlike)
                files = ", ".join(sorted({*two} - {"exit", "said"})) or "refused"
                told = f"DIFFERS in {', '.join(unlike)}" if unlike else "same"
                print(f"{nest.name} {profile}: {told} ({files})", flush=True)
    sys.exit(1 if differ else 0)


if __name__ == "__main__":
    main()
