"""What stands in the way of a lead: contours, parts, the edges of the sheet, and metal already burnt away."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Floats, Ints, split_in_halves
from kerfwise.encoder.already_cut import AlreadyCut
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve, lines_of
from kerfwise.encoder.nest import Contour, Nest, lines_of_contours
from kerfwise.encoder.torch_path import compensated, way_along

from .entries import Leads

CHORD_MM = 0.01
"""Contours are judged by chords that lie this close to them."""

NEAR_JOIN_MM = 0.5
"""So close to where it joins, a lead is as near to its own contour as the cut itself."""


@dataclass(frozen=True, eq=False, slots=True)
class Surroundings:
    """Every contour of a nest, its line, also in chords (`contour` tells whose each is), the parts' metal, the sheet.

    `part` numbers the part of each contour, `through` says that it is cut through, which a mark is not. `around` is the
    contour that the slot of a slit is of, else a contour itself.
    `void` is what a stopped program has already burnt away, where there was one.
    """

    contours: tuple[Contour, ...]
    part: Ints
    through: Bools
    slit: Bools
    around: Ints
    lines: Lines
    chords: shapely.STRtree
    contour: Ints
    metal: shapely.STRtree
    sheet: shapely.Polygon
    edges: shapely.Geometry
    void: BurntArea | None = None

    @staticmethod
    def of(nest: Nest, void: BurntArea | None = None) -> Surroundings:
        """The surroundings of all leads of a nest; scrap lines hinder none, since they are cut last."""
        nest = nest.without_scrap
        lines = lines_of_contours(nest.contours)
        points, of = shapely.get_coordinates(lines, return_index=True)
        follows = np.flatnonzero(of[1:] == of[:-1])
        chords = shapely.linestrings(np.stack([points[follows], points[follows + 1]], axis=1))
        metal = np.array([part.polygon for part in nest.parts], dtype=object)
        touching = ~shapely.is_valid(metal)  # themselves, which is no fault here
        metal[touching] = shapely.make_valid(metal[touching])
        shapely.prepare(metal)
        sheet = shapely.make_valid(nest.sheet.polygon)
        shapely.prepare(sheet)
        edges = sheet.boundary
        shapely.prepare(edges)
        return Surroundings(
            nest.contours,
            np.array(nest.owners, dtype=np.int64),
            np.array([c.kind != "mark" for c in nest.contours], dtype=np.bool_),
            np.array([c.kind == "slit" for c in nest.contours], dtype=np.bool_),
            np.array([nest.index.get(c.slot_of, k) for k, c in enumerate(nest.contours)], dtype=np.int64),
            lines,
            shapely.STRtree(chords),
            of[follows],
            shapely.STRtree(metal),
            sheet,
            edges,
            void,
        )

    def clear_leads(self, leads: Leads, contour: Ints, half_kerf_mm: float) -> Bools:
        """Leads whose kerf touches no contour but their own, and that one only where they join it.

        A slit is led into where it meets the path of the contour that its slot is of: that is its own one here.
        """
        reach_mm = max(half_kerf_mm, CHORD_MM)
        lines = shapely.linestrings(leads.points())
        row, chord = self.chords.query(lines, predicate="dwithin", distance=reach_mm + CHORD_MM)
        follows = (self.contour[chord] == contour[row]) & self.slit[contour[row]]
        row, chord = row[~follows], chord[~follows]
        own = self.contour[chord] == self.around[contour[row]]
        clear = np.full(len(contour), True)
        clear[row[~own]] = False
        own &= clear[row]
        row, near = row[own], self.chords.geometries[chord[own]]
        apart = shapely.linestrings(leads.points(NEAR_JOIN_MM))
        clear[row[shapely.distance(apart[row], near) < reach_mm]] = False
        if self.void is not None:
            clear &= self.void.clear_leads(shapely.linestrings(leads.points(half_kerf_mm)), contour)
        return clear

    def clear_pierces(self, points: Floats, clearance_mm: float, not_own: Ints | None = None) -> Bools:
        """Points of the sheet that keep clear of every contour and edge.

        With `not_own` (m,) or (m, k) each point may be near these contours.
        """
        at = shapely.points(points)
        clear = np.asarray(self.in_sheet(points) & ~shapely.dwithin(self.edges, at, clearance_mm - EXACT_MM))
        surely_mm = float(np.nextafter(clearance_mm - CHORD_MM, 0.0))
        if not_own is None and surely_mm > 0:  # then most is told without any distance
            clear[self.chords.query(at, predicate="dwithin", distance=surely_mm)[0]] = False
        rows = np.flatnonzero(clear)
        row, chord = self.chords.query(at[rows], predicate="dwithin", distance=clearance_mm + CHORD_MM)
        row = rows[row]
        if not_own is not None:
            own = not_own[:, None] if not_own.ndim == 1 else not_own
            others = (self.contour[chord][:, None] != own[row]).all(axis=1)
            row, chord = row[others], chord[others]
        near = shapely.distance(at[row], self.chords.geometries[chord]) < clearance_mm - CHORD_MM
        clear[row[near]] = False
        # What the chords leave in doubt is decided by the contours themselves.
        doubt = clear[row]
        for i, k in sorted(set(zip(row[doubt].tolist(), self.contour[chord[doubt]].tolist(), strict=True))):
            if clear[i] and self.contours[k].curve.project(points[i])[1] < clearance_mm - EXACT_MM:
                clear[i] = False
        return clear if self.void is None else clear & self.void.clear_pierces(points)

    def off_slits(self, points: Floats, distance_mm: float, not_own: Ints | None = None) -> Bools:
        """Points that are so far from every slit but their own: all of these are cut first, so that they are void."""
        clear = np.full(len(points), True)
        slits = np.flatnonzero(self.slit)
        if len(slits):
            row, k = nearer(shapely.STRtree(self.lines[slits]), shapely.points(points), distance_mm)
            clear[row if not_own is None else row[slits[k] != not_own[row]]] = False
        return clear

    def own_half(self, leads: Leads, contour: Ints, apart_mm: float) -> Bools:
        """Leads whose pierce is nearer to its own contour, by `apart_mm`, than to any of another part.

        Two such pierces of two contours are `apart_mm` apart at the least, wherever they are in the street.
        """
        pierces = shapely.points(leads.pierce)
        own_mm = np.asarray(shapely.distance(pierces, self.lines[self.around[contour]]))
        return ~self._near_others(pierces, contour, own_mm + apart_mm)

    def off_kerfs(self, leads: Leads, contour: Ints, kerf_mm: float, splash_mm: float) -> Bools:
        """Leads that would be lawful after the contours of all other parts: off their kerfs, which are then void."""
        near = self._near_others(shapely.points(leads.pierce), contour, 1.5 * kerf_mm + splash_mm)
        free = leads.length_mm > kerf_mm / 2 + EXACT_MM
        lines = shapely.linestrings(leads.take(free).points(kerf_mm / 2, most=1.0))
        near[free] |= self._near_others(lines, contour[free], kerf_mm)
        return ~near

    def _near_others(self, shapes: Lines, contour: Ints, distance_mm: Floats | float) -> Bools:
        """Which shapes come nearer than a distance to a contour of another part that is cut through."""
        row, chord = nearer(self.chords, shapes, distance_mm)
        met, own = self.contour[chord], contour[row]
        near = np.full(len(shapes), False)
        near[row[(self.part[met] != self.part[own]) & self.through[met]]] = True
        return near

    def in_sheet(self, points: Floats) -> Bools:
        """Points on the metal of the sheet."""
        return np.asarray(shapely.contains_xy(self.sheet, points[:, 0], points[:, 1]))

    def in_waste(self, points: Floats) -> Bools:
        """Points that lie on no part."""
        waste = np.full(len(points), True)
        row, part = self.metal.query(shapely.points(points))
        on_part = shapely.intersects_xy(self.metal.geometries[part], points[row, 0], points[row, 1])
        waste[row[on_part]] = False
        return waste

    def off_sheet(self, points: Floats, by_mm: float) -> Bools:
        """Points beyond the edge of the sheet, and `by_mm` or more from it."""
        return np.asarray(~self.in_sheet(points) & ~shapely.dwithin(self.edges, shapely.points(points), by_mm))

    def nearest_on_edge(self, points: Floats) -> Floats:
        """The points of the sheet's edges nearest to `points` (m, 2)."""
        return np.asarray(shapely.get_coordinates(shapely.shortest_line(shapely.points(points), self.edges))[1::2])

    def inside_edges(self, leads: Leads) -> Bools:
        """Leads that do not cross an edge of the sheet."""
        return np.asarray(~shapely.intersects(self.edges, shapely.linestrings(leads.points())))

    def gaps_mm(self, points: Floats) -> Floats:
        """Distance of points from the nearest chord or edge; 0 for those not in the waste of the sheet."""
        at = shapely.points(points)
        gap_mm = shapely.distance(at, self.chords.geometries[self.chords.nearest(at)])
        gap_mm = np.minimum(gap_mm, shapely.distance(self.edges, at))
        return np.where(self.in_sheet(points) & self.in_waste(points), gap_mm, 0.0)

    def nearest(self, point: Floats) -> tuple[float, str]:
        """How far a point is from what is nearest to it, and what that is."""
        at = shapely.Point(point)
        edge_mm = float(shapely.distance(self.edges, at))
        chord_mm = float(shapely.distance(at, self.chords.geometries[self.chords.nearest(at)]))
        close = self.contour[self.chords.query(at, predicate="dwithin", distance=chord_mm + 2 * CHORD_MM)]
        gaps = [(self.contours[k].curve.project(point)[1], self.contours[k].id) for k in np.unique(close).tolist()]
        return min([*gaps, (edge_mm, "the edge of the sheet")])


# Which lines of a tree shapes come too near to.

EXACT_MM = 1e-6
"""Distances that fall short by no more than this do not."""

Lines = NDArray[np.object_]


def nearer(lines: shapely.STRtree, shapes: Lines, distance_mm: Floats | float) -> tuple[Ints, Ints]:
    """Numbers of shapes and of lines, in pairs that are nearer to each other than a distance, one for all or for each.

    Examples
    --------
    >>> street = shapely.STRtree([shapely.LineString([(0, 0), (10, 0)])])
    >>> [rows.tolist() for rows in nearer(street, shapely.points([(5, 1.5), (5, 1.4)]), 1.5)]
    [[1], [0]]
    """
    within_mm = np.broadcast_to(np.maximum(distance_mm - EXACT_MM, 0.0), len(shapes))

    def of(some: slice) -> tuple[Ints, Ints]:
        row, line = lines.query(shapes[some], "dwithin", distance=within_mm[some])
        return row + some.start, line

    rows, met = zip(*split_in_halves(of, len(shapes)), strict=True)
    return np.concatenate(rows), np.concatenate(met)


# Metal that a stopped program has already burnt away: no pierce, and no lead, goes there.
#
# The kerf of every cut that is made, its leads included, is void: a strip of the kerf's width along the torch's path.

VOID_CHORD_MM = 0.01
NOBODY = -1


@dataclass(frozen=True, eq=False, slots=True)
class BurntArea:
    """The paths of a torch that have been burnt, `kerf_mm` wide; a pierce keeps half a kerf and `splash_mm` from that.

    `round_of` names the contour whose leads may join a path: the round of a cut that broke off, and is made again.
    """

    paths: shapely.STRtree
    round_of: Ints
    kerf_mm: float
    splash_mm: float = 0.0

    @staticmethod
    def of(nest: Nest, already: AlreadyCut, kerf_mm: float, splash_mm: float = 0.0) -> BurntArea | None:
        """The paths of all that is cut, and of what broke off; marks burn nothing away. None where nothing is burnt."""
        lines: list[shapely.LineString] = []
        round_of: list[int] = []
        burnt = already.cuts if already.broken_off is None else (*already.cuts, already.broken_off)
        for cut in burnt:
            if nest.contour(cut.contour).kind == "mark":
                continue
            own = nest.index[cut.contour] if cut is already.broken_off else NOBODY
            for path, joined in ((cut.lead_in, NOBODY), (_round(nest, cut, kerf_mm), own), (cut.lead_out, NOBODY)):
                if path is not None and path.segments:
                    lines.append(path.line(VOID_CHORD_MM))
                    round_of.append(joined)
        for _, cut in already.begun:
            for path in (cut.lead_in, *way_along(nest.contour(cut.contour), cut, kerf_mm)):
                if path is not None and path.segments:
                    lines.append(path.line(VOID_CHORD_MM))
                    round_of.append(NOBODY)
        return (
            BurntArea(shapely.STRtree(lines), np.array(round_of, dtype=np.int64), kerf_mm, splash_mm) if lines else None
        )

    def clear_pierces(self, points: Floats) -> Bools:
        """Points (m, 2) where a pierce, as wide as the kerf, has metal all around it, and so much to the next kerf.

        Examples
        --------
        >>> void = BurntArea(shapely.STRtree([shapely.LineString([(0, 0), (10, 0)])]), np.array([NOBODY]), 1.5)
        >>> void.clear_pierces(np.array([[5, 1.4], [5, 1.6]])).tolist()
        [False, True]
        """
        clear = np.full(len(points), True)
        clear[nearer(self.paths, shapely.points(points), self.kerf_mm + self.splash_mm)[0]] = False
        return clear

    def clear_leads(self, lines: Lines, contour: Ints) -> Bools:
        """Leads of contours, as lines without the last half kerf before they join, that stay on metal."""
        clear = np.full(len(lines), True)
        row, path = nearer(self.paths, lines, self.kerf_mm / 2)
        clear[row[self.round_of[path] != contour[row]]] = False
        return clear


def _round(nest: Nest, cut: Cut, kerf_mm: float) -> Curve:
    contour = nest.contour(cut.contour)
    try:
        return compensated(contour, kerf_mm)
    except InputError:  # cut with a narrower kerf than today's, which leaves nothing of it
        return contour.curve


# Paths round contours that the torch can follow on metal alone: all of them on the sheet, none along its edge.

_STEP_MM = 1.0


def paths_off_sheet(contours: Sequence[Contour], paths: Mapping[int, Curve], around: Surroundings) -> dict[int, str]:
    """Where the paths of contours leave the sheet or run along its edge, as sentences, by contour number.

    The torch is lit on metal alone, but for the run-up of an edge start. So a part keeps more than half a kerf from the
    edge.
    """
    numbers = list(paths)
    lines = lines_of([paths[k] for k in numbers], CHORD_MM)
    astray = ~shapely.covers(around.sheet, lines) | shapely.dwithin(around.edges, lines, CHORD_MM)
    return {numbers[i]: _sentence(contours[numbers[i]], lines[i], around) for i in np.flatnonzero(astray).tolist()}


def _sentence(contour: Contour, line: shapely.LineString, around: Surroundings) -> str:
    points = shapely.get_coordinates(shapely.segmentize(shapely.difference(line, around.sheet), _STEP_MM))
    off_mm = np.asarray(shapely.distance(shapely.points(points), around.edges)) if len(points) else np.zeros(1)
    if off_mm.max() > CHORD_MM:
        (x, y), runs = points[int(off_mm.argmax())].tolist(), f"{off_mm.max():.3f} mm off the sheet"
    else:
        x, y = shapely.get_coordinates(shapely.shortest_line(line, around.edges))[0].tolist()
        runs = "along the edge of the sheet"
    if contour.kind == "mark":
        return f"{contour.id} runs {runs} at ({x:.3f}, {y:.3f}): move the mark or give a larger sheet"
    return (
        f"{contour.id}: the torch's path runs {runs} at ({x:.3f}, {y:.3f}): move the part or give a larger sheet, "
        "more than half a kerf of which lies beside each part"
    )
