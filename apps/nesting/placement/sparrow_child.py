"""Packs a strip with sparrow, JSON in and out: `python -m kerfwise.apps.nesting.placement.sparrow_child`.

A shape that sparrow does not like ends its process, whatever Python would catch; so nobody else stands in it.
"""

from __future__ import annotations

import json
import signal
import sys
from typing import Any


def main() -> None:
    """Read one task from standard input, print one answer to standard output."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # whoever began it ends it
    task: dict[str, Any] = json.load(sys.stdin)
    import spyrrow

    items = [
        spyrrow.Item(row["id"], [(x, y) for x, y in row["points"]], row["demand"], row["turns"])
        for row in task["items"]
    ]
    strip = spyrrow.StripPackingInstance("strip", task["height"], items)
    config = spyrrow.StripPackingConfig(
        early_termination=True,
        total_computation_time=max(1, round(task["seconds"])),
        num_workers=task["workers"],
        seed=task["seed"],
    )
    solved = strip.solve(config)
    rows = [[one.id, one.rotation, *one.translation] for one in solved.placed_items]
    print(json.dumps({"placed": rows}), flush=True)


if __name__ == "__main__":
    main()
