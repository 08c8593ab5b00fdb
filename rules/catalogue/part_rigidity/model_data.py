"""The Python side of `part_rigidity.mzn`."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.facts.facts import Facts, Stretch
from kerfwise.encoder.minizinc_data import Fields, numbers
from kerfwise.encoder.nest import Nest
from kerfwise.rules.catalogue.part_rigidity import PartRigidityOptions
from kerfwise.rules.judging.facing import faced_by_cuts
from kerfwise.rules.minizinc.twin import Further, Twin, TwinCase, rule_file

PER_MM = 100
ALLOWANCE = 0.02
"""Share of a tail by which the check, which measures it by itself, may differ."""
"""Lengths in MiniZinc data are whole hundredths of a millimetre."""


class PartRigidityTwin(Twin[PartRigidityOptions]):
    """How much of each tail must be held, and of each head should be free."""

    def data(self, case: TwinCase, options: PartRigidityOptions) -> Fields:
        return [
            ("part_rigidity_needed", numbers(tail_needed(case.facts, options.rigid_min).tolist())),
            ("part_rigidity_freed", numbers(head_freed(case.facts, options.head_rigid_max).tolist())),
        ]

    def measured(self, nest: Nest, cuts: CutSequence, options: PartRigidityOptions) -> Fields:
        needed = [0] * len(nest.contours)
        freed = [0] * len(nest.contours)
        near = (options.web_mm, options.edge_band_mm)
        tabbed = {nest.index[cut.contour] for cut in cuts if cut.tabs}
        for contour, end in faced_by_cuts(nest, cuts, options.tail_share, *near, last=True).items():
            short_mm = (options.rigid_min - ALLOWANCE) * end.total_mm - end.solid_mm
            needed[contour] = 0 if contour in tabbed else max(0, math.ceil(PER_MM * short_mm))
        for contour, begin in faced_by_cuts(nest, cuts, options.head_share, *near, last=False).items():
            rigid_mm = begin.solid_mm + sum(begin.contours_mm.values())
            freed[contour] = max(0, math.ceil(PER_MM * (rigid_mm - options.head_rigid_max * begin.total_mm)))
        return [("part_rigidity_needed", numbers(needed)), ("part_rigidity_freed", numbers(freed))]

    def further(self, options: PartRigidityOptions, weight_mm: float | None) -> Iterator[Further]:
        if options.head_weight_mm > 0:
            yield Further(rule_file("part-rigidity"), "part_rigidity_begins", options.head_weight_mm)


def tail_needed(facts: Facts, rigid_min: float) -> Ints:
    """For every candidate the tail that must face parts still in, 0.01 mm.

    0 where no candidate of the contour can, and where tabs hold its part.
    """
    outer, contour = _owners(facts)
    needed = np.maximum(_whole(rigid_min * facts.tail.total_mm - facts.tail.solid_mm), 0)
    able = np.zeros(facts.n, dtype=np.bool_)
    able[contour[needed <= _faced(facts.tail)]] = True
    able[sorted(facts.tabbed)] = False
    return np.where(outer & able[contour], needed, 0)


def head_freed(facts: Facts, head_rigid_max: float) -> Ints:
    """For every candidate the head that should face parts already out, 0.01 mm."""
    outer, _ = _owners(facts)
    rigid_mm = facts.head.solid_mm + _faced(facts.head) / PER_MM
    return np.where(outer, np.maximum(_whole(rigid_mm - head_rigid_max * facts.head.total_mm), 0), 0)


def _owners(facts: Facts) -> tuple[Bools, Ints]:
    """For every candidate: whether it cuts an outer contour, and which contour."""
    contour = np.array([c.contour for c in facts.candidates], dtype=np.int64)
    outer = np.array([c.kind == "outer" for c in facts.nest.contours], dtype=np.bool_)
    return outer[contour], contour


def _faced(stretch: Stretch) -> Ints:
    """Length of every candidate's stretch that faces contours, 0.01 mm."""
    lengths = np.rint(stretch.neighbours.length_mm * PER_MM)
    return np.bincount(stretch.neighbours.row, lengths, minlength=len(stretch.total_mm)).astype(np.int64)


def _whole(lengths_mm: Floats) -> Ints:
    """Lengths as whole 0.01 mm, rounded up but for what is noise."""
    return np.ceil(lengths_mm * PER_MM - 1e-6).astype(np.int64)
