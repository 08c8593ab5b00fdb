"""Features that a program would lose: stretches of a contour that no burn of its cut reaches.

A round kerf leaves something of every inner corner. What is left of a contour is measured from the contour to the edge
of what is burnt: as much as of a right angle may be left anywhere, of a sharper corner as much as is left by nature but
no more than half the kerf, and 0.05 mm more. A pass along a slot reaches for the contour that the slot is of.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise, product
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.cut import Tab
from kerfwise.encoder.geometry.curve import lines_of
from kerfwise.encoder.nest import Contour
from kerfwise.rules.rule import Violation

from .followed_contours import surely_beside
from .program_rules import tolerance_mm
from .slits import burns_by_contour
from .torch_run import TorchRun

SLACK_MM = 0.01
"""What the chords of paths and contours may make of a distance."""
_CHORD_MM = 0.002
_STEP_MM = 0.05
_AT_ONCE = 256
"""Paths whose kerfs are made together; of all at once they would take more memory than all else."""
NEARLY_MM = 0.01
"""Less than this the buffers of lines and of their pieces lie apart."""
_FEW = 6
"""Chords of a quarter of a round end where few will do: they lie inside the round."""
_SLOT_RAD = math.radians(15)


def features_lost(
    runs: Sequence[TorchRun],
    kerf_mm: float,
    skipped: frozenset[int] = frozenset(),
    opened: Sequence[Contour] = (),
    tabs: Mapping[str, Sequence[Tab]] | None = None,
    before: Sequence[shapely.LineString] = (),
) -> list[Violation]:
    """Where contours are left uncut, those of runs at the positions `skipped` aside: their paths are wrong anyway.

    `opened` are slits that were cut before the runs, `tabs` stretches of contours that are to stay uncut.
    What was burnt `before` a stop cuts contours that are cut along a stretch.
    """
    round_contours = [run for run in runs if run.contour is not None and run.contour.encloses and not run.marks]
    last = {run.name: run for run in round_contours}
    cut = [run for run in round_contours if run.position not in skipped and (not run.partial or last[run.name] is run)]
    if not cut:
        return []
    within_mm = kerf_mm / 2 + tolerance_mm(kerf_mm) + SLACK_MM
    cut = _doubtful(cut, kerf_mm)
    if not cut:
        return []
    contours = np.array([run.contour.curve.line(_CHORD_MM) for run in cut if run.contour is not None], dtype=object)
    helped = _helped(cut, runs, before, within_mm)
    along = burns_by_contour(runs, opened)
    burns = [[run.loop, *run.leads, *along.get(run.name, ()), *helped.get(run.name, ())] for run in cut]
    paths = [shapely.multilinestrings(lines) for lines in burns]
    some = [slice(k, k + _AT_ONCE) for k in range(0, len(paths), _AT_ONCE)]
    left = np.concatenate([_left(contours[s], paths[s], within_mm) for s in some])
    found: list[Violation] = []
    for k in np.flatnonzero(~shapely.is_empty(left)).tolist():
        path, spared = shapely.union_all(burns[k]), _spared(tabs, cut[k], within_mm)
        if any(_of_run(cut[k], shapely.difference(left[k], spared), path, kerf_mm, NEARLY_MM)):
            # the buffer of lines taken apart where they meet is rounder, and made in ten times the time
            exactly = _left(contours[k : k + 1], [path], within_mm)[0]
            found += _of_run(cut[k], shapely.difference(exactly, spared), path, kerf_mm)
    return found


def _doubtful(cut: Sequence[TorchRun], kerf_mm: float) -> list[TorchRun]:
    """The runs beside which more than of a right angle may be left; coarse chords clear most, finer ones right angles.

    Chords are followed along first, and areas made of what is left then. What the chords of a contour, those of its
    round and those of the round ends may be off is taken from the distance.
    """
    half_mm, more_mm = kerf_mm / 2, tolerance_mm(kerf_mm)
    most_mm = math.sqrt(2) * half_mm + more_mm
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
    run: TorchRun, left: shapely.Geometry, path: shapely.Geometry, kerf_mm: float, nearly_mm: float = 0.0
) -> Iterator[Violation]:
    """What is wrong with what is left along a run; with `nearly_mm` also what is as much less than wrong."""
    if left.is_empty:
        return
    half_mm, more_mm = kerf_mm / 2, tolerance_mm(kerf_mm) + SLACK_MM
    shapely.prepare(path)
    for stretch in shapely.get_parts(shapely.line_merge(left) if left.geom_type == "MultiLineString" else left):
        places = shapely.points(shapely.get_coordinates(shapely.segmentize(stretch, _STEP_MM)))
        beyond_mm = shapely.distance(path, places) - half_mm
        worst = int(np.argmax(beyond_mm))
        if beyond_mm[worst] <= min(_by_nature_mm(stretch, half_mm), half_mm) + more_mm - nearly_mm:
            continue
        at, name = places[worst], run.name
        text = (
            f"{run.where}: {stretch.length:.1f} mm of {name} are left uncut, at ({at.x:z.1f}, {at.y:z.1f}) up to "
            f"{beyond_mm[worst]:.2f} mm beside the kerf: a slot, notch, neck or corner that is too narrow for it"
        )
        yield Violation("features-kept", (name,), text, (run.position,) if run.position else ())


def _by_nature_mm(stretch: shapely.LineString, half_mm: float) -> float:
    """How much a round kerf leaves of the corner that a stretch goes round, at least that of a right angle."""
    steps = np.diff(shapely.get_coordinates(stretch), axis=0)
    steps = steps[np.hypot(*steps.T) > 1e-9]
    angles = [_between(-one, other) for one, other in pairwise(steps)]
    if len(steps) > 1:
        angles.append(_between(-steps[0], steps[-1]))
    natural = [half_mm / math.sin(a / 2) - half_mm for a in angles if a > _SLOT_RAD]
    return max([half_mm * math.sqrt(2) - half_mm, *natural])


def _between(one: Floats, other: Floats) -> float:
    """The angle between two directions, rad."""
    return abs(math.atan2(one[0] * other[1] - one[1] * other[0], float(one @ other)))
