"""Chains of exchanges against annealing where orders are sparse, on made instances.

Usage: python benchmarks/sparse_orders.py [--work W] > benchmarks/routing_made.md

Prints a section of docs/routing.md. Costs of made instances are drawn by chance, 0 to 1000, and so are the orders. The
search alone does the same work (deterministic seconds) both ways.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from kerfwise.apps.bench.bench_child import load_kernels
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.search import Searcher
from kerfwise.models.routing import Instance

TO_TUNE, HELD_OUT = (1, 2), (101, 102)
"""Seeds to choose the numbers of the search by, and seeds for the page alone."""
DEAREST = 1000


@dataclass(frozen=True, slots=True)
class Family:
    """`contours` with a start before and an end after all; `share` of the pairs get an order, or `pairs` of them."""

    contours: int
    share: float = 0.0
    pairs: int = 0

    def __str__(self) -> str:
        orders = (
            f"{self.pairs} pairs" if self.pairs else f"{self.share:.1%} of the pairs" if self.share else "no orders"
        )
        return f"{self.contours} contours, {orders}"


INTRODUCTION = """\
The search alone, {work:g} deterministic seconds each way: `python benchmarks/sparse_orders.py --work {work:g}`.
Costs are drawn by chance, 0 to 1000; orders keep to a hidden one. Seeds 1 and 2 are there to choose the numbers of
the search by, the others for this page alone. The present numbers were chosen by R.200.1000.1, R.300.1000.1,
R.700.1000.1, prob.100 and three more of 200 and 500 contours, made in another way.
"""

FAMILIES = (
    Family(100, pairs=40),
    Family(200),
    Family(200, share=0.02),
    Family(400, share=0.005),
    Family(700),
    Family(700, share=0.002),
)


def made(family: Family, seed: int) -> Instance:
    """A sequential ordering problem; orders follow a hidden one, in which all of them hold."""
    n = family.contours
    random = np.random.default_rng((n, round(1e4 * family.share), family.pairs, seed))
    cost = random.integers(0, DEAREST + 1, (n + 2, n + 2))
    hidden = random.permutation(n) + 1
    sooner, later = np.triu_indices(n, 1)
    if family.pairs:
        taken = random.permutation(n)[: 2 * family.pairs].reshape(-1, 2)
        sooner, later = taken.min(axis=1), taken.max(axis=1)
    else:
        kept = random.random(len(sooner)) < family.share
        sooner, later = sooner[kept], later[kept]
    inner, everyone = np.stack([hidden[sooner], hidden[later]], axis=1), np.arange(n + 2)
    first = np.stack([np.zeros(n + 1, dtype=np.int64), everyone[1:]], axis=1)
    last = np.stack([everyone[:-1], np.full(n + 1, n + 1)], axis=1)
    orders = np.unique(np.concatenate([inner, first, last]), axis=0)
    return Instance(str(family), cost, tuple((v,) for v in range(n + 2)), orders, start=0, closed=False)


def by_search(instance: Instance, work: float, chains: bool) -> int:
    """The cost that the search alone finds."""
    searcher = Searcher(instance.problem, 1, chains)
    searcher.run(Deadline(work))
    assert searcher.best is not None
    return searcher.best.cost


def rows_of_made(work: float) -> Iterator[str]:
    """Each made instance as a row of the table."""
    for seeds, name in ((TO_TUNE, "to tune by"), (HELD_OUT, "held out")):
        for family in FAMILIES:
            for seed in seeds:
                instance = made(family, seed)
                annealed, chained = (by_search(instance, work, chains) for chains in (False, True))
                yield f"| {family} | {seed}, {name} | {annealed} | {chained} | {chained / annealed - 1:+.1%} |"


def main() -> None:
    """Print the section; each row as it comes on standard error."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--work", type=float, default=4.0)
    given = parser.parse_args()
    load_kernels()
    print("## Made instances: chains against annealing\n")
    print(INTRODUCTION.format(work=given.work))
    print("| instance | seed | annealing | chains | change |\n|---|---|---:|---:|---:|")
    for row in rows_of_made(given.work):
        print(row, flush=True)
        print(row, file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
