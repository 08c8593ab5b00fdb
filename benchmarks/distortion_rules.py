"""What each rule of the papers is worth in millimetres: made nests, planned with it, without it, and cut the other way.

Usage: python -m kerfwise.benchmarks.distortion_rules [--changes] [--process oxyfuel|plasma|laser] [--rule R]

Every nest is planned under a bare profile, which has only what geometry asks for (holes first, nested parts first,
pierces in waste), and then with one more rule at a time, as the shipped profile of the process has it or, where that
has it off, as the default profile has it. Of each plan: the mean over the parts of the worst error of each part, in mm,
by `kerfwise distort`. "reversed" is the same plan cut the other way: for a rule about directions every contour the
other way round, for a rule about where to begin the parts in the opposite order. Last the shipped profile as it is.
With `--changes` the other way about: the shipped profile as it is, and then with one rule weighed or set otherwise.
Nests are those of `examples/gen_sheet.py` by seed, from 301 on: nothing was tried on them.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

from kerfwise import solve
from kerfwise.apps.distortion.predict import distort_path
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs.heat_path import path_of_plan
from kerfwise.jobs.inputs import Inputs
from kerfwise.models.physics.heat import TimedPath
from kerfwise.models.physics.heat.timed_path import in_order
from kerfwise.rules.catalogue.part_rigidity import PartRigidityOptions
from kerfwise.rules.catalogue.start_side import StartSideOptions
from kerfwise.rules.catalogue.zone_order import ZoneOrderOptions
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import RuleSetting

PROCESSES = {
    "oxyfuel": ("oxyfuel-thick-plate", 30.0),
    "plasma": ("plasma-carbon-steel", 12.0),
    "laser": ("laser-st10kp-2mm", 8.0),
}
"""Process → shipped profile, and the gap between parts of the nests, mm."""
BARE = ("inner-before-outer", "nested-before-host-holes", "marks-first", "pierce", "shared-metal", "locks")
RULES = (
    "part-rigidity", "heat-lag", "no-narrow-strips", "no-islands", "start-side", "zone-order", "level-ahead",
    "hull-before", "part-contiguous", "cut-direction",
)  # fmt: skip
TURNED = ("none", "part-rigidity", "cut-direction", "all")
LAST_FIRST = ("start-side", "zone-order", "level-ahead")
"""Rules about directions, and about where to begin: what is reversed."""
SIZE_MM, CONTOURS, FIRST_SEED = (1500.0, 750.0), 18, 301
TIMES = 5.0
"""Weights are changed by this factor."""


@dataclass(frozen=True)
class Off:
    """The mean over parts and the worst part, mm; the plan's time, s."""

    mean_mm: float
    worst_mm: float
    time_s: float


def made_nest(seed: int, process: str) -> Nest:
    """A nest of `CONTOURS` or a few less; holes that the process cannot cut are left out."""
    sheet = make_sheet(seed, CONTOURS, SIZE_MM, PROCESSES[process][1])
    return read_json(json.dumps(sheet).encode(), ReadOptions())


def bare(profile: Profile, *rules: str) -> Profile:
    """The profile with no rules but those that geometry asks for, and these."""
    default = load_profile()
    settings = {}
    for name, setting in profile.rules.items():
        if name in rules and setting.strength == "off":
            setting = replace(setting, strength=default.rules[name].strength, weight=default.rules[name].weight)
        elif name not in rules and name not in BARE:
            setting = RuleSetting("off", None, setting.options)
        settings[name] = setting
    return replace(profile, rules=settings, small_holes=replace(profile.small_holes, under="skip"))


def changes(profile: Profile) -> Iterator[tuple[str, Profile]]:
    """A shipped profile with one rule weighed or set otherwise."""

    def changed(rule: str, **keys: Any) -> Profile:
        return replace(profile, rules={**profile.rules, rule: replace(profile.rules[rule], **keys)})

    for rule in ("part-rigidity", "heat-lag", "no-narrow-strips"):
        now, default = profile.rules[rule], load_profile().rules[rule]
        if now.strength == "off":
            yield f"{rule} on", changed(rule, strength=default.strength, weight=default.weight)
            continue
        options, weight = now.options, now.weight and TIMES * now.weight
        if isinstance(options, PartRigidityOptions):
            options = replace(options, head_weight_mm=TIMES * options.head_weight_mm)
        yield f"{rule} off", changed(rule, strength="off", weight=None)
        yield f"{rule}, {TIMES:g} times its weight", changed(rule, weight=weight, options=options)
    yield "start-side off", changed("start-side", strength="off")
    for side in ("left", "right"):
        yield (
            f"start-side: {side}",
            changed(
                "start-side", options=replace(cast(StartSideOptions, profile.rules["start-side"].options), side=side)
            ),
        )
    zones = cast(ZoneOrderOptions, profile.rules["zone-order"].options)
    yield "zone-order off", changed("zone-order", strength="off")
    for few in (4, 8):
        yield f"zone-order, zones of {few}", changed("zone-order", options=replace(zones, zone_contours=few))
    square = replace(zones, zone_contours=4, square_ratio=2.0)
    yield "zone-order, zones of 4, long", changed("zone-order", options=square)


def turned(path: TimedPath) -> TimedPath:
    """Every contour the other way round, at the same times."""
    burns = [replace(b, xy=b.xy[::-1].copy(), at_s=b.at_s[0] + b.at_s[-1] - b.at_s[::-1]) for b in path.burns]
    return TimedPath(tuple(burns), path.end_s)


def last_first(path: TimedPath, nest: Nest, travel_mm_s: float) -> TimedPath:
    """The parts in the opposite order, the contours of each as they are."""
    groups: dict[str, list[int]] = {}
    for k, burn in enumerate(path.burns):
        groups.setdefault(nest.contour(burn.contour).part if burn.contour in nest.index else burn.contour, []).append(k)
    now_s, at, burns = 0.0, np.zeros(2), []
    for group in reversed(groups.values()):
        for k in group:
            burn = path.burns[k]
            begin_s = now_s + math.dist(at, burn.xy[0]) / travel_mm_s
            burns.append(replace(burn, at_s=burn.at_s - burn.at_s[0] + begin_s))
            now_s, at = float(burns[-1].at_s[-1]), burn.xy[-1]
    return in_order(burns, now_s)


def measured(given: Inputs, path: TimedPath, grid_mm: float | None) -> Off:
    """By simulation."""
    found = distort_path(given, path, grid_mm)
    return Off(found.mean_mm, found.max_mm, path.end_s)


def of_nest(nest: Nest, profile: Profile, name: str, work: float, grid_mm: float | None) -> Iterator[tuple[str, Off]]:
    """The plan of one nest under one profile, and the same cut otherwise."""
    result = solve(nest, profile, work=work, job=False, relax=True)
    given = Inputs(profile.as_cut(nest), profile)
    path = path_of_plan(result.plan, given.nest, profile)
    yield name, measured(given, path, grid_mm)
    if name in TURNED:
        yield f"{name}, reversed", measured(given, turned(path), grid_mm)
    elif name in LAST_FIRST:
        other = last_first(path, given.nest, profile.machine.travel_mm_s)
        yield f"{name}, reversed", measured(given, other, grid_mm)


def table(process: str, given: argparse.Namespace) -> Iterator[str]:
    """Rows of a Markdown table, one a rule: mean over the nests, and how each nest changes from the first row."""
    shipped = load_profile(PROCESSES[process][0])
    nests = [made_nest(given.first + k, process) for k in range(given.seeds)]
    whole = replace(shipped, small_holes=replace(shipped.small_holes, under="skip"))
    if given.changes:
        variants = [("as shipped", whole), *changes(whole)]
    else:
        variants = [("none", bare(shipped)), *((rule, bare(shipped, rule)) for rule in RULES), ("all", whole)]
    first, found = variants[0][0], dict[str, list[Off]]()
    for name, profile in variants:
        if given.rule and name != first and not name.startswith(tuple(given.rule)):
            continue
        for nest in nests:
            for row, off in of_nest(nest, profile, name, given.work, given.grid):
                found.setdefault(row, []).append(off)
        yield row_of(process, name, found, first)


def row_of(process: str, name: str, found: dict[str, list[Off]], first: str) -> str:
    """One row: mean error and reversed; against the `first` row: change of the mean, nests better, and time."""
    none, on = found[first], found[name]

    def mean(row: str) -> float:
        return float(np.mean([off.mean_mm for off in found[row]]))

    better = sum(a.mean_mm < b.mean_mm for a, b in zip(on, none, strict=True))
    change = mean(name) / mean(first) - 1
    took = sum(a.time_s for a in on) / sum(b.time_s for b in none) - 1
    worst = float(np.mean([off.worst_mm for off in on]))
    back = f"{mean(f'{name}, reversed'):.3f}" if f"{name}, reversed" in found else "–"
    return (
        f"| {process} | {name} | {mean(name):.3f} | {change:+.0%} | {better} of {len(on)} | {worst:.2f} | {back} "
        f"| {took:+.0%} |"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--process", choices=list(PROCESSES), action="append")
    parser.add_argument("--changes", action="store_true", help="the shipped profile with one thing changed")
    parser.add_argument("--first", type=int, default=FIRST_SEED)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--work", type=float, default=1.0)
    parser.add_argument("--grid", type=float, default=20.0)
    parser.add_argument("--rule", action="append", help="only this one, beside the first row; repeatable")
    asked = parser.parse_args()
    columns = (
        "process",
        "rule",
        "mean of parts, mm",
        "change",
        "nests better",
        "worst part, mm",
        "reversed, mm",
        "time",
    )
    print("| " + " | ".join(columns) + " |")
    print("|---|---|---:|---:|---:|---:|---:|---:|")
    begin_s = time.process_time()
    for process in asked.process or PROCESSES:
        for row in table(process, asked):
            print(row, flush=True)
    print(f"\n{time.process_time() - begin_s:.0f} CPU seconds")


if __name__ == "__main__":
    main()
