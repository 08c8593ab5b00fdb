"""The best costs that are known of instances, from a CSV file."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from kerfwise.encoder.contents import contents
from kerfwise.encoder.errors import InputError

MOST_BYTES = 10_000_000
COSTS = ("best_upper", "best", "cost")


@dataclass(frozen=True, slots=True)
class BestKnown:
    """Cost by (set, instance); the set is the name of the folder that a file lies in, "" where the CSV has none."""

    costs: Mapping[tuple[str, str], float]

    def of(self, path: str | Path) -> float | None:
        """The best known cost of a file: of its set if the CSV has sets, else of its name alone."""
        path = Path(path).resolve()
        name = path.name.removesuffix(".gz").rsplit(".", 1)[0]
        return self.costs.get((path.parent.name, name), self.costs.get(("", name)))


def read_best_known(path: str | Path) -> BestKnown:
    """Read a CSV with columns `instance`, `best_upper` (or `best`, or `cost`), and, if names repeat, `set`.

    Raises
    ------
    InputError
        If the file cannot be read, a column is missing or a cost is not a number.
    """
    path = Path(path)
    try:
        text = contents(path, MOST_BYTES).decode("utf-8-sig")
        rows = list(csv.DictReader(io.StringIO(text, newline="")))
    except (OSError, ValueError, csv.Error) as error:  # ValueError: no UTF-8, or a name that no file can have
        raise InputError(f"cannot be read: {error}", file=path) from None
    columns = {name for name in rows[0] if name is not None} if rows else set()  # None: cells beyond the last column
    column = next((name for name in COSTS if name in columns), None)
    if column is None or "instance" not in columns:
        raise InputError(f"expected columns instance and one of {', '.join(COSTS)}; found {sorted(columns)}", file=path)
    costs: dict[tuple[str, str], float] = {}
    for number, row in enumerate(rows, start=2):
        try:
            if row[column]:
                costs[row.get("set") or "", row["instance"]] = _finite(row[column])
        except ValueError:
            raise InputError(f"{column} is not a number: {row[column]!r}", file=path, line=number) from None
    return BestKnown(costs)


def _finite(text: str) -> float:
    """The number that a text is; ValueError if it is none, or `nan` or `inf`."""
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(text)
    return number
