"""How long the check takes to read programs back, in seconds of the processor.

Usage: python -m kerfwise.tests.postproc.check_speed [--contours 115 1000] [--beside FOLDER] [--whole]

Plates of examples/gen_sheet.py (seed 1) are cut row by row, each contour once. A second program of each has up to five
outlines in a burn, with straight links where these lead through waste. Measured is the time from what the program burns
to cuts of contours, with --whole that of the whole check. --beside names a
folder that holds another version of the package, to be measured in the same run; it judges the plain program only.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import kerfwise
from kerfwise import Nest
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.postproc.nc.program import write_program
from kerfwise.rules.profile.load import load_profile
from kerfwise.tests.postproc.chains import chained, cuts_in_rows
from kerfwise.tests.postproc.plans import plan_of

HERE = str(Path(kerfwise.__file__).parents[1])
MEASURED = """\
import sys, time
from kerfwise.encoder.readers import ReadOptions, read_nest
from kerfwise.postproc.check import check_program
from kerfwise.postproc.check.reader.read_program import read_on_machine
from kerfwise.postproc.check.cuts_from_program import rebuild
from kerfwise.rules.profile.load import load_profile

nest, profile = read_nest(sys.argv[1], ReadOptions()), load_profile()
text, whole = open(sys.argv[2], encoding="utf-8").read(), sys.argv[3] == "whole"
program = read_on_machine(text, nest, profile)
begun = time.process_time()
if whole:
    check_program(nest, text, profile)
else:
    cuts = rebuild(nest, program, profile.material.kerf_mm, (0.0, 0.0)).cuts
    assert len(cuts) == len(nest.contours), len(cuts)
print(time.process_time() - begun)
"""


def measured_s(folder: str, nest: Path, program: Path, whole: bool) -> float:
    """Seconds of the processor, by the package in a folder, in a process of its own."""
    words = [sys.executable, "-c", MEASURED, str(nest), str(program), "whole" if whole else "cuts"]
    done = subprocess.run(words, env={**os.environ, "PYTHONPATH": folder}, check=True, capture_output=True, text=True)
    return float(done.stdout.split()[-1])


def programs(nest: Nest) -> tuple[str, str, int]:
    """A program of single contours, one with chains, and how many links that has."""
    profile = load_profile()
    kerf_mm = profile.material.kerf_mm
    plain = write_program(plan_of(nest, cuts_in_rows(nest, kerf_mm, ways=6), profile), nest, profile)
    chains = chained(plain, nest, kerf_mm, 5)
    return plain, chains.text, len(nest.contours) - len(chains.burns)


def rows(contours: int, beside: str | None, whole: bool) -> list[str]:
    """The lines of one plate's table."""
    made = json.dumps(make_sheet(1, contours)).encode()
    nest = read_json(made, ReadOptions())
    plain, chains, links = programs(nest)
    with tempfile.TemporaryDirectory() as name:
        drawn, one, other = (Path(name) / file for file in ("nest.json", "plain.nc", "chains.nc"))
        drawn.write_bytes(made)
        one.write_text(plain, encoding="utf-8")
        other.write_text(chains, encoding="utf-8")
        found = [(f"{contours} contours", one, HERE), (f"{contours} contours, {links} links", other, HERE)]
        found += [(f"{contours} contours, the version beside", one, beside)] if beside else []
        return [f"| {what} | {measured_s(folder, drawn, file, whole):.2f} |" for what, file, folder in found]


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--contours", type=int, nargs="+", default=[115, 1000])
    parser.add_argument("--beside", help="a folder that holds another version of the package")
    parser.add_argument("--whole", action="store_true", help="measure the whole check")
    given = parser.parse_args(arguments)
    print("| program | processor, s |\n|---|---:|")
    for contours in given.contours:
        print("\n".join(rows(contours, given.beside, given.whole)), flush=True)


if __name__ == "__main__":
    main()
