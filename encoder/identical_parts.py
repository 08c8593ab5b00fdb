"""Parts that are copies of each other, as far apart as the torches of a gantry: what several of them cut together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import shapely

from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Nest, Part, with_parts

COPY_MM = 0.01
"""How far the outline of a copy may be off: less than a fifth of what a torch path may be."""

_SAME_MM = 1e-6


@dataclass(frozen=True, slots=True)
class Group:
    """Contours that torches cut together, by number: that of the first torch, of the second, and so on."""

    contours: tuple[int, ...]
    parts: tuple[int, ...]


def copies_of(nest: Nest, step: Point, count: int) -> list[tuple[int, ...]]:
    """Numbers of parts that `count` torches, `step` (mm) apart, cut together: as many as can be, in order.

    Of parts in a row, each a step behind the one before, so many at a time are taken from its beginning: no other way
    leaves fewer to be cut. Parts with marks are left out, for the tool that marks is one.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> row = [part(name, rect(10 + 100 * k, 10, 80, 80)) for k, name in enumerate("ABC")]
    >>> copies_of(nest(400, 100, *row), (100.0, 0.0), 2)
    [(0, 1)]
    """
    following = dict(_following(nest, step))
    starts = sorted(set(following) - set(following.values()))
    found = []
    for start in starts:
        row = [start]
        while row[-1] in following:
            row.append(following[row[-1]])
        found += [tuple(row[k : k + count]) for k in range(0, len(row), count) if len(row) > k + 1]
    return sorted(found)


def spacings_of(nest: Nest, axis: Literal["x", "y"], least_mm: float, most_mm: float) -> list[float]:
    """Distances along an axis by which parts are copies of each other by their sizes, those of most parts first.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> row = [part(name, rect(10 + 100 * k, 10, 80, 80)) for k, name in enumerate("ABCD")]
    >>> spacings_of(nest(500, 100, *row), "x", 50.0, 250.0)
    [100.0, 200.0]
    """
    boxes = shapely.bounds([part.outer.line for part in nest.parts if not part.marks]).reshape(-1, 4)
    along, across = (0, 1) if axis == "x" else (1, 0)
    middles, sizes = (boxes[:, :2] + boxes[:, 2:]) / 2, boxes[:, 2:] - boxes[:, :2]
    alike = np.round(np.column_stack([sizes, middles[:, across]]) / (2 * COPY_MM)).astype(np.int64)
    counts: Counter[float] = Counter()
    _, row = np.unique(alike, axis=0, return_inverse=True)
    for k in range(int(row.max(initial=-1)) + 1):
        places = np.sort(middles[row == k, along])
        apart = np.round(places[None, :] - places[:, None], 3)
        counts.update(apart[(apart >= least_mm) & (apart <= most_mm)].tolist())
    return sorted(counts, key=lambda mm: (-counts[mm], mm))


def _following(nest: Nest, step: Point) -> Iterable[tuple[int, int]]:
    """Pairs of parts: the second is the first, a step on."""
    numbers = [k for k, part in enumerate(nest.parts) if not part.marks]
    if not numbers:
        return
    boxes = shapely.bounds([nest.parts[k].outer.line for k in numbers])
    middles = (boxes[:, :2] + boxes[:, 2:]) / 2
    tree = shapely.STRtree(shapely.points(middles))
    moved = shapely.points(middles + np.array(step))
    for one, other in sorted(tree.query(moved, "dwithin", distance=COPY_MM).T.tolist()):
        if one != other and _same(nest.parts[numbers[one]], nest.parts[numbers[other]], step):
            yield numbers[one], numbers[other]


def _same(one: Part, other: Part, step: Point) -> bool:
    return pairs_of_contours(one, other, step) is not None


def pairs_of_contours(one: Part, other: Part, step: Point) -> list[tuple[Contour, Contour]] | None:
    """The contours of a part, each with that of another part a step on; None where that is no copy."""
    left, found = list(other), []
    if len(left) != len(list(one)):
        return None
    for contour in one:
        twin = next((c for c in left if _congruent(contour, c, step)), None)
        if twin is None:
            return None
        left.remove(twin)
        found.append((contour, twin))
    return found


def _congruent(one: Contour, other: Contour, step: Point) -> bool:
    if (one.kind, one.feed_share, one.corner_mm) != (other.kind, other.feed_share, other.corner_mm):
        return False
    boxes = np.array([one.line.bounds, other.line.bounds])
    if (np.abs(boxes[0] + np.array([*step, *step]) - boxes[1]) > COPY_MM).any():
        return False
    return bool(shapely.hausdorff_distance(one.curve.moved(*step).line(), other.line) <= COPY_MM)


def groups_of(nest: Nest, parts: Iterable[Sequence[int]], step: Point) -> list[Group]:
    """The contours of parts that are cut together, as groups."""
    found = []
    for numbers in parts:
        rows = [[nest.index[c.id]] for c in nest.parts[numbers[0]]]
        for k, number in enumerate(numbers[1:], 1):
            by = step[0] * k, step[1] * k
            for row, (_, twin) in zip(
                rows, pairs_of_contours(nest.parts[numbers[0]], nest.parts[number], by) or (), strict=True
            ):
                row.append(nest.index[twin.id])
        found += [Group(tuple(row), tuple(numbers)) for row in rows]
    return found


def align_copies(nest: Nest, groups: Iterable[Group], step: Point) -> Nest:
    """The nest with each copy drawn from the very points of the part that it is a copy of, moved."""
    curves = {}
    for group in groups:
        first = nest.contours[group.contours[0]]
        for k, number in enumerate(group.contours[1:], 1):
            curves[nest.contours[number].id] = first.curve.moved(step[0] * k, step[1] * k)

    def drawn(contours: Sequence[Contour]) -> tuple[Contour, ...]:
        return tuple(replace(c, curve=curves[c.id]) if c.id in curves else c for c in contours)

    parts = tuple(
        replace(part, outer=drawn((part.outer,))[0], holes=drawn(part.holes), slits=drawn(part.slits))
        if any(c.id in curves for c in part)
        else part
        for part in nest.parts
    )
    return with_parts(nest, parts)


def entries_of_copies(
    nest: Nest, entries: Mapping[str, Point], groups: Iterable[Group], step: Point
) -> dict[str, Point]:
    """Entries asked for, by contour id, with those at the same place of all that is cut together with these."""
    found = dict(entries)
    for group in groups:
        names = [nest.contours[k].id for k in group.contours]
        first = next((k for k, name in enumerate(names) if name in entries), None)
        if first is not None:
            x, y = entries[names[first]]
            for k, name in enumerate(names):
                found.setdefault(name, (x + step[0] * (k - first), y + step[1] * (k - first)))
    return found


def shared_candidates(
    candidates: Sequence[Candidate], groups: Iterable[Group], step: Point
) -> tuple[list[int], list[Group]]:
    """Numbers of the candidates that are left, and the groups without any: all torches of a group make the same cut.

    The candidates of a group's contours are left in the same order.
    """
    of: dict[int, list[int]] = {}
    for k, candidate in enumerate(candidates):
        of.setdefault(candidate.contour, []).append(k)
    kept, bare = {contour: list(numbers) for contour, numbers in of.items()}, []
    for group in groups:
        ways = [
            {(round(candidates[k].entry_mm, 3), candidates[k].direction): k for k in of.get(c, ())}
            for c in group.contours
        ]
        rows = [
            [way[key] for way in ways]
            for key in ways[0]
            if all(key in way for way in ways) and _one_cut([candidates[way[key]] for way in ways], step)
        ]
        if not rows:
            bare.append(group)
        for place, contour in enumerate(group.contours):
            kept[contour] = [row[place] for row in rows]
    return [k for contour in sorted(kept) for k in kept[contour]], bare


def _one_cut(candidates: Sequence[Candidate], step: Point) -> bool:
    """Whether these are one cut, each a step behind the one before."""
    first = candidates[0]
    for k, other in enumerate(candidates[1:], 1):
        if (first.edge_start, first.leaves, len(first.tabs)) != (other.edge_start, other.leaves, len(other.tabs)):
            return False
        if any(abs(a.width_mm - b.width_mm) > _SAME_MM for a, b in zip(first.tabs, other.tabs, strict=True)):
            return False
        rows = [np.array([c.pierce, c.entry, c.end, *(tab.at for tab in c.tabs)]) for c in (first, other)]
        if (np.abs(rows[1] - rows[0] - np.array(step) * k) > _SAME_MM * 1000).any():
            return False
        for a, b in ((first.lead_in, other.lead_in), (first.lead_out, other.lead_out)):
            if (a is None) != (b is None) or (a is not None and b is not None and a.vertices.shape != b.vertices.shape):
                return False
    return True
