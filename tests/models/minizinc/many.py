"""Many nests through every engine: `python -m kerfwise.tests.models.minizinc.many --nests 500`."""

from __future__ import annotations

import sys
from collections import Counter

import click

from kerfwise.tests.models.minizinc.agree import disagreements
from kerfwise.tests.models.minizinc.cases import case


@click.command()
@click.option("--nests", default=500, show_default=True, help="How many.")
@click.option("--first", default=0, show_default=True, help="Seed of the first.")
@click.option("--contours", default=7, show_default=True, help="Contours in a nest, at most.")
def main(nests: int, first: int, contours: int) -> None:
    """Hold MiniZinc against the other engines on random nests; exit code 1 where they differ."""
    counts: Counter[str] = Counter()
    for seed in range(first, first + nests):
        what, differ = disagreements(case(seed, contours))
        counts[what] += 1
        counts["different"] += bool(differ)
        for line in differ:
            click.echo(f"seed {seed}: {line}")
    click.echo(", ".join(f"{count} {what}" for what, count in sorted(counts.items())))
    sys.exit(1 if counts["different"] else 0)


if __name__ == "__main__":
    main()
