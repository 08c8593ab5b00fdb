"""The index of a batch: one page, one table, one file of data. The same rows give the same bytes."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from types import MappingProxyType
from typing import Any

from .compared import by_nest, cheapest, quickest, totals
from .files import file_of
from .folded import folded
from .groups import groups_of
from .left import Left
from .page import page
from .row import Row

FORMAT = "kerfwise-batch-index/1"
COLUMNS = ("nest", "file", "quantity", "order", "due", "machine", "ended", "time_s", "cost", "currency", "idle_mm",
           "cut_mm", "pierces", "contours", "gap", "excuses", "quickest", "cheapest", "program", "told")  # fmt: skip


def index_files(
    rows: Sequence[Row],
    machines: Sequence[str],
    papers: Mapping[str, str] = MappingProxyType({}),
    left: Sequence[Left] = (),
) -> Mapping[str, str]:
    """index.html, index.csv and index.json of the rows, by their names.

    `papers` are the work sheets of machines, `left` programs of earlier runs that no row is about.
    """
    data = {**_data(rows, machines, papers), "left": [asdict(one) | {"why": one.why} for one in left]}
    return {
        "index.html": page(rows, machines, papers, left),
        "index.csv": _table(rows),
        "index.json": json.dumps(data, indent=1) + "\n",
    }


def _table(rows: Sequence[Row]) -> str:
    """A line a row, and its columns named on top: numbers with a point, empty where there is none."""
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    for of_nest in by_nest(rows).values():
        best = {"quickest": quickest(of_nest), "cheapest": cheapest(of_nest)}
        for row in of_nest:
            figures = {} if row.figures is None else asdict(row.figures) | {"excuses": len(row.figures.excuses)}
            said = {"nest": row.nest, "file": row.source, "machine": row.machine, "ended": row.ended}
            short = folded(row.told)
            said["told"] = f"{short.told}\n  {short.more}" if short.more else row.told
            sheets = {"quantity": row.quantity, "order": row.order, "due": row.due}
            marks = {column: "yes" if machine == row.machine else "" for column, machine in best.items()}
            writer.writerow({**said, **sheets, **figures, **marks, "program": file_of(row, ".nc")})
    return text.getvalue().encode("utf-8", "backslashreplace").decode()


def _data(rows: Sequence[Row], machines: Sequence[str], papers: Mapping[str, str]) -> Mapping[str, Any]:
    return {
        "format": FORMAT,
        "machines": [
            asdict(total) | ({"sheets_pdf": papers[total.machine]} if total.machine in papers else {})
            for total in totals(rows, machines)
        ],
        "nests": [
            {
                "nest": nest,
                "file": of_nest[0].source,
                "quantity": of_nest[0].quantity,
                "order": of_nest[0].order,
                "due": of_nest[0].due,
                "quickest": quickest(of_nest),
                "cheapest": cheapest(of_nest),
                "on": [_row(row) for row in of_nest],
            }
            for nest, of_nest in by_nest(rows).items()
        ],
        "refused": [
            {
                "what": group.head,
                "remedy": group.remedy,
                "rows": [{"nest": row.nest, "machine": row.machine, "told": row.told} for row in group.rows],
            }
            for group in groups_of(rows)
        ],
    }


def _row(row: Row) -> Mapping[str, Any]:
    figures = {} if row.figures is None else asdict(row.figures)
    files = {} if not row.files else {"program": file_of(row, ".nc"), "sha256": dict(row.files)}
    return {"machine": row.machine, "ended": row.ended, "told": row.told, "notes": row.notes, **figures, **files}
