"""What the check says of mutants, with and without the plan.

Run as `python -m kerfwise.tests.mutations.judged --each 40` for the table of docs/coverage.md.
"""

from __future__ import annotations

import argparse
import re
from collections import Counter
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import kerfwise
from kerfwise import InputError, Nest, Profile, Result, load_profile, read_nest
from kerfwise.tests.checked import checked
from kerfwise.tests.mutations.mutants import FURTHER, Mutant, mutants

DIALECTS = tuple(sorted(FURTHER))
NEST = Path(__file__).parent.parent / "metal" / "cases" / "05-overcut-other-way.json"


@dataclass(frozen=True, eq=False, slots=True)
class Original:
    """A valid program of a dialect, and what it was made of."""

    nest: Nest
    profile: Profile
    made: Result


@cache
def original(dialect: str) -> Original:
    """The plan and program that mutants of a dialect are made of."""
    profile = load_profile("laser-st10kp-2mm" if dialect == "grbl" else "plasma-carbon-steel")
    profile = replace(profile, machine=replace(profile.machine, dialect=dialect))
    nest = read_nest(NEST)
    if dialect == "burny":  # it has no words to mark
        nest = Nest(nest.sheet, tuple(replace(part, marks=()) for part in nest.parts), sha256=nest.sha256)
    made = kerfwise.solve(nest, profile, work=0.2)
    assert made.verdict.ok
    return Original(nest, profile, made)


def words(text: str) -> list[str]:
    """What a control acts on, by plain text: no comments, no line numbers, no blanks, no pauses."""
    rows = (re.sub(r"\([^)]*\)|;.*|^N\d+", "", row.replace(" ", "")) for row in text.split("\n"))
    rows = (re.sub(r"-0(?![.\d])", "0", row) for row in rows)
    return [row for row in rows if row and row not in ("M0", "M00", "M1", "M01", "%")]


def passes(of: Original, mutant: Mutant, with_plan: bool) -> bool:
    """Whether the check has nothing against a mutant."""
    plan = of.made.plan if with_plan else None
    try:
        return checked(of.nest, mutant.text, of.profile, plan).ok
    except InputError:
        return False


def counted(each: int, seed: int = 1) -> tuple[dict[str, tuple[int, int, int]], Counter[str], list[Mutant]]:
    """By dialect how many mutants there were, and passed without and with the plan.

    Those that pass without it are counted by kind, too, and those that pass with it are told.
    """
    rows: dict[str, tuple[int, int, int]] = {}
    kinds: Counter[str] = Counter()
    with_plan: list[Mutant] = []
    for dialect in DIALECTS:
        of = original(dialect)
        made = [m for m in mutants(of.made.program, dialect, each, seed) if words(m.text) != words(of.made.program)]
        without = [m for m in made if passes(of, m, with_plan=False)]
        kinds.update(f"{dialect}: {m.kind}" for m in without)
        by_plan = [m for m in without if passes(of, m, with_plan=True)]
        with_plan += by_plan
        rows[dialect] = len(made), len(without), len(by_plan)
    return rows, kinds, with_plan


def main(each: int, show: bool) -> None:
    """Print the counts as a table, and what passes without the plan by kind."""
    rows, kinds, with_plan = counted(each)
    print("| dialect | mutants | pass without the plan | with it |\n|---|---:|---:|---:|")
    for dialect, counts in rows.items():
        print(f"| `{dialect}` | {counts[0]} | {counts[1]} | {counts[2]} |")
    for kind, count in sorted(kinds.items()):
        print(f"- {kind}: {count}")
    for mutant in with_plan if show else []:
        print(mutant.kind, mutant.line, mutant.text.split("\n")[mutant.line - 1])


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--each", type=int, default=40, help="mutants a dialect")
    parser.add_argument("--show", action="store_true", help="what passes with the plan")
    args = parser.parse_args()
    main(args.each, args.show)
