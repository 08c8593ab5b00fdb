"""The Python side of `no_islands.mzn`."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Bools, Ints
from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.graphs import weak_components
from kerfwise.encoder.minizinc_data import Fields, flags, numbers
from kerfwise.encoder.nest import Nest
from kerfwise.rules.catalogue.no_islands import NoIslandsOptions
from kerfwise.rules.judging.holding import clusters as together
from kerfwise.rules.judging.holding import holding
from kerfwise.rules.minizinc.twin import Twin, TwinCase


class NoIslandsTwin(Twin[NoIslandsOptions]):
    """What hangs together, and what on the frame."""

    def data(self, case: TwinCase, options: NoIslandsOptions) -> Fields:
        return [
            ("no_islands_framed", flags(on_the_frame(case.facts, options.frame_share).tolist())),
            ("no_islands_cluster", numbers((clusters(case.facts) + 1).tolist())),
        ]

    def measured(self, nest: Nest, cuts: CutSequence, options: NoIslandsOptions) -> Fields:
        joined, framed = holding(nest, options.web_mm, options.edge_band_mm, options.frame_share)
        outer = [nest.index[part.outer.id] for part in nest.parts]
        cluster = list(range(len(nest.contours) + 1, 2 * len(nest.contours) + 1))
        for number, members in enumerate(together(joined), 1):
            for k in members:
                cluster[outer[k]] = number
        on_frame = {outer[k] for k in framed}
        return [
            ("no_islands_framed", flags(k in on_frame for k in range(len(nest.contours)))),
            ("no_islands_cluster", numbers(cluster)),
        ]


def clusters(facts: Facts) -> Ints:
    """A number for every contour: outer contours in one place that face each other, however far along, share theirs."""
    faced = facts.neighbours
    same = facts.parent[faced.row] == facts.parent[faced.neighbour]
    return weak_components(facts.n, np.column_stack([faced.row[same], faced.neighbour[same]]))


def on_the_frame(facts: Facts, frame_share: float) -> Bools:
    """Contours that face solid metal or the strip along the edge for that share of their length, or their host."""
    lengths_mm = np.array([c.curve.length_mm for c in facts.nest.contours])
    framed = facts.edge_length_mm.sum(axis=1) + facts.solid_mm >= frame_share * lengths_mm - 1e-6
    faced = facts.neighbours
    framed[faced.row[facts.parent[faced.row] != facts.parent[faced.neighbour]]] = True
    return np.asarray(framed)
