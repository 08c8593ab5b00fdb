"""Plans that bend their parts less: the shipped profile's plan beside the one that is chosen by simulation.

Usage: python -m kerfwise.benchmarks.distortion_plans [--process oxyfuel|plasma|laser] [--first SEED] [--seeds N]

Made nests by seed, of some eighteen contours on 1500 × 750 mm. Both plans keep every hard rule of the shipped profile.
The second is priced: a mm of error, mean over the parts of each part's worst place, costs `--price` mm of travel. It is
found on a coarse mesh, and both are measured on a finer one. Printed for each nest: mean and worst part in mm before
and after, time before and after, and how many of the parts become better.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace

import numpy as np

from kerfwise.apps.distortion.predict import Distortion, distort_path
from kerfwise.apps.distortion.straighter import StraighterOrders
from kerfwise.benchmarks.distortion_rules import PROCESSES, made_nest
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.plan_nest import solve_and_verify
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.jobs.simulation import path_of_plan
from kerfwise.rules.profile.load import load_profile

GRID_MM = 20.0
"""Both plans are measured with cells as wide as that."""


def plans(seed: int, process: str, price_mm: float, work: float) -> tuple[list[Distortion], list[float], float]:
    """The errors of both plans of one nest, their times, s, and what the second took, CPU s."""
    shipped = load_profile(PROCESSES[process][0])
    profile = replace(shipped, small_holes=replace(shipped.small_holes, under="skip"))
    nest = profile.as_cut(made_nest(seed, process))
    given, facts = Inputs(nest, profile), facts_of(nest, profile)
    limits = options_for(nest, profile, work=work)
    asked = make_request(facts, profile, True, limits=limits)
    before = solve_and_verify(asked, profile, limits)
    began_s = time.process_time()
    priced = replace(profile, objective=replace(profile.objective, distortion=price_mm))
    after = solve_and_verify(asked, priced, limits, cooler=StraighterOrders(facts, profile, asked.stated))
    took_s = time.process_time() - began_s
    made = [before, after]
    assert all(one.verdict.ok for one in made)
    found = [distort_path(given, path_of_plan(one.plan, nest, profile), GRID_MM) for one in made]
    return found, [one.plan.totals.time_s for one in made], took_s


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--process", choices=list(PROCESSES), default="oxyfuel")
    parser.add_argument("--first", type=int, default=201)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--price", type=float, default=200_000.0)
    parser.add_argument("--work", type=float, default=2.0)
    given = parser.parse_args()
    print("| process | seed | mean of parts, mm | worst part, mm | parts better | time, s | CPU s |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    shares, times = [], []
    for seed in range(given.first, given.first + given.seeds):
        (a, b), (was_s, is_s), took_s = plans(seed, given.process, given.price, given.work)
        better = sum((y.max_mm or 0) < (x.max_mm or 0) for x, y in zip(a.parts, b.parts, strict=True))
        shares.append(b.mean_mm / a.mean_mm)
        times.append(is_s / was_s)
        print(
            f"| {given.process} | {seed} | {a.mean_mm:.3f} → {b.mean_mm:.3f} | {a.max_mm:.2f} → {b.max_mm:.2f} | "
            f"{better} of {len(a.parts)} | {was_s:.0f} → {is_s:.0f} | {took_s:.0f} |",
            flush=True,
        )
    print(f"\nmean error {np.mean(shares):.0%} of before, time {np.mean(times):.1%}")


if __name__ == "__main__":
    main()
