"""The Python side of `part_contiguous.mzn`."""

from __future__ import annotations

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Nest
from kerfwise.rules.catalogue.part_contiguous import PartContiguousOptions
from kerfwise.rules.minizinc.twin import Fields, Twin, TwinCase, flag


class PartContiguousTwin(Twin[PartContiguousOptions]):
    """Whether marks belong to the run of a part."""

    def data(self, case: TwinCase, options: PartContiguousOptions) -> Fields:
        return self._fields(options)

    def measured(self, nest: Nest, cuts: CutSequence, options: PartContiguousOptions) -> Fields:
        return self._fields(options)

    def _fields(self, options: PartContiguousOptions) -> Fields:
        return [("part_contiguous_marks", flag(options.marks == "together"))]
