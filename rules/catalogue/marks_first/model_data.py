"""The Python side of `marks_first.mzn`."""

from __future__ import annotations

from kerfwise.encoder.minizinc_data import Fields, flag
from kerfwise.encoder.nest import Nest
from kerfwise.rules.catalogue.marks_first import MarksFirstOptions
from kerfwise.rules.minizinc.twin import Twin


class MarksFirstTwin(Twin[MarksFirstOptions]):
    """Whether marks come first on the sheet or on their part."""

    def of_nest(self, nest: Nest, options: MarksFirstOptions) -> Fields:
        return [("marks_first_sheet", flag(options.scope == "sheet"))]
