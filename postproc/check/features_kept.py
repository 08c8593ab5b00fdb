"""Features that a program would lose: stretches of a contour that no burn of its cut reaches.

A round kerf leaves something of every inner corner. What is left of a contour is measured from the contour to the edge
of what is burnt: as much as of a right angle may be left anywhere, of a sharper corner as much as is left by nature,
unless the profile allows less, and 0.05 mm more. A slot, notch or neck narrower than the kerf may be left where the
profile has it cut across, and nowhere more than a torch on the ring's side of its mouth could have burnt. A pass along
a slot reaches for the contour that the slot is of.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.cut import Tab
from kerfwise.encoder.geometry.curve import lines_of
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour
from kerfwise.rules.judging.violation import Violation
from kerfwise.rules.profile.values import ProfileValues

from .contour_following import surely_beside
from .small_features import burns_by_contour
from .torch_run import TorchRun, tolerance_mm

SLACK_MM = 0.01
"""What the chords of paths and contours may make of a distance."""
_CHORD_MM = 0.002
_UNCUT_STEP_MM = 0.05
_AT_ONCE = 256
"""Paths whose kerfs are made together; of all at once they would take more memory than all else."""
NEARLY_MM = 0.01
"""Less than this the buffers of lines and of their pieces lie apart."""
_FEW = 6
"""Chords of a quarter of a round end where few will do: they lie inside the round."""
_SLOT_RAD, _CRACK_RAD = math.radians(15), math.radians(1)
"""Walls that open by less are those of a slot, or, of a single corner, of a crack."""
_RELIEF_KERFS = 2.0
"""Up to so many kerfs deep a notch is a bend relief, which is left where nobody says otherwise."""
_REACHED_MM = 0.03
"""No more than half a kerf and so much from where the torch can be, metal on a contour was missed."""
_BESIDE_KERFS = 2.0
"""What is left so near to a pass along a slot was to be opened by it."""
_MOST_PLACES = 12


@dataclass(frozen=True, slots=True)
class Allowed:
    """What may be left of contours, mm: `corner_mm` of a corner, None for any; a slot, notch or neck `deep_mm` deep."""

    corner_mm: float | None = None
    deep_mm: float = 0.0

    @staticmethod
    def by(profile: ProfileValues) -> Allowed:
        """As the profile has it: features are left to any depth, to that of a bend relief, or not at all."""
        kerf_mm, narrow = profile.material.kerf_mm, profile.cuts.narrow
        deep_mm = {"leave": math.inf, "refuse": 0.0}.get(narrow, _RELIEF_KERFS * kerf_mm)
        return Allowed(profile.corners.leave_mm, deep_mm)


@dataclass(frozen=True, slots=True)
class Left:
    """What a program leaves of a contour as it may: where, mm, of a corner or of a slot, notch or neck.

    `left_mm` is how far beside the kerf the corner lies, or how deep the slot is.
    """

    contour: str
    at: Point
    left_mm: float
    corner: bool


@dataclass(frozen=True, slots=True)
class Uncut:
    """What is left of contours: what may not be, and what may."""

    lost: list[Violation]
    left: list[Left]

    def told(self) -> list[str]:
        """What is left as it may be, a sentence for all corners and one for all slots, notches and necks.

        Examples
        --------
        >>> Uncut([], [Left("P.hole1", (60.0, 150.0), 1.214, True), Left("P.hole1", (150.0, 60.0), 1.2, True)]).told()
        ['2 corners keep up to 1.21 mm that a round kerf does not reach: P.hole1 at (60.0, 150.0), (150.0, 60.0)']
        """
        corners = sorted((one for one in self.left if one.corner), key=lambda one: -one.left_mm)
        others = sorted((one for one in self.left if not one.corner), key=lambda one: -one.left_mm)
        lines = []
        if corners:
            what = "a corner keeps" if len(corners) == 1 else f"{len(corners)} corners keep"
            most = f"{'' if len(corners) == 1 else 'up to '}{corners[0].left_mm:.2f} mm"
            lines.append(f"{what} {most} that a round kerf does not reach: {_places(corners)}")
        if others:
            deep = f"{others[0].left_mm:.1f} mm deep"
            if len(others) == 1:
                what = f"a slot, notch or neck narrower than the kerf is cut straight across, {deep}"
            else:
                what = f"{len(others)} slots, notches or necks narrower than the kerf are cut straight across, "
                what += f"up to {deep}"
            lines.append(f"{what}: {_places(others)}")
        return lines


def _places(left: Sequence[Left]) -> str:
    """Where things are left, by contour, the first few."""
    by_contour: dict[str, list[str]] = {}
    for one in left[:_MOST_PLACES]:
        by_contour.setdefault(one.contour, []).append(f"({one.at[0]:z.1f}, {one.at[1]:z.1f})")
    more = f" and {len(left) - _MOST_PLACES} more" if len(left) > _MOST_PLACES else ""
    return "; ".join(f"{name} at {', '.join(at)}" for name, at in by_contour.items()) + more


def features_lost(
    runs: Sequence[TorchRun],
    kerf_mm: float,
    skipped: frozenset[int] = frozenset(),
    opened: Sequence[Contour] = (),
    tabs: Mapping[str, Sequence[Tab]] | None = None,
    before: Sequence[shapely.LineString] = (),
    allowed: Allowed = Allowed(),
) -> Uncut:
    """Where contours are left uncut, those of runs at the positions `skipped` aside: their paths are wrong anyway.

    `opened` are slits that were cut before the runs, `tabs` stretches of contours that are to stay uncut.
    What was burnt `before` a stop cuts contours that are cut along a stretch.
    """
    round_contours = [run for run in runs if run.contour is not None and run.contour.encloses and not run.marks]
    last = {run.name: run for run in round_contours}
    cut = [run for run in round_contours if run.position not in skipped and (not run.partial or last[run.name] is run)]
    if not cut:
        return Uncut([], [])
    within_mm = kerf_mm / 2 + tolerance_mm(kerf_mm) + SLACK_MM
    cut = _doubtful(cut, kerf_mm, allowed)
    if not cut:
        return Uncut([], [])
    contours = np.array([run.contour.curve.line(_CHORD_MM) for run in cut if run.contour is not None], dtype=object)
    helped = _helped(cut, runs, before, within_mm)
    along = burns_by_contour(runs, opened)
    burns = [[run.loop, *run.leads, *along.get(run.name, ()), *helped.get(run.name, ())] for run in cut]
    paths = [shapely.multilinestrings(lines) for lines in burns]
    some = [slice(k, k + _AT_ONCE) for k in range(0, len(paths), _AT_ONCE)]
    left = np.concatenate([_left(contours[s], paths[s], within_mm) for s in some])
    found = Uncut([], [])
    for k in np.flatnonzero(~shapely.is_empty(left)).tolist():
        path, spared = shapely.union_all(burns[k]), _spared(tabs, cut[k], within_mm)
        slit = shapely.union_all(along.get(cut[k].name, ()))
        if any(_of_run(cut[k], shapely.difference(left[k], spared), path, kerf_mm, allowed, slit, NEARLY_MM)):
            # the buffer of lines taken apart where they meet is rounder, and made in ten times the time
            exactly = _left(contours[k : k + 1], [path], within_mm)[0]
            for one in _of_run(cut[k], shapely.difference(exactly, spared), path, kerf_mm, allowed, slit):
                if isinstance(one, Violation):
                    found.lost.append(one)
                else:
                    found.left.append(one)
    return found


def _doubtful(cut: Sequence[TorchRun], kerf_mm: float, allowed: Allowed) -> list[TorchRun]:
    """The runs beside which more than of a right angle may be left; coarse chords clear most, finer ones right angles.

    Chords are followed along first, and areas made of what is left then. What the chords of a contour, those of its
    round and those of the round ends may be off is taken from the distance.
    """
    half_mm, more_mm = kerf_mm / 2, tolerance_mm(kerf_mm)
    most_mm = math.sqrt(2) * half_mm + more_mm
    if allowed.corner_mm is not None:
        most_mm = min(most_mm, half_mm + allowed.corner_mm + more_mm)
    left = list(cut)
    for by_areas, chord_mm in product((False, True), ((most_mm - half_mm) / 8, more_mm / 8)):
        contours = lines_of([run.contour.curve for run in left if run.contour is not None], chord_mm)
        rounds = np.array([run.loop for run in left], dtype=object)
        if by_areas:
            rounds = shapely.simplify(rounds, chord_mm)
            near = shapely.covers(shapely.buffer(rounds, most_mm - 2 * chord_mm, quad_segs=_FEW), contours)
        else:
            near = surely_beside(contours, rounds, half_mm, most_mm - chord_mm)
        left = [run for run, cleared in zip(left, near.tolist(), strict=True) if not cleared]
    return left


def _left(contours: Any, paths: Sequence[shapely.Geometry], within_mm: float) -> Any:
    """What of each contour is farther from its path."""
    return shapely.difference(contours, shapely.buffer(np.array(paths, dtype=object), within_mm, quad_segs=24))


def _spared(tabs: Mapping[str, Sequence[Tab]] | None, run: TorchRun, within_mm: float) -> shapely.Geometry:
    """Where a contour is to stay uncut."""
    own = (tabs or {}).get(run.name, ())
    return shapely.union_all([shapely.buffer(shapely.Point(tab.at), tab.width_mm / 2 + within_mm) for tab in own])


def _helped(
    cut: Sequence[TorchRun], runs: Sequence[TorchRun], before: Sequence[shapely.LineString], within_mm: float
) -> dict[str, list[shapely.LineString]]:
    """What else is burnt beside contours that no run goes all round, by contour id."""
    partial = [run.contour for run in cut if run.partial and run.contour is not None]
    if not partial:
        return {}
    lines = [*before, *(line for run in runs if not run.marks for line in (run.loop, *run.leads))]
    tree = shapely.STRtree(lines)
    return {c.id: [lines[k] for k in tree.query(c.line, "dwithin", distance=within_mm).tolist()] for c in partial}


def _of_run(
    run: TorchRun,
    left: shapely.Geometry,
    path: shapely.Geometry,
    kerf_mm: float,
    allowed: Allowed,
    slit: shapely.Geometry,
    nearly_mm: float = 0.0,
) -> Iterator[Violation | Left]:
    """What is left along a run beyond what any round kerf leaves of a right angle; `nearly_mm` takes so much less."""
    if left.is_empty or run.contour is None:
        return
    half_mm, more_mm = kerf_mm / 2, tolerance_mm(kerf_mm) + SLACK_MM
    right_angle_mm, reach = half_mm * (math.sqrt(2) - 1), None
    if allowed.corner_mm is not None:
        right_angle_mm = min(right_angle_mm, allowed.corner_mm)
    shapely.prepare(path)
    for stretch in shapely.get_parts(shapely.line_merge(left) if left.geom_type == "MultiLineString" else left):
        places = shapely.points(shapely.get_coordinates(shapely.segmentize(stretch, _UNCUT_STEP_MM)))
        beyond_mm = shapely.distance(path, places) - half_mm
        worst = int(np.argmax(beyond_mm))
        worst_mm = float(beyond_mm[worst])
        if worst_mm <= right_angle_mm + more_mm - nearly_mm:
            continue
        at, name = places[worst], run.name
        corner = worst_mm <= _corner_remainder_mm(stretch, half_mm) + more_mm - nearly_mm
        if reach is None:
            reach = _reach(run.contour, path, half_mm)
        far = places[beyond_mm > right_angle_mm + more_mm]
        missed = bool(shapely.dwithin(reach, far, half_mm + _REACHED_MM).any())
        opened = bool(shapely.dwithin(slit, stretch, _BESIDE_KERFS * kerf_mm))
        most_mm = math.inf if corner and allowed.corner_mm is None else (allowed.corner_mm or 0.0)
        if not corner:
            most_mm = 0.0 if opened else allowed.deep_mm
        if not corner:
            worst_mm = _deep_mm(shapely.get_coordinates(stretch))
        if not missed and worst_mm <= most_mm + more_mm:
            yield Left(name, (at.x, at.y), worst_mm, corner)
            continue
        if missed:
            why = "the torch could reach there"
        elif corner:
            why = f"the profile allows {most_mm:g} mm of a corner (corners.leave)"
        else:
            why = "a slot, notch or neck that is too narrow for it"
        text = (
            f"{stretch.length:.1f} mm of {name} are left uncut, at ({at.x:z.1f}, {at.y:z.1f}) up to "
            f"{beyond_mm[worst]:.2f} mm beside the kerf: {why}"
        )
        yield run.wrong("features-kept", text, name)


def _reach(contour: Contour, path: shapely.Geometry, half_mm: float) -> shapely.Geometry:
    """Where the torch's centre could be on its way round: the waste less half the kerf, on the path's side of necks."""
    metal = shapely.make_valid(contour.curve.polygon(_CHORD_MM))
    around = shapely.box(*shapely.bounds(shapely.union_all([metal, path]))).buffer(4 * half_mm + 1.0)
    waste = around - metal if contour.kind == "outer" else metal
    free = shapely.buffer(waste, -half_mm, quad_segs=24)
    pieces = shapely.get_parts(free)
    return max(pieces, key=lambda piece: piece.buffer(2 * _REACHED_MM).intersection(path).length, default=free)


def _corner_remainder_mm(stretch: shapely.LineString, half_mm: float) -> float:
    """How much a round kerf leaves of the corner that a stretch goes round, at least that of a right angle."""
    steps = np.diff(shapely.get_coordinates(stretch), axis=0)
    steps = steps[np.hypot(*steps.T) > 1e-9]
    angles = [a for one, other in pairwise(steps) if (a := _between(-one, other)) > _CRACK_RAD]
    if len(steps) > 1 and (opening := _between(-steps[0], steps[-1])) > _SLOT_RAD:
        angles.append(opening)
    natural = [half_mm / math.sin(a / 2) - half_mm for a in angles]
    return max([half_mm * math.sqrt(2) - half_mm, *natural])


def _deep_mm(stretch: Floats) -> float:
    """How far a stretch reaches behind the line through its two ends, the mouth of a slot."""
    mouth, inwards = stretch[-1] - stretch[0], stretch - stretch[0]
    wide_mm = float(np.hypot(*mouth))
    if wide_mm < 1e-9:
        return float(np.hypot(*inwards.T).max())
    return float(np.abs(mouth[0] * inwards[:, 1] - mouth[1] * inwards[:, 0]).max()) / wide_mm


def _between(one: Floats, other: Floats) -> float:
    """The angle between two directions, rad."""
    return abs(math.atan2(one[0] * other[1] - one[1] * other[0], float(one @ other)))
