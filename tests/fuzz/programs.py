"""Mutated programs through the check's reader and through their control, side by side.

`python -m kerfwise.tests.fuzz.programs --cases 10000 --seed 1` prints how the two compare, and exits 1 where they
disagree: what our reader accepts the control must run the same way, and what it refuses although the control runs it
must be refused as "not supported here".
"""

from __future__ import annotations

import multiprocessing
import random
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import get_args

import click

from kerfwise.tests.fuzz.compare import BAD, Kind, Verdict, judge
from kerfwise.tests.fuzz.good_programs import good_programs
from kerfwise.tests.fuzz.mutations import mutated
from kerfwise.tests.fuzz.shrink import smallest

CASES_AT_ONCE = 50


@dataclass(frozen=True, slots=True)
class Case:
    """One mutated program."""

    number: int
    control: str
    program: bytes
    verdict: Verdict


def case(seed: int, number: int) -> tuple[str, bytes]:
    """The control and the program of one case: the same for the same seed and number."""
    rnd = random.Random(f"{seed}/{number}")
    control, text = rnd.choice(good_programs())
    return control, mutated(text.encode(), rnd)


def tried(seed: int, number: int, stricter: bool = False) -> Case:
    """One case, judged (see `judge`); a disagreement is made small."""
    control, program = case(seed, number)
    verdict = _judged(program, control, stricter)
    if verdict.kind in BAD:
        program = smallest(program, lambda fewer: _judged(fewer, control).kind == verdict.kind)
        verdict = _judged(program, control)
    return Case(number, control, program, verdict)


def _judged(program: bytes, control: str, stricter: bool = False) -> Verdict:
    try:
        return judge(program, control, stricter)
    except Exception as error:  # a reader that breaks down is the worst of its findings
        return Verdict("differs", f"{type(error).__name__}: {error}")


@click.command()
@click.option("--cases", default=10000, show_default=True, help="How many programs.")
@click.option("--seed", default=1, show_default=True)
@click.option("--first", default=0, show_default=True, help="Number of the first.")
@click.option("--processes", default=2, show_default=True, help="How many read at the same time.")
@click.option("--save", type=click.Path(file_okay=False, path_type=Path), help="Folder for disagreements, made small.")
@click.option("--stricter", is_flag=True, help="Count apart, and by message, what is refused that the control runs.")
def main(cases: int, seed: int, first: int, processes: int, save: Path | None, stricter: bool) -> None:
    """Read mutated programs with the check's reader and with their control, and compare."""
    started = time.monotonic()
    counted: Counter[tuple[str, Kind]] = Counter()
    messages: Counter[str] = Counter()
    bad = 0
    for done in _run(seed, range(first, first + cases), processes, stricter):
        counted[done.control, done.verdict.kind] += 1
        if done.verdict.kind == "stricter":
            messages[done.verdict.text.partition(" ")[2][:60]] += 1
        if done.verdict.kind in BAD:
            bad += 1
            click.echo(
                f"case {done.number}, {done.control}: {done.verdict.kind}: {done.verdict.text}\n{done.program!r}"
            )
            if save is not None:
                save.mkdir(parents=True, exist_ok=True)
                (save / f"{seed}-{done.number}.{done.control}.ngc").write_bytes(done.program)
    controls = sorted({control for control, _ in counted})
    click.echo(f"programs: {sum(counted.values())} (seed {seed}), in {time.monotonic() - started:.0f} s")
    click.echo(f"{'':24}" + "".join(f"{control:>22}" for control in controls))
    for kind in get_args(Kind):
        click.echo(f"{kind:24}" + "".join(f"{counted[control, kind]:22}" for control in controls))
    click.echo(f"disagreements: {bad}")
    for message, count in messages.most_common():
        click.echo(f"{count:6} {message}")
    sys.exit(1 if bad else 0)


def _run(seed: int, numbers: range, processes: int, stricter: bool) -> Iterator[Case]:
    tasks = [(seed, numbers[k : k + CASES_AT_ONCE], stricter) for k in range(0, len(numbers), CASES_AT_ONCE)]
    if processes == 1:
        yield from chain.from_iterable(map(_several, tasks))
        return
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        yield from chain.from_iterable(pool.imap(_several, tasks))


def _several(task: tuple[int, range, bool]) -> list[Case]:
    seed, numbers, stricter = task
    return [tried(seed, number, stricter) for number in numbers]


if __name__ == "__main__":
    main()
