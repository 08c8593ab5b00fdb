"""The facts of what the first torch of a gantry cuts, where others cut copies together with it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.already_cut import rest_of
from kerfwise.encoder.copies import Group
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest

from .compute import compute_facts
from .facts import Copies, Facing, Facts, Stretch


def nest_of_first(nest: Nest, groups: Sequence[Group]) -> Nest:
    """The nest without what further torches cut."""
    return rest_of(nest, frozenset(nest.contours[k].id for group in groups for k in group.contours[1:]))


def with_zones_of_first(whole: Facts, groups: Sequence[Group]) -> Facts:
    """The facts of the whole, where zones are those of what the first torch cuts, and copies are in the same zones."""
    nest = nest_of_first(whole.nest, groups)
    zones = compute_facts(nest, replace(whole.options, start_side=whole.start_side)).zone
    found = np.ones(whole.n, dtype=np.int64)
    for contour, zone in zip(nest.contours, zones.tolist(), strict=True):
        found[whole.nest.index[contour.id]] = zone
    for group in groups:
        found[list(group.contours)] = found[group.contours[0]]
    return replace(whole, zone=found)


def of_first_torch(whole: Facts, groups: Sequence[Group], step: Point) -> Facts:
    """The facts of what the first torch cuts, by numbers of their own.

    The contours of each group have the same candidates in `whole`, in the same order.
    """
    nest = nest_of_first(whole.nest, groups)
    left = np.array([whole.nest.index[c.id] for c in nest.contours], dtype=np.int64)
    own = np.full(whole.n, -1, dtype=np.int64)
    own[left] = np.arange(len(left))
    kept = [k for k, c in enumerate(whole.candidates) if own[c.contour] >= 0]
    own_candidate = np.full(len(whole.candidates), -1, dtype=np.int64)
    own_candidate[kept] = np.arange(len(kept))
    number, candidate = own.copy(), own_candidate.copy()
    torch = np.ones(whole.n, dtype=np.int64)
    for group in groups:
        first = whole.candidates_of(group.contours[0])
        for k, contour in enumerate(group.contours[1:], 2):
            number[contour], torch[contour] = own[group.contours[0]], k
            span = whole.candidates_of(contour)
            candidate[span.start : span.stop] = own_candidate[first.start : first.stop]

    def pairs(given: Ints) -> Ints:
        there = (own[given] >= 0).all(axis=1)
        return np.asarray(own[given[there]], dtype=np.int64).reshape(-1, 2)

    def facing(given: Facing, rows: Ints) -> Facing:
        row = rows[given.row]
        there = (own[given.neighbour] >= 0) & (row >= 0)
        return Facing(row[there], own[given.neighbour[there]], given.length_mm[there], given.gap_mm[there])

    def stretch(given: Stretch) -> Stretch:
        faced = facing(given.neighbours, own_candidate)
        return Stretch(given.total_mm[kept], given.edge_mm[kept], given.solid_mm[kept], faced)

    met = whole.older_kerfs.of_kept(kept, len(whole.candidates))
    there = own[met.rings[:, 1]] >= 0
    parent = whole.parent[left]
    candidates = tuple(replace(whole.candidates[k], contour=int(own[whole.candidates[k].contour])) for k in kept)
    return replace(
        whole,
        nest=nest,
        parent=np.where(parent >= 0, own[parent], -1),
        contains=pairs(whole.contains),
        level_ahead=pairs(whole.level_ahead),
        in_hull=pairs(whole.in_hull),
        neighbours=facing(whole.neighbours, own),
        edge_gap_mm=whole.edge_gap_mm[left],
        edge_length_mm=whole.edge_length_mm[left],
        solid_mm=whole.solid_mm[left],
        long=whole.long[left],
        zone=whole.zone[left],
        torch_heat_kj=whole.torch_heat_kj[left],
        candidates=candidates,
        first=np.searchsorted(np.array([c.contour for c in candidates], dtype=np.int64), np.arange(len(left) + 1)),
        head=stretch(whole.head),
        tail=stretch(whole.tail),
        scrap_framed=whole.scrap_framed[left],
        scrap_beside=pairs(whole.scrap_beside),
        older_kerfs=replace(met, rings=np.column_stack([met.rings[there, 0], own[met.rings[there, 1]]])),
        copies=Copies(whole, tuple(groups), number, candidate, torch, step),
    )
