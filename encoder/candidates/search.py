"""The search for entries with room for a lead, over all contours at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from kerfwise.arrays import Bools, Floats
from kerfwise.encoder.geometry.inscribed import narrower_than

from .approaches import Approaches, ways
from .candidate import LeadOptions
from .entries import ANYWHERE, TIED_MM, Ranks, choose, places
from .joints import Joints, Outline
from .lead_in import edge_starts, lead_ins, least_clearance_mm
from .surroundings import Surroundings
from .tab_places import TabPlaces

ROUNDS = 3
"""How often entries without room are replaced by others."""

DENSE = 48
"""Entries to try of a contour that has found none."""


@dataclass(slots=True)
class _Pool:
    """The places of one contour that could be entries: those not tried yet are `fresh`, `taken_mm` have a lead."""

    outline: Outline
    joints: Joints
    ranks: Ranks
    fresh: Bools
    taken_mm: list[float] = field(default_factory=list)

    @staticmethod
    def of(outline: Outline, at_mm: Floats, ranks: Ranks) -> _Pool:
        joints, reached = outline.joints(at_mm)
        return _Pool(outline, joints, ranks, reached)

    def draw(self, count: int) -> Joints:
        """The best entries that are still fresh, as many as are wanting of `count`."""
        wanting = max(count - len(self.taken_mm), 0)
        rows = np.flatnonzero(self.fresh) if wanting else np.zeros(0, np.int64)
        around_mm = float(self.outline.drawn.starts_mm[-1])
        chosen = choose(self.joints.entry_mm[rows], self.ranks[rows], around_mm, count, np.array(self.taken_mm))
        drawn = rows[chosen[:wanting]]
        self.fresh[drawn] = False
        return self.joints.take(drawn)


def longest_lead_mm(outline: Outline, options: LeadOptions) -> float:
    """The longest lead-in to a contour; in a small hole not further than about its middle."""
    if outline.contour.kind == "outer":
        return options.lead_in_mm
    middle_mm = 2 * abs(outline.path.signed_area_mm2) / outline.path.length_mm
    return max(options.lead_in_min_mm, min(options.lead_in_mm, middle_mm))


def approaches_to(
    outlines: Mapping[int, Outline], locked: Joints, around: Surroundings, options: LeadOptions
) -> Approaches:
    """For every contour up to `options.entries` entries with room for a lead, and all locked ones that have it."""
    outlines = {k: outline for k, outline in outlines.items() if not _too_narrow(outline, options)}
    locked = locked.take(np.isin(locked.contour, np.array(list(outlines), dtype=np.int64)))
    longest = {k: longest_lead_mm(outline, options) for k, outline in outlines.items()}
    tabs = options.tab_places or TabPlaces()
    pools = {
        k: _Pool.of(outline, *tabs.entries(outline, *places(outline, options.entries)))
        for k, outline in outlines.items()
    }
    found: list[Approaches] = []

    def tried(joints: Joints, patient: bool, from_edge: bool) -> Approaches:
        candidates = ways(joints, outlines, options.directions)
        candidates = candidates.take(tabs.lawful(candidates, outlines))
        longest_mm = np.array([longest[k] for k in candidates.joints.contour.tolist()])
        if from_edge and options.edge_start and options.lead != "none":
            outer = np.array(
                [outlines[k].contour.kind == "outer" for k in candidates.joints.contour.tolist()], np.bool_
            )
            found.append(edge_starts(candidates.take(outer), around, options))
        return lead_ins(candidates, longest_mm, around, options, patient)

    def taken(good: Approaches) -> None:
        found.append(good)
        joints = good.ways.joints
        for k, entry_mm in zip(joints.contour.tolist(), joints.entry_mm.tolist(), strict=True):
            if entry_mm not in pools[k].taken_mm:
                pools[k].taken_mm.append(entry_mm)

    taken(tried(locked, patient=True, from_edge=True))
    for round_ in range(ROUNDS):
        drawn = Joints.joined([pool.draw(options.entries) for pool in pools.values()])
        taken(tried(drawn, patient=False, from_edge=round_ == 0))
    bare = [pool.outline for pool in pools.values() if not pool.taken_mm]
    last = tried(Joints.joined([dense(outline) for outline in bare]), patient=True, from_edge=True)
    taken(last.take(_spread(last, outlines, options.entries)))
    return Approaches.joined(found)


def _too_narrow(outline: Outline, options: LeadOptions) -> bool:
    """Whether no place in a hole keeps a pierce's clearance: the pierce of a lead to a hole lies in it."""
    of_hole = outline.contour.kind == "hole" and options.lead != "none"
    return of_hole and narrower_than(outline.contour.curve, 2 * least_clearance_mm(options) - TIED_MM)


def dense(outline: Outline, count: int = DENSE) -> Joints:
    """Entries all around a contour."""
    joints, reached = outline.joints(float(outline.drawn.starts_mm[-1]) * np.arange(count) / count)
    return joints.take(reached)


def _spread(found: Approaches, outlines: Mapping[int, Outline], count: int) -> Bools:
    """Those of `count` entries of each contour, well apart."""
    joints = found.ways.joints
    kept = np.full(len(joints), False)
    for k in np.unique(joints.contour).tolist():
        rows = np.flatnonzero(joints.contour == k)
        at_mm = np.unique(joints.entry_mm[rows])
        around_mm = float(outlines[k].drawn.starts_mm[-1])
        chosen = choose(at_mm, np.full(len(at_mm), ANYWHERE), around_mm, count, np.zeros(0))
        kept[rows] = np.isin(joints.entry_mm[rows], at_mm[chosen])
    return kept
