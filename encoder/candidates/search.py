"""The search for entries with room for a lead, over all contours at once."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from kerfwise.arrays import Bools
from kerfwise.encoder.geometry.inscribed import narrower_than

from .approaches import Approaches, ways
from .candidate import LeadOptions
from .entries import ANYWHERE, TIED_MM, choose, choose_each, places
from .joints import Joints, Outline, joints_at
from .lead_in import edge_starts, lead_ins, least_clearance_mm
from .surroundings import Surroundings
from .tab_places import TabPlaces

ROUNDS = 3
"""How often entries without room are replaced by others."""

DENSE = 48
"""Entries to try of a contour that has found none."""


class _Pools:
    """The places of contours that could be entries: those not tried yet are `fresh`, those that are taken have a lead.

    `of` numbers the outline of each joint, ascending.
    """

    def __init__(self, outlines: Mapping[int, Outline], count: int, tabs: TabPlaces) -> None:
        self.outlines, self._count = list(outlines.values()), count
        at_mm, ranks, of = tabs.all_entries(self.outlines, *places(self.outlines, count))
        self._joints, self._fresh = joints_at(self.outlines, at_mm, of)
        self._ranks, self._of = ranks, of
        self._around_mm = np.array([outline.around_mm for outline in self.outlines])
        self._number = np.full(max(outlines, default=0) + 1, -1)
        self._number[list(outlines)] = np.arange(len(outlines))
        self._taken_mm, self._taken_of = np.zeros(0), np.zeros(0, np.int64)

    def draw(self) -> Joints:
        """The best entries that are still fresh, of each contour as many as are wanting."""
        wanting = np.maximum(self._count - np.bincount(self._taken_of, minlength=len(self.outlines)), 0)
        rows = np.flatnonzero(self._fresh)
        taken = self._taken_mm, self._taken_of
        at_mm, ranks, of = self._joints.entry_mm[rows], self._ranks[rows], self._of[rows]
        drawn = rows[choose_each(at_mm, ranks, of, self._around_mm, self._count, wanting, *taken)]
        self._fresh[drawn] = False
        return self._joints.take(drawn)

    def take(self, joints: Joints) -> None:
        """These have a lead."""
        at_mm = np.concatenate([self._taken_mm, joints.entry_mm])
        of = np.concatenate([self._taken_of, self._number[joints.contour]])
        order = np.lexsort((at_mm, of))
        at_mm, of = at_mm[order], of[order]
        new = (np.diff(of, prepend=-1) > 0) | (np.diff(at_mm, prepend=np.nan) != 0)
        self._taken_mm, self._taken_of = at_mm[new], of[new]

    def bare(self) -> list[Outline]:
        """The contours of which nothing is taken."""
        held = set(self._taken_of.tolist())
        return [outline for k, outline in enumerate(self.outlines) if k not in held]


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
    pools = _Pools(outlines, options.entries, tabs)
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
        pools.take(good.ways.joints)

    taken(tried(locked, patient=True, from_edge=True))
    for round_ in range(ROUNDS):
        taken(tried(pools.draw(), patient=False, from_edge=round_ == 0))
    last = tried(Joints.joined([dense(outline) for outline in pools.bare()]), patient=True, from_edge=True)
    taken(last.take(_spread(last, outlines, options.entries)))
    return Approaches.joined(found)


def _too_narrow(outline: Outline, options: LeadOptions) -> bool:
    """Whether no place in a hole keeps a pierce's clearance: the pierce of a lead to a hole lies in it."""
    of_hole = outline.contour.kind == "hole" and options.lead != "none"
    return of_hole and narrower_than(outline.contour.curve, 2 * least_clearance_mm(options) - TIED_MM)


def dense(outline: Outline, count: int = DENSE) -> Joints:
    """Entries all around a contour."""
    joints, reached = outline.joints(outline.around_mm * np.arange(count) / count)
    return joints.take(reached)


def _spread(found: Approaches, outlines: Mapping[int, Outline], count: int) -> Bools:
    """Those of `count` entries of each contour, well apart."""
    joints = found.ways.joints
    kept = np.full(len(joints), False)
    for k in np.unique(joints.contour).tolist():
        rows = np.flatnonzero(joints.contour == k)
        at_mm = np.unique(joints.entry_mm[rows])
        around_mm = outlines[k].around_mm
        chosen = choose(at_mm, np.full(len(at_mm), ANYWHERE), around_mm, count, np.zeros(0))
        kept[rows] = np.isin(joints.entry_mm[rows], at_mm[chosen])
    return kept
