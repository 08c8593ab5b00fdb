"""Many random orders laid out and nests_from: `python -m kerfwise.tests.apps.nesting.placement.many --lists 200`."""

from __future__ import annotations

import argparse
import time

from kerfwise.apps.nesting.nests import nests_from
from kerfwise.apps.nesting.placement.rounds import METHODS, Effort, best_layout

from .random_lists import random_order


def main() -> None:
    """Lay out orders and print what the check finds."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--lists", type=int, default=200)
    asked.add_argument("--first", type=int, default=0)
    asked.add_argument("--rounds", type=int, default=2)
    given = asked.parse_args()
    began, faults, parts, sheets, missing = time.process_time(), 0, 0, 0, 0
    for seed in range(given.first, given.first + given.lists):
        wanted, spacing = random_order(seed)
        method = METHODS[seed // 2 % len(METHODS)]
        nested = nests_from(best_layout(wanted, spacing, Effort(given.rounds, seed=seed, method=method)))
        for fault in nested.faults:
            print(f"seed {seed}: {fault}", flush=True)
        faults += len(nested.faults)
        parts += sum(len(nest.parts) for nest in nested.nests)
        sheets += len(nested.nests)
        missing += sum(nested.layout.missing)
    spent = time.process_time() - began
    print(f"{given.lists} lists, {parts} parts on {sheets} sheets, {missing} without room, {spent:.0f} s")
    print(f"violations: {faults}")


if __name__ == "__main__":
    main()
