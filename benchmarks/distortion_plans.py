"""Parts that come out truer: by another order, by a nest that is compensated, and by both, beside the shipped profile.

Usage: python -m kerfwise.benchmarks.distortion_plans [--process oxyfuel|plasma|laser] [--first SEED] [--seeds N]
       [--only compensation] [--heat] [--keep FILE]

Made nests by seed, of some eighteen contours on 1500 × 750 mm. Every plan keeps every hard rule of the shipped profile.

- *default*: its plan;
- *order*: the plan chosen by simulation, where a mm of error, mean over the parts, costs `--price` mm of travel;
- *size*, *shape*: the nest as `kerfwise distort --compensated` writes it for the default plan, cut by that plan;
- *both*: the nest compensated in shape for the plan chosen by simulation, cut by that.

Plans are looked for, and nests compensated, by simulations on cells of 20 mm and more; all are measured on others, of
16 mm, at three times as many points, and against the drawing as it was. So what a mesh gets wrong is no gain. The mean
over the parts of what each is off at its worst place, mm. With `--heat` the default and the compensated nest are cut
with 1.66 and 0.6 times the heat that was assumed. What was measured is kept in FILE, and not measured again.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from kerfwise.apps.distortion.compensation import Kind, compensated
from kerfwise.apps.distortion.cutting import cut_sheet, cutting_of
from kerfwise.apps.distortion.part_errors import PartError, errors_of
from kerfwise.apps.distortion.straighter import StraighterOrders
from kerfwise.benchmarks.distortion_rules import PROCESSES, made_nest
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.heat_path import path_of_plan
from kerfwise.jobs.request import Request, facts_of, make_request, options_for
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.models.physics.heat import TimedPath
from kerfwise.models.plan.plan import Plan
from kerfwise.pipeline import VerifiedPlan, plan_of, solve_and_verify
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile

PREDICTED_MM, MEASURED_MM, POINTS = 20.0, 16.0, 3
"""Widths of cells: what compensation goes by, and what all is measured on, at so many times the usual points."""
HEATS = (1.66, 0.6)
WAYS = ("default", "order", "size", "shape", "both")
Row = dict[str, list[float]]
"""Way → mean of the parts, worst part, mm, and time, s."""


@dataclass(frozen=True)
class Planned:
    """A made nest with the plan of the shipped profile, and what finds straighter ones."""

    nest: Nest
    profile: Profile
    limits: SolveOptions
    request: Request
    plan: VerifiedPlan
    orders: StraighterOrders

    @property
    def path(self) -> TimedPath:
        """The torch's way by that plan."""
        return path_of_plan(self.plan.plan, self.nest, self.profile)


def planned(seed: int, process: str, work: float, nest: Nest | None = None) -> Planned:
    """One nest, or this one in its place, planned by the shipped profile; nothing is simulated yet."""
    shipped = load_profile(PROCESSES[process][0])
    profile = replace(shipped, small_holes=replace(shipped.small_holes, under="skip"))
    nest = profile.as_cut(nest or made_nest(seed, process))
    facts = facts_of(nest, profile)
    limits = options_for(nest, profile, work=work)
    request = make_request(facts, profile, True, limits=limits)
    plan = solve_and_verify(request, profile, limits)
    assert plan.verdict.ok
    return Planned(nest, profile, limits, request, plan, StraighterOrders(facts, profile, request.stated))


def errors(of: Planned, path: TimedPath, grid_mm: float, points: int = 1, heat: float = 1.0) -> tuple[PartError, ...]:
    """By simulation, with so many times the profile's heat."""
    hot = replace(of.profile.heat, absorbed_power_w=heat * of.profile.heat.absorbed_power_w)
    how = replace(cutting_of(of.profile.material, grid_mm), points=points)
    return errors_of(of.nest, cut_sheet(of.nest, path, hot, how))


def measured(of: Planned, path: TimedPath, heat: float = 1.0) -> list[float]:
    """Mean of the parts and worst part, mm; time, s."""
    off = [e.max_mm for e in errors(of, path, MEASURED_MM, POINTS, heat) if e.max_mm is not None]
    return [float(np.mean(off)), max(off), path.end_s]


class Seed:
    """One made nest, cut in several ways."""

    def __init__(self, seed: int, process: str, given: argparse.Namespace) -> None:
        self._seed, self._process, self._given = seed, process, given
        self._default = planned(seed, process, given.work)

    def _changed(self, plan: Plan, kind: Kind) -> tuple[Planned, TimedPath]:
        """The nest compensated for a plan, by another mesh than it is measured on, and its path by that plan."""
        of = self._default
        path = path_of_plan(plan, of.nest, of.profile)
        made = compensated(of.nest, errors(of, path, PREDICTED_MM), kind, of.profile.material.kerf_mm)
        changed = planned(self._seed, self._process, self._given.work, made.nest)
        route = changed.orders.like(plan)
        assert route is not None
        solution = Solution(route, 0.0, None, "feasible", "search", "", 0.0)
        same = plan_of(changed.request, changed.profile, solution, changed.limits, (), reasons=False)
        return changed, path_of_plan(same, changed.nest, changed.profile)

    def rows(self, known: Mapping[str, list[float]]) -> Iterator[tuple[str, list[float]]]:
        """What is not known yet."""
        of, plan = self._default, self._default.plan.plan
        if "default" not in known:
            yield "default", measured(of, of.path)
        kinds: tuple[Kind, ...] = ("size", "shape")
        for kind in kinds:
            hot = self._given.heat and kind == "shape" and "shape hot" not in known
            if kind not in known or hot:
                changed, path = self._changed(plan, kind)
                yield kind, measured(changed, path)
                if hot:
                    for name, heat in zip(("hot", "cool"), HEATS, strict=True):
                        yield f"default {name}", measured(of, of.path, heat)
                        yield f"shape {name}", measured(changed, path, heat)
        if self._given.only != "compensation" and "both" not in known:
            priced = replace(of.profile.objective, distortion=self._given.price)
            profile = replace(of.profile, objective=priced)
            plan = solve_and_verify(of.request, profile, of.limits, simulated=of.orders).plan
            yield "order", measured(of, path_of_plan(plan, of.nest, of.profile))
            changed, path = self._changed(plan, "shape")
            yield "both", measured(changed, path)


def table(rows: Mapping[str, Row]) -> Iterator[str]:
    """The table, and means over the nests of each process."""
    yield "| process | seed | default, mm | order | size | shape | both | worst part, mm | time of both |"
    yield "|---|---:|---:|---:|---:|---:|---:|---:|---:|"
    shares: dict[str, dict[str, list[float]]] = {}
    for name, row in sorted(rows.items(), key=lambda item: (list(PROCESSES).index(item[0].split()[0]), item[0])):
        process, seed = name.split()
        first = row["default"]
        cells = []
        for way in WAYS[1:]:
            if way in row:
                shares.setdefault(process, {}).setdefault(way, []).append(row[way][0] / first[0])
                cells.append(f"{row[way][0]:.3f} ({row[way][0] / first[0]:.0%})")
            else:
                cells.append("–")
        for way in ("hot", "cool"):
            if f"shape {way}" in row:
                share = row[f"shape {way}"][0] / row[f"default {way}"][0]
                shares.setdefault(process, {}).setdefault(f"shape, {way}", []).append(share)
        last = next(row[way] for way in ("both", "shape", "size", "default") if way in row)
        if "both" in row:
            shares[process].setdefault("time of both", []).append(last[2] / first[2])
        yield (
            f"| {process} | {seed} | {first[0]:.3f} | {' | '.join(cells)} | {first[1]:.2f} → {last[1]:.2f} "
            f"| {f'{last[2] / first[2] - 1:+.1%}' if 'both' in row else '–'} |"
        )
    for process, ways in shares.items():
        told = ", ".join(f"{way} {np.mean(found):.0%} ({len(found)})" for way, found in ways.items())
        yield f"\n{process}, mean of the nests' shares of the default plan's error (nests): {told}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--process", choices=list(PROCESSES), default="oxyfuel")
    parser.add_argument("--first", type=int, default=201)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--price", type=float, default=200_000.0)
    parser.add_argument("--work", type=float, default=1.0)
    parser.add_argument("--only", choices=["compensation"])
    parser.add_argument("--heat", action="store_true")
    parser.add_argument("--keep", type=Path)
    given = parser.parse_args()
    kept: dict[str, Row] = (
        json.loads(given.keep.read_text(encoding="utf-8")) if given.keep and given.keep.exists() else {}
    )
    for seed in range(given.first, given.first + given.seeds):
        row = kept.setdefault(f"{given.process} {seed}", {})
        for way, found in Seed(seed, given.process, given).rows(row):
            row[way] = found
            if given.keep:
                given.keep.write_text(json.dumps(kept), encoding="utf-8", newline="\n")
    for line in table(kept):
        print(line)


if __name__ == "__main__":
    main()
