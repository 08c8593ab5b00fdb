"""Which metal comes loose, and when: from all kerfs in the order in which they are burnt, whoever burns them and why.

Metal is loose when kerfs have cut it off the frame of the sheet: nothing holds it any more, so that it drops, tips or
moves. The kerfs are put together once; from the finished sheet back to the whole one, burn after burn is undone, and
what holds together then is found by union of its faces.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Bools, Ints
from kerfwise.encoder.graphs import weak_components

HOLDS_MM = 20.0
"""A piece with so much of the sheet's border left on it lies on the frame of the table, and holds."""
THIN_MM = 0.02
"""A web no wider than this holds nothing: that is what chords and rounding may make of kerfs that meet."""
CRUMB_MM2 = 1.0
"""Smaller pieces burn up or fall through the grate; nothing is cut from them."""
CRUMB_WIDTH_MM = 0.2
"""A piece nowhere wider than this is dross."""
OVER_MM = 0.5
"""A path over loose metal for no longer than this touches its edge only."""
IN_METAL_MM = 0.05
"""A path so near to the metal of a part is in that part's own kerf, or in its metal."""
_QUADRANT = 8
_CHORD_MM = 0.003
_SPECK_MM2, _AT_MM, _ROUNDING = 1e-9, 1e-6, 1e-9


@dataclass(frozen=True, eq=False, slots=True)
class Face:
    """Metal that comes loose: its area, since which burn, and which burn takes it away.

    Burns count from 0; where none takes it away `gone` is the number of all burns. It lies in its `field` of kerfs that
    meet, as number `k` there.
    """

    area: shapely.Polygon
    since: int
    gone: int
    field: _Field | None = None
    k: int = 0

    def walls(self) -> frozenset[int]:
        """Burns that are all around the piece that it is of, as it comes loose: with these alone it would be."""
        return frozenset((self.since,)) if self.field is None else self.field.walls(self.k, self.since)


def loosened(sheet: shapely.Geometry, burns: Sequence[shapely.Geometry], kerf_mm: float) -> list[Face]:
    """The metal of a sheet that comes loose while lines are burnt, one after the other, each `kerf_mm` wide.

    The frame is the largest piece with some of the sheet's outer border; a piece with `HOLDS_MM` of that holds as well.
    What one burn alone cuts off is left out where no later burn comes near: most contours of a lawful order are so, and
    to widen them all took half of a check.

    Examples
    --------
    >>> inner, outer = shapely.box(40, 40, 60, 60).exterior, shapely.box(20, 20, 80, 80).exterior
    >>> [(face.since, face.gone) for face in loosened(shapely.box(0, 0, 100, 100), [outer, inner], 2.0)]
    [(0, 2)]
    """
    if not len(burns):
        return []
    lines = np.array(burns, dtype=object)
    tree = shapely.STRtree(lines)
    pairs = tree.query(lines)
    first, later = pairs[:, pairs[1] > pairs[0]]  # what enters the hull of a burn lies in its box
    some, of = np.unique(first, return_inverse=True)
    enters = shapely.intersects(shapely.convex_hull(lines[some])[of], lines[later])
    entered = np.bincount(first[enters], minlength=len(lines)) > 0
    kerfs, owner, label = _kerfs(sheet, lines, kerf_mm, entered | _near_others(sheet, lines, tree, kerf_mm))
    n, border = len(kerfs), shapely.boundary(sheet)
    found: list[Face] = []
    counts = np.bincount(label)
    alone = counts[label[:n]] == 1
    rings = shapely.get_num_interior_rings(kerfs)
    for k in np.flatnonzero(alone & (rings > 0)).tolist():
        holes = [shapely.Polygon(ring) for ring in kerfs[k].interiors]
        found += [Face(hole, int(owner[k]), len(burns)) for hole in holes]
    for name in np.unique(label[:n][~alone]).tolist():
        mine = np.flatnonzero(label[:n] == name)
        outline = border if label[n] == name else None
        field = _Field(kerfs[mine], owner[mine], sheet, outline, len(burns))
        found += field.loose()
    return found


def meeting(sheet: shapely.Geometry, burns: Sequence[shapely.Geometry], kerf_mm: float) -> list[int]:
    """The burns, by number, whose kerfs meet those of others, or the border, or go round more than one piece of metal.

    Every other burn leaves one piece at the most, which it goes round.
    """
    if not len(burns):
        return []
    lines = np.array(burns, dtype=object)
    near = _near_others(sheet, lines, shapely.STRtree(lines), kerf_mm)
    kerfs, owner, label = _kerfs(sheet, lines, kerf_mm, near | ~_convex(lines))
    several = np.bincount(label)[label[: len(kerfs)]] > 1
    return sorted(set(owner[several | (shapely.get_num_interior_rings(kerfs) > 1)].tolist()))


def _near_others(sheet: shapely.Geometry, lines: Any, tree: shapely.STRtree, kerf_mm: float) -> Bools:
    """Which lines are so near to another, or to the border, that their kerfs may meet it."""
    reach_mm = kerf_mm + THIN_MM + 2 * _CHORD_MM
    one, other = tree.query(lines, "dwithin", reach_mm)
    near = np.bincount(one[one != other], minlength=len(lines)) > 0
    border = shapely.boundary(sheet)
    shapely.prepare(border)
    return np.asarray(near | shapely.dwithin(border, lines, reach_mm) | ~shapely.contains_properly(sheet, lines))


def _convex(lines: Any) -> Bools:
    """Which lines are rings about a convex piece: they go round no other one."""
    rings = np.flatnonzero(shapely.get_type_id(lines) == shapely.GeometryType.LINEARRING)
    convex = np.zeros(len(lines), dtype=np.bool_)
    hulls = shapely.convex_hull(lines[rings])
    inside_mm2 = shapely.area(shapely.polygons(lines[rings]))
    convex[rings] = inside_mm2 > (1 - _ROUNDING) * shapely.area(hulls)
    return convex


def _kerfs(sheet: shapely.Geometry, lines: Any, kerf_mm: float, asked: Bools) -> tuple[Any, Ints, Ints]:
    """The pieces of the kerfs `asked` for, whose they are, and what meets what: the border comes last there."""
    numbers = np.flatnonzero(asked)
    wide = shapely.buffer(shapely.simplify(lines[asked], _CHORD_MM), (kerf_mm + THIN_MM) / 2, quad_segs=_QUADRANT)
    kerfs, of = shapely.get_parts(wide, return_index=True)
    one, other = shapely.STRtree(kerfs).query(kerfs, "intersects")
    shapely.prepare(sheet)
    at_border = np.flatnonzero(~shapely.contains_properly(sheet, kerfs))
    border = np.column_stack([at_border, np.full(len(at_border), len(kerfs))])
    links = np.concatenate([np.column_stack([one, other]), border])
    return kerfs, numbers[of], weak_components(len(kerfs) + 1, links)


class _Field:
    """Kerfs that meet, and the faces that their edges make of the sheet.

    `first` (faces,) is the earliest burn that takes each face away, the number of all burns where none does.
    """

    def __init__(self, kerfs: Any, owner: Ints, sheet: shapely.Geometry, border: Any, count: int) -> None:
        self.count, self.bounded = count, border is not None
        rings = [ring for area in shapely.get_parts(sheet) for ring in shapely.get_rings(area)[1:]]
        self.openings = shapely.MultiLineString(rings if self.bounded else [])
        edges = [*shapely.boundary(kerfs), *([border] if border is not None else [])]
        faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(shapely.union_all(edges))))
        faces = faces[shapely.area(faces) > _SPECK_MM2]
        points = shapely.point_on_surface(faces)
        if self.bounded:
            inside = shapely.intersects(sheet, points)
            faces, points = faces[inside], points[inside]
        self.faces = faces
        tree = shapely.STRtree(points)
        kerf, face = tree.query(kerfs, "intersects")
        self.first: Ints = np.full(len(faces), count, dtype=np.int64)
        np.minimum.at(self.first, face, owner[kerf])
        self._edges()

    def _edges(self) -> None:
        """Which faces lie side by side, how long each is at the sheet's border, and which lie at the outside."""
        rings, of = shapely.get_rings(self.faces, return_index=True)
        at, counts = shapely.get_coordinates(rings), shapely.get_num_coordinates(rings)
        of = np.repeat(of, counts)
        last = np.cumsum(counts) - 1
        rows = np.column_stack([at[:-1], at[1:]])
        keep = np.ones(len(rows), dtype=bool)
        keep[last[:-1]] = False
        rows, of = rows[keep], of[:-1][keep]
        turned = (rows[:, 0] > rows[:, 2]) | ((rows[:, 0] == rows[:, 2]) & (rows[:, 1] > rows[:, 3]))
        rows[turned] = rows[turned][:, [2, 3, 0, 1]]
        order = np.lexsort(rows.T)
        rows, of = rows[order], of[order]
        same = (rows[1:] == rows[:-1]).all(axis=1)
        begin = np.flatnonzero(same)
        pairs = np.sort(np.column_stack([of[begin], of[begin + 1]]), axis=1)
        pairs = np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0)
        self.beside: list[list[int]] = [[] for _ in self.faces]
        for a, b in pairs.tolist():
            self.beside[a].append(b)
            self.beside[b].append(a)
        lone = np.ones(len(rows), dtype=bool)
        lone[begin] = lone[begin + 1] = False
        if not self.openings.is_empty:
            middles = shapely.points((rows[:, :2] + rows[:, 2:]) / 2)
            lone &= shapely.distance(self.openings, middles) > _AT_MM
        lengths = np.hypot(rows[lone, 2] - rows[lone, 0], rows[lone, 3] - rows[lone, 1])
        self.outer_mm = np.bincount(of[lone], weights=lengths, minlength=len(self.faces))

    @cached_property
    def since(self) -> Ints:
        """The burn that cuts each face off the frame (faces,); the number of all burns where none does."""
        return _Joined(self).since

    def loose(self) -> Iterator[Face]:
        """The faces that come loose."""
        for k in np.flatnonzero(self.since < self.first).tolist():
            if self.since[k] < self.count:
                yield Face(self.faces[k], int(self.since[k]), int(self.first[k]), self, k)

    def walls(self, face: int, since: int) -> frozenset[int]:
        """The burns along the outline of the piece that a face is of after burn number `since`."""
        piece, seen = {face}, deque([face])
        edge: set[int] = set()
        while seen:
            for other in self.beside[seen.popleft()]:
                if self.first[other] <= since:
                    edge.add(other)
                elif other not in piece:
                    piece.add(other)
                    seen.append(other)
        outline = shapely.Polygon(shapely.union_all(self.faces[sorted(piece)]).exterior)
        around = [k for k in sorted(edge) if not outline.contains(shapely.point_on_surface(self.faces[k]))]
        return frozenset(self.first[around].tolist())


class _Joined:
    """Faces put together from the finished sheet back to the whole one: what is together holds together."""

    def __init__(self, field: _Field) -> None:
        n, self.field = len(field.faces), field
        self.up = list(range(n))
        self.members = [[k] for k in range(n)]
        self.area: list[float] = shapely.area(field.faces).tolist()
        self.outer_mm: list[float] = field.outer_mm.tolist()
        self.since = np.full(n, -1, dtype=np.int64)
        self.held: Bools = np.zeros(n, dtype=bool)
        self.largest = -1
        there = np.zeros(n, dtype=bool)
        by_time = np.argsort(-field.first, kind="stable")
        times = field.first[by_time]
        for batch in np.split(by_time, np.flatnonzero(np.diff(times)) + 1):
            when = int(field.first[batch[0]]) if len(batch) else 0
            there[batch] = True
            for k in batch.tolist():
                for other in field.beside[k]:
                    if there[other]:
                        self._join(k, other)
            roots = {self._root(k) for k in batch.tolist()}
            for root in roots:
                self._may_be_largest(root)
            for root in roots:
                self._hold(root, when)

    def _root(self, k: int) -> int:
        while self.up[k] != k:
            self.up[k] = self.up[self.up[k]]
            k = self.up[k]
        return k

    def _join(self, a: int, b: int) -> None:
        one, other = self._root(a), self._root(b)
        if one == other:
            return
        if len(self.members[one]) < len(self.members[other]):
            one, other = other, one
        self.up[other] = one
        self.members[one] += self.members[other]
        self.area[one] += self.area[other]
        self.outer_mm[one] += self.outer_mm[other]
        if self.largest == other:
            self.largest = one
        self.held[one] |= self.held[other]

    def _may_be_largest(self, root: int) -> None:
        if self.outer_mm[root] > 0 and (self.largest < 0 or self.area[root] > self.area[self.largest]):
            self.largest = root

    def _hold(self, root: int, when: int) -> None:
        """Note since when what has just been put together is loose, if it is held before burn number `when`."""
        least_mm = HOLDS_MM if self.field.bounded else 0.0
        if not (self.held[root] or self.outer_mm[root] > least_mm or root == self.largest):
            return
        self.held[root] = True
        for k in self.members[root]:
            if self.since[k] < 0:
                self.since[k] = when
        self.members[root] = []


def crumbs(areas: Any) -> Bools:
    """Which areas are too small or thin to be a piece that anything is cut from."""
    small: Bools = shapely.area(areas) <= CRUMB_MM2
    left = np.flatnonzero(~small)
    small[left] = shapely.is_empty(shapely.buffer(areas[left], -CRUMB_WIDTH_MM / 2, quad_segs=1))
    return small


def beside_metal(lines: Any, metal: Any, kerf_mm: float) -> Any:
    """What of each line (k,) does not run in the metal of parts: there it burns that, loose or not, as is judged apart.

    `metal` are the areas of parts. A line that is beside one by less than a quarter of the kerf is not.
    """
    wide = shapely.buffer(metal, min(IN_METAL_MM, kerf_mm / 4) - _CHORD_MM, quad_segs=1)
    left = np.array(lines, dtype=object)
    line, part = shapely.STRtree(wide).query(left, "intersects")
    for k in np.unique(line).tolist():
        left[k] = shapely.difference(left[k], shapely.union_all(wide[part[line == k]]))
    return left
