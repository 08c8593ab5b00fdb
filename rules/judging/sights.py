"""Straight lines from part to part over metal: they show that metal goes on, without its pieces being looked for."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints


@dataclass(frozen=True, eq=False, slots=True)
class Sights:
    """Straight lines from part to part that are metal all along until some other part is out.

    `ends` (lines, 2) are the parts that a line leads from and to; `of[q]` are pairs (number of a line, part that it
    leads to). What part `bars[k, 1]` takes with it crosses line `bars[k, 0]`, as it does that of each line to the part
    itself; the lines `barred_by[q]` are those of part q. `inner` (parts, 2) is where the lines of each part begin.
    """

    ends: Ints
    of: list[list[tuple[int, int]]]
    bars: Ints
    barred_by: list[Ints]
    inner: Floats

    @property
    def count(self) -> int:
        """How many lines there are."""
        return len(self.ends)

    def goes_on(self, parts: Sequence[int], barred: Bools, far_mm: float) -> bool:
        """Whether lines that are not `barred` show that the metal of some parts is wider than `far_mm`."""
        reached, seen = list(parts), set(parts)
        low_x = low_y = math.inf
        high_x = high_y = -math.inf
        for q in reached:
            x, y = self.inner[q].tolist()
            low_x, low_y, high_x, high_y = min(low_x, x), min(low_y, y), max(high_x, x), max(high_y, y)
            if high_x - low_x > far_mm or high_y - low_y > far_mm:
                return True
            for sight, other in self.of[q]:
                if other not in seen and not barred[sight]:
                    seen.add(other)
                    reached.append(other)
        return False

    def goes_on_until(self, at: Ints, far_mm: float) -> Ints:
        """For each part the cut from which on lines no longer show that its metal is wider than `far_mm`, 0 for never.

        `at` is the cut that takes each part out. What lines join is put together from the last cut to the first.
        """
        barred_at = np.full(self.count, at.max(initial=0) + 1)
        np.minimum.at(barred_at, self.bars[:, 0], at[self.bars[:, 1]])
        last_first = np.argsort(-barred_at, kind="stable")
        until = [0] * len(at)
        group = list(range(len(at)))
        members = [[q] for q in group]
        boxes = [(x, y, x, y) for x, y in self.inner.tolist()]
        large = [False] * len(at)
        rows = zip(self.ends[last_first].tolist(), barred_at[last_first].tolist(), strict=True)
        for (a, b), cut in rows:
            one, other = group[a], group[b]
            if one == other:
                continue
            if len(members[one]) < len(members[other]):
                one, other = other, one
            (x0, y0, x1, y1), (u0, v0, u1, v1) = boxes[one], boxes[other]
            boxes[one] = x0, y0, x1, y1 = min(x0, u0), min(y0, v0), max(x1, u1), max(y1, v1)
            new: list[int] = []
            if large[one] or large[other] or x1 - x0 > far_mm or y1 - y0 > far_mm:
                new = [q for k in (one, other) if not large[k] for q in members[k]]
                large[one] = True
            for q in new:
                until[q] = cut
            for q in members[other]:
                group[q] = one
            members[one] += members[other]
        return np.array(until, dtype=np.int64)


def sights_of(areas: Any, inner: Any, grown: Any, ground: Any, far_mm: float) -> Sights:
    """Lines between parts that are no farther than `far_mm` from each other."""
    one, other = shapely.STRtree(areas).query(areas, predicate="dwithin", distance=far_mm)
    one, other = one[one < other], other[one < other]
    xy = shapely.get_coordinates(inner)
    lines = shapely.linestrings(np.stack([xy[one], xy[other]], axis=1))
    shapely.prepare(ground)
    held = shapely.contains_properly(ground, lines)
    one, other, lines = one[held], other[held], lines[held]
    of: list[list[tuple[int, int]]] = [[] for _ in areas]
    for k, (a, b) in enumerate(zip(one.tolist(), other.tolist(), strict=True)):
        of[a].append((k, b))
        of[b].append((k, a))
    line, by = shapely.STRtree(grown).query(lines, predicate="intersects")
    order = np.argsort(by, kind="stable")
    barred_by = np.split(line[order], np.searchsorted(by[order], np.arange(1, len(areas))))
    return Sights(np.column_stack([one, other]), of, np.column_stack([line, by]), barred_by, xy)
