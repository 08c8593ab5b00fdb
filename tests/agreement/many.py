"""Hundreds of random nests through every engine: `python -m kerfwise.tests.agreement.many --nests 500`."""

from __future__ import annotations

import sys
import time
from collections import Counter

import click

from kerfwise.tests.agreement.agree import Agreement, agreement
from kerfwise.tests.agreement.resumed import resumed_agreement


@click.command()
@click.option("--nests", default=500, show_default=True, help="How many.")
@click.option("--first", default=0, show_default=True, help="Seed of the first.")
@click.option("--slits", is_flag=True, help="Nests with slots narrower than the kerf, which slits open.")
@click.option("--options", is_flag=True, help="Options of rules drawn at random from what they declare.")
@click.option("--stopped", is_flag=True, help="What is left of nests after a stop: every engine goes on with it.")
def main(nests: int, first: int, slits: bool, options: bool, stopped: bool) -> None:
    """Hold the engines against every plan tried by the check; exit code 1 where they differ."""
    counts: Counter[str] = Counter()
    pairs: Counter[str] = Counter()
    started = time.monotonic()
    if stopped:
        sys.exit(_gone_on_with(range(first, first + nests)))
    for seed in range(first, first + nests):
        found = agreement(seed, slits, options)
        _count(counts, pairs, found)
        for line in found.differ:
            click.echo(f"seed {seed}: {line}")
    click.echo(f"nests tried: {nests} (seeds {first} to {first + nests - 1}, 5 to 9 contours)")
    click.echo(f"solved: {counts['solved']}, proven infeasible: {counts['infeasible']}, unproven: {counts['unproven']}")
    click.echo(
        "optima compared with every plan tried by the check: " + ", ".join(f"{e} {k}" for e, k in sorted(pairs.items()))
    )
    click.echo(f"of these within the check's allowance, not to the digit: {counts['blurred']}")
    click.echo(f"sets of admissible orders compared (check, statements, Gecode): {counts['order sets']}")
    click.echo(f"disagreements: {counts['disagreements']}")
    click.echo(f"minutes: {(time.monotonic() - started) / 60:.1f}", err=True)
    sys.exit(1 if counts["disagreements"] else 0)


def _gone_on_with(seeds: range) -> int:
    """The same after a stop; the exit code."""
    outcomes: Counter[str] = Counter()
    engines: Counter[str] = Counter()
    wrong = 0
    for seed in seeds:
        found = resumed_agreement(seed)
        outcomes[found.outcome] += 1
        engines.update(found.engines)
        wrong += bool(found.differ)
        for line in found.differ:
            click.echo(f"seed {seed}: {line}")
    click.echo(f"nests stopped: {len(seeds)}; " + ", ".join(f"{k} {what}" for what, k in sorted(outcomes.items())))
    click.echo("held against every way to go on: " + ", ".join(f"{name} {k}" for name, k in sorted(engines.items())))
    click.echo(f"disagreements: {wrong}")
    return 1 if wrong else 0


def _count(counts: Counter[str], pairs: Counter[str], found: Agreement) -> None:
    counts[found.outcome] += 1
    counts["blurred"] += found.blurred
    counts["order sets"] += found.order_sets
    counts["disagreements"] += bool(found.differ)
    pairs.update(found.engines)


if __name__ == "__main__":
    main()
