"""What tabs cost: plates cut without tabs, with tabs on the parts that may tip, and with tabs on all.

Usage: python -m kerfwise.benchmarks.tabs [--contours 115] [--profiles laser-st10kp-2mm] [--work 20]

Made plates (examples/gen_sheet.py, seed 1) under shipped profiles, with the tabs of examples/profiles/tabs.yaml: two of
0.5 mm a part for a laser, one at the end for a plasma torch, slats 60 mm apart. Each program is checked; one that fails
ends the run.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass, replace
from pathlib import Path

import kerfwise
from kerfwise.benchmarks.plates import checked_plan, made_plate
from kerfwise.encoder.nest import Nest
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile

RULE = "hold-small-parts"
EXAMPLE = Path(kerfwise.__file__).parent / "examples" / "profiles" / "tabs.yaml"
CHOICES = ("none", "tipping", "all")
HEAD = (
    "profile              contours  tabs     parts  held  tabs  pierces  "
    "cut, m  idle, m  program, s   gap  processor, s"
)


@dataclass(frozen=True)
class Row:
    """One plan: what it is of, and what it comes to; `held` counts the parts that keep tabs."""

    profile: str
    contours: int
    choice: str
    parts: int
    held: int
    tabs: int
    pierces: int
    cut_mm: float
    idle_mm: float
    program_s: float
    gap: float | None
    spent_s: float

    def __str__(self) -> str:
        told = "–" if self.gap is None else "0" if self.gap == 0 else f"{self.gap:.1%}"
        return (
            f"{self.profile:19}  {self.contours:8}  {self.choice:7}  {self.parts:5}  {self.held:4}  {self.tabs:4}  "
            f"{self.pierces:7}  {self.cut_mm / 1000:6.2f}  {self.idle_mm / 1000:7.2f}  {self.program_s:10.1f}  "
            f"{told:>4}  {self.spent_s:12.0f}"
        )


def plant(name: str, choice: str) -> Profile:
    """A shipped profile with the example's tabs on some parts."""
    profile = load_profile(name)
    held = load_profile(EXAMPLE).rules[RULE]
    setting = replace(held, options=replace(held.options, tabs=choice))
    return profile if choice == "none" else replace(profile, rules={**profile.rules, RULE: setting})


def row(nest: Nest, name: str, choice: str, work: float) -> Row:
    """Plan and check a plate.

    Raises
    ------
    SystemExit
        If its program does not pass the check.
    """
    profile, began_s = plant(name, choice), time.process_time()
    made = checked_plan(f"{name}, tabs: {choice}", nest, profile, work, and_zones=True)
    totals, tabs = made.plan.totals, [len(p.cut.tabs) for p in made.plan.cuts if p.cut.tabs]
    return Row(
        name,
        len(nest.contours),
        choice,
        len(nest.parts),
        len(tabs),
        sum(tabs),
        totals.pierces,
        totals.cut_mm,
        totals.idle_mm,
        totals.time_s,
        made.plan.solve.gap,
        time.process_time() - began_s,
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--contours", type=int, nargs="+", default=[115])
    parser.add_argument("--profiles", nargs="+", default=["laser-st10kp-2mm"])
    parser.add_argument("--work", type=float, default=20.0)
    given = parser.parse_args()
    print(HEAD)
    for name in given.profiles:
        for contours in given.contours:
            nest = made_plate(contours, seed=1)
            for choice in CHOICES:
                print(row(nest, name, choice, given.work), flush=True)


if __name__ == "__main__":
    main()
