"""The Python side of `marks_first.mzn`."""

from __future__ import annotations

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Nest
from kerfwise.rules.catalogue.marks_first import MarksFirstOptions
from kerfwise.rules.minizinc.twin import Fields, Twin, TwinCase, flag


class MarksFirstTwin(Twin[MarksFirstOptions]):
    """Whether marks come first on the sheet or on their part."""

    def data(self, case: TwinCase, options: MarksFirstOptions) -> Fields:
        return self._fields(options)

    def measured(self, nest: Nest, cuts: CutSequence, options: MarksFirstOptions) -> Fields:
        return self._fields(options)

    def _fields(self, options: MarksFirstOptions) -> Fields:
        return [("marks_first_sheet", flag(options.scope == "sheet"))]
