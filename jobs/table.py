"""Tables for whoever works on with pandas: the cuts of a plan, a row each."""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from kerfwise.encoder.errors import InputError
from kerfwise.models.plan.plan import Plan

if TYPE_CHECKING:
    import pandas

NO_PANDAS = "a table needs pandas, which is not installed: pip install pandas"


def data_frame(rows: Sequence[dict[str, Any]], columns: Sequence[str] | None = None) -> pandas.DataFrame:
    """The rows as a table.

    Raises
    ------
    InputError
        If pandas is not installed.
    """
    try:
        loaded: Any = importlib.import_module("pandas")
    except ImportError:
        raise InputError(NO_PANDAS) from None
    return loaded.DataFrame(rows, columns=columns)


CUT_COLUMNS = (
    "order", "contour", "part", "kind", "zone", "direction", "entry_x_mm", "entry_y_mm", "pierce_x_mm", "pierce_y_mm",
    "length_mm", "start_s", "end_s", "dwell_s", "because",
)  # fmt: skip


def cut_rows(plan: Plan) -> Iterator[dict[str, Any]]:
    """A row for each cut that the plan makes, in order, with the keys `CUT_COLUMNS`: lengths in mm, times in s."""
    for order, planned in enumerate(plan.cuts, plan.resumed_after + 1):
        cut = planned.cut
        row = (
            order, cut.contour, planned.part, planned.kind, cut.zone, cut.direction, *cut.entry, *cut.pierce,
            planned.length_mm, cut.start_s, cut.end_s, planned.dwell_s, "; ".join(planned.because),
        )  # fmt: skip
        yield dict(zip(CUT_COLUMNS, row, strict=True))
