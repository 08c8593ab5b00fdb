"""What burns make of rings that no burn covers alone: stretches left open, burnt again, and tabs that are not there."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.encoder.cut import Tab
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour
from kerfwise.rules.rule import Violation

from .covering.chords import chords_of_lines
from .covering.covered import Covered, covered
from .covering.free import at_tabs, rounds
from .covering.intervals import both, total_mm, union
from .program_rules import tolerance_mm
from .resumed import BurntBefore
from .rings import torch_rings
from .torch_run import TorchRun

Tabs = Mapping[str, Sequence[Tab]]
_NAMED = 3


@dataclass(frozen=True, eq=False, slots=True)
class _Burnt:
    """One line that is burnt: by which run (None for what was cut before a stop), and whether of a whole round."""

    run: TorchRun | None
    line: shapely.LineString
    whole: bool


@dataclass(frozen=True, eq=False, slots=True)
class BurntRings:
    """Rings that several burns have to do with, what is burnt near them in order of time, and what that covers."""

    contours: tuple[Contour, ...]
    rings: tuple[shapely.LineString, ...]
    burnt: tuple[_Burnt, ...]
    coverage: tuple[Covered, ...]
    tabs: Tabs
    within_mm: float


def burnt_rings(
    contours: Iterable[Contour],
    runs: Sequence[TorchRun],
    before: BurntBefore,
    kerf_mm: float,
    tabs: Tabs | None,
) -> BurntRings:
    """The rings that runs share, of these contours, and those of parts that tabs hold since `before` a stop.

    None in an ordinary program.
    """
    within_mm, tabs = tolerance_mm(kerf_mm), tabs or {}
    named = [run for run in runs if run.contour is not None and not run.marks]
    shared = [run for run in named if run.linked or run.partial or run.name in tabs]
    held = before.out & tabs.keys()
    if not shared and not held:
        return BurntRings((), (), (), (), tabs, within_mm)
    closed = [c for c in contours if c.encloses]
    paired = [(c, r) for c, r in zip(closed, torch_rings(closed, kerf_mm), strict=True) if r is not None]
    tree = shapely.STRtree([r for _, r in paired])
    lines = np.array([line for run in shared for line in (run.loop, *run.leads)], dtype=object)
    of_held = [k for k, (contour, _) in enumerate(paired) if contour.id in held]
    near = np.union1d(tree.query(lines, "dwithin", distance=within_mm)[1], of_held).astype(np.int64).tolist()
    rings = tuple(paired[k][1] for k in near)
    burnt = list(_burnt(runs, before))
    by = np.unique(shapely.STRtree([b.line for b in burnt]).query(rings, "dwithin", distance=within_mm)[1]).tolist()
    burnt = [burnt[k] for k in by]
    free = [
        union(np.concatenate([rounds(ring, c), at_tabs(ring, tabs.get(c.id, ()), within_mm)]))
        for c, ring in (paired[k] for k in near)
    ]
    coverage = covered(rings, free, chords_of_lines([b.line for b in burnt]), within_mm)
    return BurntRings(tuple(paired[k][0] for k in near), rings, tuple(burnt), tuple(coverage), tabs, within_mm)


def _burnt(runs: Sequence[TorchRun], before: BurntBefore) -> Iterator[_Burnt]:
    yield from (_Burnt(None, line, True) for line in before.rounds)
    yield from (_Burnt(None, line, False) for line in before.others)
    for run in runs:
        if not run.marks:
            all_round = run.between_tabs or not run.partial
            for line, whole in ((run.lead_in, False), (run.loop, all_round), (run.lead_out, False)):
                if line is not None and line.length > 0:
                    yield _Burnt(run, line, whole and run.contour is not None)


def left_open(found: BurntRings, positions: Mapping[str, int]) -> Iterator[Violation]:
    """Contours of which burns cut something, but not all; `positions` are those of cuts."""
    for contour, ring, done in zip(found.contours, found.rings, found.coverage, strict=True):
        own = [b.run for b in found.burnt if b.run is not None and b.run.contour is contour]
        if done.out is not None or not own or contour.id not in positions:
            continue
        low, high = max(done.open, key=lambda stretch: stretch[1] - stretch[0])
        x, y = _at(ring, (low + high) / 2)
        by = list(dict.fromkeys(run.where for run in own))
        told = " and ".join(by[:_NAMED]) + (" and others" if len(by) > _NAMED else "")
        yield Violation(
            "every-contour-once",
            (contour.id,),
            f"{contour.id} is not cut all along: {done.open_mm:.1f} mm are left, at ({x:z.1f}, {y:z.1f}); "
            f"{told} cut it",
            (positions[contour.id],),
        )


def burnt_twice(found: BurntRings, allowed_mm: float) -> Iterator[Violation]:
    """Stretches of rings that are burnt again for more than overcuts and leads are long.

    Two contours that stand a kerf apart may each be cut all round.
    """
    worst: dict[int, tuple[float, str, Point]] = {}
    for contour, ring, done in zip(found.contours, found.rings, found.coverage, strict=True):
        for k, again in done.again.items():
            mine = found.burnt[k]
            if mine.run is None:
                continue
            if mine.whole:
                before = [
                    rows for j, rows in done.new.items() if j < k and not _round_another(found.burnt[j], mine.run)
                ]
                again = both(again, union(np.concatenate([np.empty((0, 2)), *before])))
            longest_mm = total_mm(again)
            if longest_mm > allowed_mm and longest_mm > worst.get(k, (0.0,))[0] + 1e-6:
                low, high = max(again.tolist(), key=lambda stretch: stretch[1] - stretch[0])
                worst[k] = longest_mm, contour.id, _at(ring, (low + high) / 2)
    for k, (again_mm, name, (x, y)) in sorted(worst.items()):
        run = found.burnt[k].run
        assert run is not None
        text = f"{run.where}: {again_mm:.1f} mm of {name} are burnt again, at ({x:z.1f}, {y:z.1f})"
        yield Violation("burnt-twice", (name,), text, (run.position,) if run.position else ())


def _round_another(burnt: _Burnt, run: TorchRun) -> bool:
    """Whether a line goes all round another contour than a run does."""
    return burnt.whole and (burnt.run is None or burnt.run.contour is not run.contour)


def cut_tabs(found: BurntRings) -> Iterator[Violation]:
    """Tabs that are burnt, in part at least."""
    for contour, ring, done in zip(found.contours, found.rings, found.coverage, strict=True):
        burnt = union(np.concatenate([np.empty((0, 2)), *done.new.values()]))
        for tab in found.tabs.get(contour.id, ()):
            place = at_tabs(ring, [tab], 0.0)
            lost_mm = total_mm(both(place, burnt))
            if lost_mm > 2 * found.within_mm:
                x, y = tab.at
                text = (
                    f"{lost_mm:.2f} of {tab.width_mm:g} mm of the tab of {contour.id} at ({x:z.1f}, {y:z.1f}) are cut"
                )
                yield Violation("tabs", (contour.id,), text)


def _at(ring: shapely.LineString, at_mm: float) -> Point:
    point = shapely.line_interpolate_point(ring, at_mm % ring.length)
    return point.x, point.y
