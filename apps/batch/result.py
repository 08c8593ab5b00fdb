"""What became of one nest on one machine, and of the whole batch: errors by group, machines held against each other."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Literal, get_args

# What became of one nest on one machine: how it ended, its figures, its files, and what it was made of.

Ended = Literal["planned", "asks", "refused", "no fit", "no plan", "not safe", "not written", "fault"]
FORMAT = "kerfwise-batch/1"
PLAN = ".plan.json"
RECORD = ".batch.json"
"""What the name of a record ends in, beside the program."""


@dataclass(frozen=True, slots=True)
class Figures:
    """What a planner compares: mm, s, money a sheet; `gap` is None where nothing is proven.

    `excuses` are the sentences of the plan on hard rules that do not hold somewhere, `state` says that in short: kept,
    or kept but for so many places.
    """

    contours: int
    pierces: int
    cut_mm: float
    idle_mm: float
    time_s: float
    gap: float | None
    excuses: tuple[str, ...] = ()
    cost: float | None = None
    currency: str = ""
    state: str = ""


@dataclass(frozen=True, slots=True)
class Row:
    """One nest on one machine.

    `nest` is its name in the folder of the batch, `source` its file. `ended` says whether it was planned, or how it was
    refused, and `told` why; `relax` that some rules may give way. `quantity` is how many sheets are cut, `order` and
    `due`, a day, for whom and when, where its job file says so. `key` is the sha256 of all that the answer depends
    on, `files` have the sha256 of each by its name.
    """

    nest: str
    source: str
    machine: str
    ended: Ended
    told: str = ""
    relax: bool = False
    quantity: int = 1
    order: str = ""
    due: str = ""
    figures: Figures | None = None
    notes: tuple[str, ...] = ()
    thumbnail: str = ""
    key: str = ""
    files: Mapping[str, str] = field(default_factory=dict)

    @property
    def planned(self) -> bool:
        """Whether there is a program."""
        return self.ended == "planned"

    @property
    def for_good(self) -> bool:
        """Whether the same would come of it again; a fault, or a full disk, may have been the machine's."""
        return self.ended not in ("fault", "not written")

    def as_json(self) -> str:
        """The row as the text of its record."""
        return json.dumps({"format": FORMAT, **asdict(self)}, indent=1) + "\n"


def row_of(data: Any) -> Row | None:
    """The row of a record that was read as JSON; None where it is none."""
    try:
        if data["format"] != FORMAT or data["ended"] not in get_args(Ended):
            return None
        fields = {name: data[name] for name in Row.__slots__}
        figures = fields["figures"]
        if figures is not None:
            figures = Figures(**{**figures, "excuses": tuple(figures["excuses"])})
        return Row(**{**fields, "figures": figures, "notes": tuple(fields["notes"]), "files": dict(fields["files"])})
    except (LookupError, TypeError, ValueError):
        return None


# What was refused, and what to do about it: one group for all that have the same trouble.

_PARTICULARS = re.compile(r"'[^']*'|\"[^\"]*\"|\(.*?\)|\S*\d\S*")
"""Of a message: names, numbers and coordinates, which differ from nest to nest."""

_COUNTED = re.compile(r"\b\d+ (\w+?)s?\b")
"""Such as `1 problem` and `3 problems`."""

HEADS = {
    "asks": "The drawing raises questions that nobody has answered",
    "refused": "The nest cannot be cut as it is drawn",
    "no fit": "The nest and what is asked for it do not fit",
    "no plan": "The rules leave no plan",
    "not safe": "The check refuses the plan",
    "not written": "What was planned could not be written",
    "fault": "Something went wrong that has nothing to do with the nest",
}
_REMEDIES = {
    "asks": "Write the answers in the job file beside the nest, or in the profile's drawing.answers, and run the same "
    "command again.",
    "refused": "Mend the drawing and run the same command again: what has changed is planned then.",
    "no fit": "Change what is named, in the nest, its job file or the profile, and run the same command again.",
    "no plan": "Change the lock, the rule or the nest that is named, and run the same command again.",
    "not safe": "Plan the nest alone with `kerfwise solve`, which prints the verdict of every rule.",
    "not written": "Make room in the folder of the programs, or let it be written to, and run the same command again.",
    "fault": "Run the same command again. If it stays so, send the report that it names.",
}
_RELAX = "With --relax (in Python: relax=True) the batch takes the way out that is named, and marks it in the plan. "


@dataclass(frozen=True, slots=True)
class Group:
    """Rows with the same trouble: what it is, what to do, and the rows."""

    head: str
    remedy: str
    rows: tuple[Row, ...]

    def said(self) -> Iterator[tuple[str, str, tuple[str, ...]]]:
        """A nest, what is said of it, and the machines for which it is said, in the order of the rows."""
        machines: dict[tuple[str, str], list[str]] = {}
        for row in self.rows:
            machines.setdefault((row.nest, row.told), []).append(row.machine)
        yield from ((nest, notes, tuple(of)) for (nest, notes), of in machines.items())


def groups_of(rows: Iterable[Row]) -> tuple[Group, ...]:
    """What was refused, the largest group first.

    Two have the same trouble where they ended alike and the first lines of what is said differ in names and numbers.
    """
    alike: dict[tuple[str, bool, str], list[Row]] = {}
    for row in rows:
        if not row.planned:
            first = row.told.split("\n", 1)[0]
            alike.setdefault((row.ended, row.relax, _PARTICULARS.sub("…", _COUNTED.sub(r"… \1", first))), []).append(
                row
            )
    ordered = sorted(alike.items(), key=lambda item: (-len(item[1]), item[0]))
    return tuple(
        Group(HEADS[ended], (_RELAX if relax else "") + _REMEDIES[ended], tuple(of))
        for (ended, relax, _), of in ordered
    )


# Long refusals told in short: the first few of what is listed, and how many more there are.

MOST = 3
"""So many of a list are told; a list that is one longer is told as a whole."""
_ITEM = "  - "


@dataclass(frozen=True, slots=True)
class TruncatedText:
    """What is said of a nest in two pieces: what is told at once, and the lines that are folded away."""

    told: str
    rest: tuple[str, ...] = ()

    @property
    def more(self) -> str:
        """How many of the list are folded away; "" where none is."""
        return f"… and {sum(line.startswith(_ITEM) for line in self.rest)} more" if self.rest else ""


def truncate(text: str) -> TruncatedText:
    """What is said of a nest, the list in it cut short.

    A list is of lines that begin with `  - `; lines below one that begin otherwise belong to it.

    Examples
    --------
    >>> short = truncate("5 problems" + "".join(f"\\n  - P{k} is open" for k in range(5)))
    >>> short.told.count("is open"), short.more
    (3, '… and 2 more')
    >>> truncate("it is open").more
    ''
    """
    lines = text.split("\n")
    items = [k for k, line in enumerate(lines) if line.startswith(_ITEM)]
    if len(items) <= MOST + 1:
        return TruncatedText(text)
    return TruncatedText("\n".join(lines[: items[MOST]]), tuple(lines[items[MOST] :]))


# The machines of a batch held against each other: sums of each, and which is the quicker, which the cheaper.


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


def rows_by_nest(rows: Iterable[Row]) -> Mapping[str, tuple[Row, ...]]:
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
