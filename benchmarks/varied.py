"""Routing instances with other orders: removed, halved and turned round.

Usage: python benchmarks/varied.py FOLDER OUT [--seed N]

FOLDER holds `.pcglns` files, gzipped or not. Of each NAME three are written into OUT: NAME-none, NAME-half (each order
is kept with one half of a chance) and NAME-turned. The start stays first. Where an arc of the file is -1, as an order
forbids it, the dearest arc of the file stands.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from kerfwise.models.routing import Instance, is_instance, read_instance


def varied(instance: Instance, seed: int) -> Iterator[Instance]:
    """The same nest with no orders, with half of them, and with all of them the other way; the start stays first."""
    own = instance.orders[:, 0] != home_of(instance)
    first, orders = instance.orders[~own], instance.orders[own]
    half = orders[np.random.default_rng(seed).random(len(orders)) < 0.5]
    for name, kept in (("none", orders[:0]), ("half", half), ("turned", orders[:, ::-1])):
        all_of_it = np.unique(np.concatenate([first, kept]), axis=0)
        yield replace(instance, name=f"{instance.name}-{name}", orders=all_of_it)


def home_of(instance: Instance) -> int:
    """The cluster that every tour begins with."""
    return next(k for k, members in enumerate(instance.clusters) if instance.start in members)


def as_text(instance: Instance) -> str:
    """A closed instance as a `.pcglns` file has it."""
    cost, home = np.where(instance.cost < 0, instance.cost.max(), instance.cost), home_of(instance)
    orders: dict[int, list[int]] = {}
    for before, after in instance.orders.tolist():
        if before != home:
            orders.setdefault(before + 1, []).append(after + 1)
    sets = [[k, *(v + 1 for v in members)] for k, members in enumerate(instance.clusters, 1)]
    return "\n".join(
        [
            f"NAME : {instance.name}",
            f"DIMENSION : {len(cost)}",
            f"GTSP_SETS : {len(sets)}",
            "EDGE_WEIGHT_SECTION",
            *(" ".join(map(str, row)) for row in cost.tolist()),
            "GTSP_SET_SECTION",
            *(" ".join(map(str, [*row, -1])) for row in sets),
            "GTSP_SET_ORDERING",
            *(" ".join(map(str, [before, *after, -1])) for before, after in sorted(orders.items())),
            "START_GROUP_SECTION",
            str(home + 1),
            "EOF\n",
        ]
    )


def main() -> None:
    """Write the files."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    for path in sorted(given.folder.iterdir()):
        if not is_instance(path):
            continue
        instance = read_instance(path)
        if not instance.closed:
            print(f"{path.name}: left out, its tours are open", file=sys.stderr)
            continue
        for each in varied(instance, given.seed):
            (given.out / f"{each.name}.pcglns").write_text(as_text(each), encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
