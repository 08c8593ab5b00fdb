"""The Python side of `scrap_last.mzn`."""

from __future__ import annotations

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.minizinc_data import Fields, flags, numbers, numbers_from_1
from kerfwise.encoder.nest import Nest
from kerfwise.rules.catalogue.scrap_last import ScrapLastOptions
from kerfwise.rules.judging.holding import bounding
from kerfwise.rules.minizinc.twin import Twin, TwinCase


class ScrapLastTwin(Twin[ScrapLastOptions]):
    """Which lines bound the frame, and which the same piece."""

    def data(self, case: TwinCase, options: ScrapLastOptions) -> Fields:
        beside = case.facts.column("scrap_beside")
        return [
            ("scrap_framed", flags(case.facts.column("scrap_framed").tolist())),
            ("n_scrap_beside", str(len(beside))),
            ("scrap_one", numbers((beside[:, 0] + 1).tolist())),
            ("scrap_other", numbers((beside[:, 1] + 1).tolist())),
        ]

    def measured(self, nest: Nest, cuts: CutSequence, options: ScrapLastOptions) -> Fields:
        framed, pairs = bounding(nest, options.kerf_mm)
        beside = sorted((nest.index[one], nest.index[other]) for one, other in pairs)
        return [
            ("scrap_framed", flags(contour.id in framed for contour in nest.contours)),
            ("n_scrap_beside", str(len(beside))),
            ("scrap_one", numbers_from_1(one for one, _ in beside)),
            ("scrap_other", numbers_from_1(other for _, other in beside)),
        ]
