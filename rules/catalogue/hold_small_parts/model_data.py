"""The Python side of `hold_small_parts.mzn`."""

from __future__ import annotations

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.minizinc_data import Fields, flags
from kerfwise.encoder.nest import Nest
from kerfwise.rules.catalogue.hold_small_parts import HoldSmallParts, HoldSmallPartsOptions, unheld
from kerfwise.rules.minizinc.twin import Twin, TwinCase


class HoldSmallPartsTwin(Twin[HoldSmallPartsOptions]):
    """Ways to cut that leave a part without its tabs."""

    def data(self, case: TwinCase, options: HoldSmallPartsOptions) -> Fields:
        without = {k for k, _, _ in unheld(case.facts, options)}
        return [("hold_small_parts_unheld", flags(k in without for k in range(len(case.facts.candidates))))]

    def measured(self, nest: Nest, cuts: CutSequence, options: HoldSmallPartsOptions) -> Fields:
        broken = {v.contours[0] for v in HoldSmallParts().violations(nest, cuts, options)}
        return [("hold_small_parts_unheld", flags(contour.id in broken for contour in nest.contours))]
