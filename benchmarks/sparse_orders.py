"""Chains of exchanges against annealing where orders are sparse, on made instances; and nests with their orders varied.

Usage: python benchmarks/sparse_orders.py [--work W] [--varied FOLDER] > benchmarks/routing_made.md

Prints a section of docs/routing.md. Costs of made instances are drawn by chance, 0 to 1000, and so are the orders. The
search alone does the same work (deterministic seconds) both ways. FOLDER holds routing instances with
clusters; their orders are removed, halved and turned round, and each is solved in 1 s and in 10 s.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from kerfwise.models.engines.search import Searcher
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.engines.warm_up import load_kernels
from kerfwise.models.routing import Instance, is_instance, read_instance, solve_instance

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
The search alone, {work:g} deterministic seconds each way: `python benchmarks/sparse_orders.py --work {work:g}{also}`.
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


def varied(instance: Instance, seed: int) -> Iterator[Instance]:
    """The same nest with no orders, with half of them, and with all of them the other way; the start stays first."""
    home = next(k for k, members in enumerate(instance.clusters) if instance.start in members)
    own = instance.orders[:, 0] != home
    first, orders = instance.orders[~own], instance.orders[own]
    half = orders[np.random.default_rng(seed).random(len(orders)) < 0.5]
    for name, kept in (
        ("no orders", orders[:0]),
        ("half of its orders", half),
        ("orders turned round", orders[:, ::-1]),
    ):
        all_of_it = np.unique(np.concatenate([first, kept]), axis=0)
        yield replace(instance, name=f"{instance.name}, {name}", orders=all_of_it)


def by_search(instance: Instance, work: float, chains: bool) -> int:
    """The cost that the search alone finds."""
    searcher = Searcher(instance.problem, 1, chains)
    searcher.run(work)
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


def rows_of_varied(folder: Path) -> Iterator[str]:
    """Each varied nest as a row of the table."""
    for path in sorted(folder.iterdir()):
        if not is_instance(path):
            continue
        for instance in varied(read_instance(path), seed=1):
            quick, slow = (solve_instance(instance, SolveOptions(seed=1, time_s=limit_s)) for limit_s in (1.0, 10.0))
            bound = "yes" if slow.proven else "" if slow.bound is None else f"≥ {slow.bound}"
            yield f"| {instance.name} | {quick.cost} | {slow.cost} | {bound} |"


def main() -> None:
    """Print the section; each row as it comes on standard error."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--work", type=float, default=4.0)
    parser.add_argument("--varied", type=Path, metavar="FOLDER")
    given = parser.parse_args()
    load_kernels()
    print("## Made instances: chains against annealing\n")
    also = "" if given.varied is None else f" --varied {given.varied.name}"
    print(INTRODUCTION.format(work=given.work, also=also))
    _print_table(
        "| instance | seed | annealing | chains | change |\n|---|---|---:|---:|---:|", rows_of_made(given.work)
    )
    if given.varied is not None:
        print(f"\n## {given.varied.name} with other orders\n")
        _print_table("| instance | in 1 s | in 10 s | proven |\n|---|---:|---:|---:|", rows_of_varied(given.varied))


def _print_table(head: str, rows: Iterator[str]) -> None:
    print(head)
    for row in rows:
        print(row, flush=True)
        print(row, file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
