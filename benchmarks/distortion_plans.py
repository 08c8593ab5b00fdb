"""Plans that bend their parts less: the shipped profile's plan beside the one that is chosen by simulation.

Usage: python -m kerfwise.benchmarks.distortion_plans [--process oxyfuel|plasma|laser] [--first SEED] [--seeds N]

Made nests by seed, of some eighteen contours on 1500 × 750 mm. Both plans keep every hard rule of the shipped profile.
The second is priced: a mm of error, mean over the parts of each part's worst place, costs `--price` mm of travel. It is
found on a coarse mesh, and both are measured on a finer one. Printed for each nest: mean and worst part in mm before
and after, time before and after, how many of the parts become better, and what the mean would be, as a share of before,
if each part were as it was in that simulated plan which had it straightest.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass, replace

import numpy as np

from kerfwise.apps.distortion.predict import Distortion, distort_path
from kerfwise.apps.distortion.straighter import StraighterOrders
from kerfwise.benchmarks.distortion_rules import PROCESSES, made_nest
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.request import Request, facts_of, make_request, options_for
from kerfwise.jobs.simulation import path_of_plan
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.physics.heat import TimedPath
from kerfwise.pipeline import VerifiedPlan, solve_and_verify
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile

GRID_MM = 14.0
"""Both plans are measured with cells as wide as that."""


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


def planned(seed: int, process: str, work: float) -> Planned:
    """One nest, planned by the shipped profile; nothing is simulated yet."""
    shipped = load_profile(PROCESSES[process][0])
    profile = replace(shipped, small_holes=replace(shipped.small_holes, under="skip"))
    nest = profile.as_cut(made_nest(seed, process))
    facts = facts_of(nest, profile)
    limits = options_for(nest, profile, work=work)
    request = make_request(facts, profile, True, limits=limits)
    plan = solve_and_verify(request, profile, limits)
    assert plan.verdict.ok
    return Planned(nest, profile, limits, request, plan, StraighterOrders(facts, profile, request.stated))


def plans(seed: int, process: str, price_mm: float, work: float) -> tuple[list[Distortion], list[float], float, float]:
    """The errors of both plans of one nest, their times, s, what the second took, CPU s, and the parts at their best.

    The last is a share of the first plan's mean on the mesh of the search.
    """
    before = planned(seed, process, work)
    nest, profile, orders = before.nest, before.profile, before.orders
    began_s = time.process_time()
    priced = replace(profile, objective=replace(profile.objective, distortion=price_mm))
    after = solve_and_verify(before.request, priced, before.limits, simulated=orders)
    took_s = time.process_time() - began_s
    assert after.verdict.ok
    made = [one.plan for one in (before.plan, after)]
    found = [distort_path(Inputs(nest, profile), path_of_plan(plan, nest, profile), GRID_MM) for plan in made]
    off_mm = np.array([tried.off_mm for tried in orders.tried.values()])
    return found, [plan.totals.time_s for plan in made], took_s, float(off_mm.min(axis=0).mean() / off_mm[0].mean())


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--process", choices=list(PROCESSES), default="oxyfuel")
    parser.add_argument("--first", type=int, default=201)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--price", type=float, default=200_000.0)
    parser.add_argument("--work", type=float, default=2.0)
    given = parser.parse_args()
    print(
        "| process | seed | mean of parts, mm | worst part, mm | parts better | time, s | parts at their best | CPU s |"
    )
    print("|---|---:|---:|---:|---:|---:|---:|---:|")
    shares, times, bests = [], [], []
    for seed in range(given.first, given.first + given.seeds):
        (a, b), (was_s, is_s), took_s, best = plans(seed, given.process, given.price, given.work)
        better = sum((y.max_mm or 0) < (x.max_mm or 0) for x, y in zip(a.parts, b.parts, strict=True))
        shares.append(b.mean_mm / a.mean_mm)
        times.append(is_s / was_s)
        bests.append(best)
        print(
            f"| {given.process} | {seed} | {a.mean_mm:.3f} → {b.mean_mm:.3f} | {a.max_mm:.2f} → {b.max_mm:.2f} | "
            f"{better} of {len(a.parts)} | {was_s:.0f} → {is_s:.0f} | {best:.0%} | {took_s:.0f} |",
            flush=True,
        )
    print(
        f"\nmean error {np.mean(shares):.0%} of before, time {np.mean(times):.1%}; "
        f"each part at its best {np.mean(bests):.0%}"
    )


if __name__ == "__main__":
    main()
