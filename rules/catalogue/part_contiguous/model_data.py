"""The Python side of `part_contiguous.mzn`."""

from __future__ import annotations

from kerfwise.encoder.minizinc_data import Fields, flag
from kerfwise.encoder.nest import Nest
from kerfwise.rules.catalogue.part_contiguous import PartContiguousOptions
from kerfwise.rules.minizinc.twin import Twin


class PartContiguousTwin(Twin[PartContiguousOptions]):
    """Whether marks belong to the run of a part."""

    def of_nest(self, nest: Nest, options: PartContiguousOptions) -> Fields:
        return [("part_contiguous_marks", flag(options.marks == "together"))]
