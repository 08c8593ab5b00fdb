"""Numbers on the command line: `nan` and `inf`, which Python reads as numbers, are none."""

from __future__ import annotations

import math
from typing import Any

import click


class Amount(click.FloatRange):
    """A finite number in a range."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """The number, or a usage error."""
        number = float(super().convert(value, param, ctx))
        if not math.isfinite(number):
            self.fail(f"{value} is not an amount: expected a number such as 1.5", param, ctx)
        return number


AMOUNT = Amount(min=0)
AMOUNT_OVER_ZERO = Amount(min=0, min_open=True)

MEMORY = click.option(
    "--memory",
    "memory_gb",
    type=AMOUNT_OVER_ZERO,
    default=2.0,
    show_default=True,
    metavar="GB",
    help="What the process may hold: tables of engines that run at the same time fill what libraries, and moves over "
    "parts that are out, leave of it. CP-SAT and linear programs have their own.",
)
