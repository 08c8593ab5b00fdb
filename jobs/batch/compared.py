"""The machines of a batch held against each other: sums of each, and which is the quicker, which the cheaper."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from .row import Row


@dataclass(frozen=True, slots=True)
class Total:
    """All sheets of all nests on one machine; `cost` is None where a nest that is planned has none.

    `planned` and `refused` are nests, and `excuses` those of their plans, however many sheets are cut.
    """

    machine: str
    planned: int
    refused: int
    sheets: int
    time_s: float
    cut_mm: float
    idle_mm: float
    cost: float | None
    currency: str
    excuses: int


def totals(rows: Sequence[Row], machines: Iterable[str]) -> tuple[Total, ...]:
    """A row a machine, in the order of the machines."""
    return tuple(_total(name, [row for row in rows if row.machine == name]) for name in machines)


def _total(machine: str, rows: Sequence[Row]) -> Total:
    sheets = [(row.figures, row.quantity) for row in rows if row.figures is not None]
    costs = [figures.cost * quantity for figures, quantity in sheets if figures.cost is not None]
    currencies = {figures.currency for figures, _ in sheets}
    priced = bool(costs) and len(costs) == len(sheets) and len(currencies) == 1
    return Total(
        machine=machine,
        planned=len(sheets),
        refused=len(rows) - len(sheets),
        sheets=sum(quantity for _, quantity in sheets),
        time_s=round(sum(figures.time_s * quantity for figures, quantity in sheets), 3),
        cut_mm=round(sum(figures.cut_mm * quantity for figures, quantity in sheets), 3),
        idle_mm=round(sum(figures.idle_mm * quantity for figures, quantity in sheets), 3),
        cost=round(sum(costs), 4) if priced else None,
        currency=currencies.pop() if priced else "",
        excuses=sum(len(figures.excuses) for figures, _ in sheets),
    )


def by_nest(rows: Iterable[Row]) -> Mapping[str, tuple[Row, ...]]:
    """The rows of each nest, in the order of the rows."""
    found: dict[str, list[Row]] = {}
    for row in rows:
        found.setdefault(row.nest, []).append(row)
    return {nest: tuple(of) for nest, of in found.items()}


def quickest(rows: Sequence[Row]) -> str:
    """The machine on which a nest is cut in the least time, the first of equals; "" where one was tried."""
    return _least(len(rows), [(row.machine, row.figures.time_s) for row in rows if row.figures is not None])


def cheapest(rows: Sequence[Row]) -> str:
    """The machine on which it costs least; "" also where prices are in several currencies, or a machine has none."""
    priced = [(row.machine, row.figures) for row in rows if row.figures is not None]
    if len({figures.currency for _, figures in priced}) != 1:
        return ""
    return _least(len(rows), [(machine, figures.cost) for machine, figures in priced])


def _least(tried: int, of: Sequence[tuple[str, float | None]]) -> str:
    """The machine of the least amount; `tried` is how many were, whether they can cut the nest or not."""
    amounts = [(amount, place, machine) for place, (machine, amount) in enumerate(of) if amount is not None]
    return min(amounts)[2] if amounts and len(amounts) == len(of) and tried > 1 else ""
