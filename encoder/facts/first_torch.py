"""The facts of what the first torch of a gantry cuts, where others cut copies together with it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kerfwise.encoder.already_cut import rest_of
from kerfwise.encoder.copies import Group
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest

from .compute import compute_facts
from .facts import Copies, FactOptions, Facts
from .narrowed import kept_candidates, narrowed, numbered


def nest_of_first(nest: Nest, groups: Sequence[Group]) -> Nest:
    """The nest without what further torches cut."""
    return rest_of(nest, frozenset(nest.contours[k].id for group in groups for k in group.contours[1:]))


def with_zones_of_first(whole: Facts, groups: Sequence[Group]) -> Facts:
    """The facts of the whole, where zones are those of what the first torch cuts, and copies are in the same zones."""
    nest = nest_of_first(whole.nest, groups)
    options = replace(_of_leaders(whole, groups, len(nest.contours)), start_side=whole.start_side)
    zones = compute_facts(nest, options).zone
    found = np.ones(whole.n, dtype=np.int64)
    for contour, zone in zip(nest.contours, zones.tolist(), strict=True):
        found[whole.nest.index[contour.id]] = zone
    for group in groups:
        found[list(group.contours)] = found[group.contours[0]]
    return replace(whole, zone=found)


def _of_leaders(whole: Facts, groups: Sequence[Group], left: int) -> FactOptions:
    """The options, where what a further torch cuts is named by what it is cut with; `left` contours are the first's.

    A place among all contours is one as far along among these.
    """
    contours, parts = whole.nest.contours, whole.nest.parts
    leader = {contours[k].id: contours[group.contours[0]].id for group in groups for k in group.contours}
    head = {parts[k].id: parts[group.parts[0]].id for group in groups for k in group.parts}
    pairs = ((leader.get(a, a), leader.get(b, b)) for a, b in whole.options.zone_pairs)
    places: dict[str, int] = {}
    for part, place in whole.options.zone_places:
        places.setdefault(head.get(part, part), 1 + (place - 1) * left // whole.n if place < whole.n else left)
    fixed = dict.fromkeys((head.get(part, part), zone) for part, zone in whole.options.zone_fixed)
    return replace(
        whole.options,
        zone_pairs=tuple(dict.fromkeys((a, b) for a, b in pairs if a != b)),
        zone_places=tuple(places.items()),
        zone_fixed=tuple(fixed),
    )


def of_first_torch(whole: Facts, groups: Sequence[Group], step: Point) -> Facts:
    """The facts of what the first torch cuts, by numbers of their own.

    The contours of each group have the same candidates in `whole`, in the same order.
    """
    nest = nest_of_first(whole.nest, groups)
    own = numbered(whole.n, [whole.nest.index[c.id] for c in nest.contours])
    own_candidate = numbered(len(whole.candidates), kept_candidates(whole, own))
    number, candidate = own.copy(), own_candidate.copy()
    torch = np.ones(whole.n, dtype=np.int64)
    for group in groups:
        first = whole.candidates_of(group.contours[0])
        for k, contour in enumerate(group.contours[1:], 2):
            number[contour], torch[contour] = own[group.contours[0]], k
            span = whole.candidates_of(contour)
            candidate[span.start : span.stop] = own_candidate[first.start : first.stop]
    copies = Copies(whole, tuple(groups), number, candidate, torch, step)
    return replace(narrowed(whole, nest, own), copies=copies)
