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
from .facts import Copies, Facts
from .narrowed import kept_candidates, narrowed, numbered


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
