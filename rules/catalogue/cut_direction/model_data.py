"""The Python side of `cut_direction.mzn`."""

from __future__ import annotations

from kerfwise.encoder.minizinc_data import Fields, flags
from kerfwise.encoder.nest import KINDS, Nest
from kerfwise.rules.catalogue.cut_direction import CutDirectionOptions
from kerfwise.rules.minizinc.twin import Twin


class CutDirectionTwin(Twin[CutDirectionOptions]):
    """Which ways round each kind of contour is cut."""

    def of_nest(self, nest: Nest, options: CutDirectionOptions) -> Fields:
        allowed = [options.allowed(kind) for kind in KINDS]
        return [
            ("cut_direction_cw", flags("cw" in ways for ways in allowed)),
            ("cut_direction_ccw", flags("ccw" in ways for ways in allowed)),
        ]
