"""The Python side of `cut_direction.mzn`."""

from __future__ import annotations

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import KINDS, Nest
from kerfwise.rules.catalogue.cut_direction import CutDirectionOptions
from kerfwise.rules.minizinc.twin import Fields, Twin, TwinCase, flags


class CutDirectionTwin(Twin[CutDirectionOptions]):
    """Which ways round each kind of contour is cut."""

    def data(self, case: TwinCase, options: CutDirectionOptions) -> Fields:
        return self._fields(options)

    def measured(self, nest: Nest, cuts: CutSequence, options: CutDirectionOptions) -> Fields:
        return self._fields(options)

    def _fields(self, options: CutDirectionOptions) -> Fields:
        allowed = [options.allowed(kind) for kind in KINDS]
        return [
            ("cut_direction_cw", flags("cw" in ways for ways in allowed)),
            ("cut_direction_ccw", flags("ccw" in ways for ways in allowed)),
        ]
