"""Which burns and rings do not belong together one to one: chains, and contours that several burns cut."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, field, replace

import numpy as np
import shapely

from kerfwise.encoder.geometry.curve import Curve

from .chords import chords_of_lines, chords_of_paths
from .stretches import LEAST_MM, Stretch, beside_own_mm, stretches


@dataclass(frozen=True, eq=False, slots=True)
class Shared:
    """Numbers of the burns that cut several rings, or rings with others, and of the rings that they cut so.

    `along` are the stretches along rings of all burns that were looked at.
    """

    burns: frozenset[int] = frozenset()
    rings: frozenset[int] = frozenset()
    along: Mapping[int, list[Stretch]] = field(default_factory=dict)


def shared(
    paths: Sequence[Curve | None],
    lines: Sequence[shapely.LineString],
    rings: Sequence[shapely.LineString | None],
    own: Sequence[int | None],
    within_mm: float,
    tabbed: Set[int] = frozenset(),
) -> Shared:
    """Find the burns that one ring each does not account for.

    Parameters
    ----------
    paths, lines
        The torch's paths and the same as lines; None is one that is not asked about, such as a mark.
    rings
        The rings of all contours, None where the torch goes round nothing.
    own
        For each path the contour that it cuts all by itself. One without a ring, such as a slit, shares nothing.
    within_mm
        How far a burn may be from a ring that it runs along.
    tabbed
        Rings that are not to be covered all round, so that even one burn alone does not cover them.
    """
    own = [None if ring in tabbed else ring for ring in own]
    asked = _asked(paths, lines, rings, own, within_mm)
    if not asked:
        return Shared()
    along = stretches_of(paths, rings, sorted(asked), within_mm)
    touched = {burn: _touched(along.get(burn, []), own[burn], rings) for burn in sorted(asked)}
    odd = {burn for burn, met in touched.items() if (ring := own[burn]) is None or (met and rings[ring] is not None)}
    whole = {ring for burn, ring in enumerate(own) if ring is not None and burn not in odd}
    burns_of: dict[int, set[int]] = {}
    for burn, row in along.items():
        for ring in {s.ring for s in row} - whole:
            burns_of.setdefault(ring, set()).add(burn)
    rings_of = {burn: touched[burn] | _one(own[burn]) for burn in odd}
    apart = {ring for ring, by in burns_of.items() if len(by) > 1} | tabbed
    burns = {burn for burn in odd if len(rings_of[burn]) > 1 or rings_of[burn] & apart}
    cut, waiting = set[int](), sorted(burns)
    while waiting:
        for ring in rings_of[waiting.pop()] - cut:
            cut.add(ring)
            more = set() if ring in whole else (burns_of.get(ring, set()) & odd) - burns
            burns |= more
            waiting += sorted(more)
    return Shared(frozenset(burns), frozenset(cut), along)


def stretches_of(
    paths: Sequence[Curve | None], rings: Sequence[shapely.LineString | None], burns: Sequence[int], within_mm: float
) -> dict[int, list[Stretch]]:
    """The stretches of some burns along all rings, by the numbers of the burns."""
    chords = chords_of_paths([path for burn in burns if (path := paths[burn]) is not None])
    lines = np.array([shapely.LineString() if ring is None else ring for ring in rings], dtype=object)
    near = np.unique(shapely.STRtree(lines).query(chords.boxes(within_mm))[1])
    found = stretches(chords, chords_of_lines(lines[near]), np.asarray(shapely.length(lines[near])), within_mm)
    return {burns[k]: [replace(s, ring=int(near[s.ring])) for s in row] for k, row in found.items()}


def _asked(
    paths: Sequence[Curve | None],
    lines: Sequence[shapely.LineString],
    rings: Sequence[shapely.LineString | None],
    own: Sequence[int | None],
    within_mm: float,
) -> set[int]:
    """Burns that cover no ring, or come near another ring than their own."""
    burns = np.array([k for k, path in enumerate(paths) if path is not None and path.segments], dtype=np.int64)
    if not len(burns):
        return set()
    around = np.array([shapely.LineString() if ring is None else ring for ring in rings], dtype=object)
    asked = np.array([lines[k] for k in burns.tolist()], dtype=object)
    bounds = shapely.bounds(asked)
    boxes = shapely.box(*(bounds + np.array([-within_mm, -within_mm, within_mm, within_mm])).T)
    row, ring = shapely.STRtree(around).query(boxes)
    mine = np.array([-1 if own[k] is None else own[k] for k in burns.tolist()], dtype=np.int64)
    other = ring != mine[row]
    row, ring = row[other], ring[other]
    some = asked[np.unique(row)]
    shapely.prepare(some)
    near = shapely.dwithin(asked[row], around[ring], within_mm)
    shapely.destroy_prepared(some)
    return set(burns[row[near]].tolist())


def _touched(row: Sequence[Stretch], own: int | None, rings: Sequence[shapely.LineString | None]) -> set[int]:
    """The rings beside its own that a burn runs along."""
    beside = beside_own_mm(row, own)
    return {k for k, mm in beside.items() if (ring := rings[k]) is not None and mm >= min(LEAST_MM, ring.length / 4)}


def _one(ring: int | None) -> set[int]:
    return set() if ring is None else {ring}
