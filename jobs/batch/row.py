"""What became of one nest on one machine: how it ended, its figures, its files, and what it was made of."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Literal, get_args

Ended = Literal["planned", "asks", "refused", "no fit", "no plan", "not safe", "fault"]
FORMAT = "kerfwise-batch/1"
PLAN = ".plan.json"
RECORD = ".batch.json"
"""What the name of a record ends in, beside the program."""


@dataclass(frozen=True, slots=True)
class Figures:
    """What a planner compares: mm, s, money a sheet; `gap` is None where nothing is proven.

    `excuses` are the sentences of the plan on rules that do not hold somewhere.
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
        """Whether the same would come of it again; a fault may have been the machine's."""
        return self.ended != "fault"

    def as_json(self) -> str:
        """The row as the text of its record."""
        return json.dumps({"format": FORMAT, **asdict(self)}, indent=1) + "\n"


def row_of(data: Any) -> Row | None:
    """The row of a record that was read as JSON; None where it is none."""
    try:
        if data["format"] != FORMAT or data["ended"] not in get_args(Ended):
            return None
        given = {name: data[name] for name in Row.__slots__}
        figures = given["figures"]
        if figures is not None:
            figures = Figures(**{**figures, "excuses": tuple(figures["excuses"])})
        return Row(**{**given, "figures": figures, "notes": tuple(given["notes"]), "files": dict(given["files"])})
    except (LookupError, TypeError, ValueError):
        return None
