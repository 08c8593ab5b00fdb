"""Hundreds of random nests through every engine: `python -m kerfwise.tests.agreement.many --nests 500`."""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import click

from kerfwise.tests.agreement.agree import Agreement, agreement
from kerfwise.tests.agreement.cases import kind_of
from kerfwise.tests.agreement.resumed import Resumed, resumed_agreement
from kerfwise.tests.until_stopped import until_stopped


@click.command()
@click.option("--nests", default=500, show_default=True, help="How many.")
@click.option("--first", default=0, show_default=True, help="Seed of the first.")
@click.option("--minutes", type=float, help="Begin no more nests after so long.")
@click.option("--slits", is_flag=True, help="Nests with slots narrower than the kerf, which slits open.")
@click.option("--options", is_flag=True, help="Options of rules drawn at random from what they declare.")
@click.option("--stopped", is_flag=True, help="What is left of nests after a stop: every engine goes on with it.")
def main(nests: int, first: int, minutes: float | None, slits: bool, options: bool, stopped: bool) -> None:
    """Hold the engines against every plan tried by the check; exit code 1 where they differ.

    Ctrl-C ends it early, with the counts so far.
    """
    started = time.monotonic()
    tally: Tally | Gone = Gone(first) if stopped else Tally(first)
    seeds = range(first, first + nests)
    for seed, found in until_stopped(_tried(seeds, slits, options, stopped), nests, "nests", minutes):
        tally.add(found)  # type: ignore[arg-type]
        for line in found.differ:
            click.echo(f"seed {seed}: {line}")
    click.echo("\n".join(tally.lines()))
    click.echo(f"minutes: {(time.monotonic() - started) / 60:.1f}", err=True)
    sys.exit(1 if tally.disagreements else 0)


def _tried(
    seeds: Iterable[int], slits: bool, options: bool, stopped: bool
) -> Iterator[tuple[int, Agreement | Resumed]]:
    """Each seed, with what came of its nest."""
    for seed in seeds:
        if stopped:
            yield seed, resumed_agreement(seed)
        else:
            yield seed, agreement(seed, "slits" if slits else "options" if options else kind_of(seed))


@dataclass
class Tally:
    """Counts of what came of all nests, from the first seed on."""

    first: int
    nests: int = 0
    disagreements: int = 0
    counts: Counter[str] = field(default_factory=Counter)
    engines: Counter[str] = field(default_factory=Counter)
    has: Counter[str] = field(default_factory=Counter)

    def add(self, found: Agreement) -> None:
        """Count one."""
        self.nests += 1
        self.counts[found.outcome] += 1
        self.counts["blurred"] += found.blurred
        self.counts["order sets"] += found.order_sets
        self.disagreements += bool(found.differ)
        self.engines.update(found.engines)
        self.has.update(found.has)

    def lines(self) -> Iterator[str]:
        """The report."""
        counts = self.counts
        seeds = f" (seeds {self.first} to {self.first + self.nests - 1}, 5 to 9 contours)" if self.nests else ""
        yield f"nests tried: {self.nests}{seeds}"
        if self.has:
            yield f"with {_listed(self.has)}"
        yield f"solved: {counts['solved']}, proven infeasible: {counts['infeasible']}, unproven: {counts['unproven']}"
        yield f"optima compared with every plan tried by the check: {_listed(self.engines)}"
        yield f"of these within the check's allowance, not to the digit: {counts['blurred']}"
        yield f"sets of admissible orders compared (check, statements, Gecode): {counts['order sets']}"
        yield f"disagreements: {self.disagreements}"


@dataclass
class Gone:
    """The same for nests that were stopped."""

    first: int
    nests: int = 0
    disagreements: int = 0
    outcomes: Counter[str] = field(default_factory=Counter)
    engines: Counter[str] = field(default_factory=Counter)

    def add(self, found: Resumed) -> None:
        """Count one."""
        self.nests += 1
        self.outcomes[found.outcome] += 1
        self.engines.update(found.engines)
        self.disagreements += bool(found.differ)

    def lines(self) -> Iterator[str]:
        """The report."""
        outcomes = ", ".join(f"{k} {what}" for what, k in sorted(self.outcomes.items()))
        yield f"nests stopped: {self.nests}" + (f"; {outcomes}" if outcomes else "")
        yield f"held against every way to go on: {_listed(self.engines)}"
        yield f"disagreements: {self.disagreements}"


def _listed(counts: Counter[str]) -> str:
    return ", ".join(f"{name} {k}" for name, k in sorted(counts.items())) or "none"


if __name__ == "__main__":
    main()
