"""Inputs that are larger, rougher or more broken than a plant's: how long each takes, and how it ends.

Usage: python benchmarks/bounded_work.py [--case NAME …]

Makes the files in a folder of its own, gives each to the command line in a process of its own, and prints a table:
processor seconds (of all threads, the start of Python counted), the most memory, the exit code, and the last words.
"""

from __future__ import annotations

import argparse
import gzip
import json
import math
import os
import random
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from kerfwise.rules.case import Rows, circle, rect

WORDS = 90
"""Characters of a message that the table shows."""
HEAD = """\
| input | given to | processor, s | memory, MB | ends with | and says |
|---|---|---:|---:|---:|---|
"""
CHILD = """
import atexit, sys, time
def told():
    from kerfwise.apps.bench.bench_child import peak_mb
    sys.__stderr__.write(f"\\nused {time.process_time():.1f} {peak_mb():.0f}\\n")
atexit.register(told)
from kerfwise.cli import main
main()
"""
PROFILE = "name: shop\nbased_on: plasma-carbon-steel\nsmall_holes: {min_hole: 1 mm}\n"


@dataclass(frozen=True)
class Case:
    """An input: what makes its files in a folder, and the words that follow `kerfwise`."""

    name: str
    make: Callable[[Path], None]
    words: tuple[str, ...]


@dataclass(frozen=True)
class Used:
    """What a case took, and how it ended."""

    cpu_s: float
    memory_mb: float
    code: int
    said: str


def ring(count: int, noise_mm: float) -> Rows:
    """A circle of 400 mm radius in so many vertices, each as far off as noise has it."""
    rng = random.Random(1)
    radii = [400 + rng.uniform(-noise_mm, noise_mm) for _ in range(count)]
    turns = [math.tau * k / count for k in range(count)]
    return [
        (round(500 + r * math.cos(a), 4), round(500 + r * math.sin(a), 4)) for r, a in zip(radii, turns, strict=True)
    ]


def star(points: int) -> Rows:
    """A star with so many points, two vertices for each."""
    radii = [450 if k % 2 == 0 else 225 for k in range(2 * points)]
    return [
        (500 + r * math.cos(math.pi * k / points), 500 + r * math.sin(math.pi * k / points))
        for k, r in enumerate(radii)
    ]


def zigzag(count: int) -> Rows:
    """A ring that crosses itself about so many times squared."""
    across = [(20 + k * 900 / count, 20 if k % 2 else 400) for k in range(count)]
    return [*across, *((20 if k % 2 else 920, 20 + 380 * k / count) for k in range(count))]


def nest(folder: Path, width: float, height: float, *parts: tuple[Rows, list[Rows]]) -> None:
    """Write `nest.json` with parts of an outline and holes each."""
    listed = [{"id": f"P{k}", "outer": outer, "holes": holes} for k, (outer, holes) in enumerate(parts, 1)]
    text = {"format": "kerfwise-nest/1", "sheet": {"width": width, "height": height}, "parts": listed}
    (folder / "nest.json").write_text(json.dumps(text), encoding="utf-8", newline="\n")


def one_part(outer: Rows) -> Callable[[Path], None]:
    """A nest of one part on a sheet of a metre."""
    return lambda folder: nest(folder, 1000, 1000, (outer, []))


def perforated(count: int, across_mm: float) -> Callable[[Path], None]:
    """A plate with so many round holes, and a profile that lets holes be small."""

    def make(folder: Path) -> None:
        columns = math.ceil(math.sqrt(count))
        side_mm = 30.0 * columns + 80
        holes = [circle(60 + 30 * (k % columns), 60 + 30 * (k // columns), across_mm / 2) for k in range(count)]
        nest(folder, side_mm + 40, side_mm + 40, (rect(20, 20, side_mm, side_mm), holes))
        (folder / "shop.yaml").write_text(PROFILE, encoding="utf-8", newline="\n")

    return make


def grid(count: int) -> Callable[[Path], None]:
    """So many parts of 30 x 30 mm, 10 mm apart."""

    def make(folder: Path) -> None:
        columns = math.ceil(math.sqrt(2 * count))
        rows = math.ceil(count / columns)
        squares: list[tuple[Rows, list[Rows]]]
        squares = [(rect(20 + 40 * (k % columns), 20 + 40 * (k // columns), 30, 30), []) for k in range(count)]
        nest(folder, 40 * columns + 40, 40 * rows + 40, *squares)

    return make


def in_one_place(folder: Path) -> None:
    """The same square drawn 3,000 times."""
    nest(folder, 300, 300, *((rect(20, 20, 50, 50), []) for _ in range(3000)))


def styled(folder: Path) -> None:
    """An SVG with 55 kB of style that no pattern should be tried on."""
    page = 'xmlns="http://www.w3.org/2000/svg" width="300mm" height="300mm" viewBox="0 0 300 300"'
    body = f'<style>{"a{" * 27_500}</style><g id="cut"><rect x="50" y="50" width="90" height="90"/></g>'
    (folder / "nest.svg").write_text(f"<svg {page}>{body}</svg>", encoding="utf-8", newline="\n")


def slow_program(words: str, feed: str) -> Callable[[Path], None]:
    """A square, and the program that cuts it, with a wait or at a feed."""

    def make(folder: Path) -> None:
        nest(folder, 300, 300, (rect(50, 50, 90, 90), []))
        path = "X49.25 Y50 X49.25 Y140.75 X140.75 Y140.75 X140.75 Y49.25 X49.25 Y49.25 X49.25 Y95"
        points = path.split()
        moves = [f"G1 {x} {y} F{feed}" for x, y in zip(points[::2], points[1::2], strict=True)]
        lines = ["G21", "G90", "G0 X43.25 Y95", "M3 $0 S1", words, "G1 X49.25 Y95 F2500", *moves, "M5 $0", "M2"]
        (folder / "nest.nc").write_text(
            "\n".join(line for line in lines if line) + "\n", encoding="utf-8", newline="\n"
        )

    return make


def unpacking(megabytes: int) -> Callable[[Path], None]:
    """A small gzip of so much text, numbers all."""

    def make(folder: Path) -> None:
        line = b"1 2 " * 250 + b"\n"
        with gzip.open(folder / "words.sop.gz", "wb", compresslevel=6) as file:
            file.write(b"DIMENSION: 7000\nEDGE_WEIGHT_SECTION\n")
            for _ in range(megabytes * 1000):
                file.write(line)

    return make


FACTS = ("facts", "nest.json", "-o", "facts.json")
SMALL = ("facts", "nest.json", "-p", "shop.yaml", "-o", "facts.json")
SOLVE = ("solve", "nest.json")
HEAT = ("heat", "nest.json", "nest.nc")
CASES = (
    Case("a traced contour of 20,000 vertices, 0.05 mm of noise", one_part(ring(20_000, 0.05)), FACTS),
    Case("a contour of 20,000 vertices, 2 mm of noise", one_part(ring(20_000, 2.0)), FACTS),
    Case("a contour of 20,000 vertices, 0.05 mm of noise", one_part(ring(20_000, 0.05)), SOLVE),
    Case("a contour of 20,000 vertices, 2 mm of noise", one_part(ring(20_000, 2.0)), SOLVE),
    Case("a star of 2,000 vertices", one_part(star(1000)), FACTS),
    Case("3,000 equal parts side by side", grid(3000), FACTS),
    Case("one part with 3,600 holes", perforated(3600, 12), SMALL),
    Case("112 holes without room for a pierce", perforated(112, 2.96), SMALL),
    Case("a ring that crosses itself over 20,000 times", one_part(zigzag(150)), FACTS),
    Case("3,000 parts in one place", in_one_place, FACTS),
    Case("55 kB of style in an SVG", styled, ("facts", "nest.svg", "-o", "facts.json")),
    Case("a program that waits for three years, `G4 P99999999`", slow_program("G4 P99999999", "2500"), HEAT),
    Case("a program at `F0.001`", slow_program("", "0.001"), HEAT),
    Case("240 MB of numbers in a small gzip", unpacking(240), ("bench", "words.sop.gz")),
)


def run(case: Case) -> Used:
    """Give one input to the command line, and see what comes."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        case.make(folder)
        paths = os.pathsep.join(str(Path(p).resolve()) for p in sys.path if p)
        done = subprocess.run(
            [sys.executable, "-c", CHILD, *case.words],
            cwd=folder,
            env={**os.environ, "PYTHONPATH": paths},
            capture_output=True,
            encoding="utf-8",
            check=False,
        )
    told, _, used = done.stderr.rpartition("\nused ")
    cpu_s, memory_mb = used.split()
    told = "\n".join(line for line in told.splitlines() if not line.startswith("note: "))
    said = told.partition("kerfwise: ")[2].partition("\n")[0].partition(": ")[2]
    return Used(float(cpu_s), float(memory_mb), done.returncode, said)


def row(case: Case, used: Used) -> str:
    """One line of the table."""
    said = used.said.partition("; ")[0]
    said = said if len(said) <= WORDS else f"{said[:WORDS].rsplit(' ', 1)[0]} …"
    cells = (case.name, f"`{case.words[0]}`", f"{used.cpu_s:.1f}", f"{used.memory_mb:.0f}", str(used.code), said)
    return f"| {' | '.join(cells)} |\n"


def main() -> None:
    """Print the table, a line as each input is done."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--case", nargs="+", default=[], metavar="NAME", help="only those with these words in the name")
    given = parser.parse_args()
    print(HEAD, end="", flush=True)
    for case in CASES:
        if not given.case or any(word in case.name for word in given.case):
            began_s = time.monotonic()
            print(row(case, run(case)), end="", flush=True)
            print(f"{case.name}: {time.monotonic() - began_s:.1f} s", file=sys.stderr)


if __name__ == "__main__":
    main()
