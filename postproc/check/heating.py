"""What the torch does to the sheet, as the check has read it: for whoever simulates temperatures.

The check judges t-max without a line of the models: it hands its own reading of the plan or program to a thermometer
and takes back temperatures, as a shop measures a sheet that it did not plan. The physics behind the thermometer is that
of `kerfwise heat`. A second heat equation would prove nothing: the limit is meant for the figures of this one, which
has tests of its own against solutions in closed form and against its energies.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import ops

from kerfwise.encoder.corner_feed import chords
from kerfwise.encoder.cut import Cut, CutSequence, HotSpot
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.check.reader.program import NcProgram
from kerfwise.rules.profile.profile import Profile

from .corners import slowness_of
from .torch_run import TorchRun

_CHORD_MM = 0.05


@dataclass(frozen=True, eq=False, slots=True)
class Heating:
    """One stretch with the torch on: it stands at the first of `points` (k, 2), mm, for `pierce_s`, then moves evenly.

    Where `slowness` (k - 1,) is given, each step takes so many times longer. `cut_s` is when the cut that it belongs to
    begins by the plan's, or the program's, own clock.
    """

    name: str
    points: NDArray[np.float64]
    begin_s: float
    end_s: float
    pierce_s: float
    cut_s: float
    slowness: NDArray[np.float64] | None = None


Thermometer = Callable[[Sequence[Heating]], tuple[HotSpot, ...] | None]
"""Simulates the sheet: the hottest place of each stretch, None where times contradict each other."""


def measured(cuts: CutSequence, heatings: Iterator[Heating], thermometer: Thermometer | None) -> CutSequence:
    """The cuts with the temperatures that they lead to, where there is a thermometer."""
    if thermometer is None:
        return cuts
    stretches = list(heatings)
    spots = thermometer(stretches)
    if spots is None:
        return cuts
    timed = (replace(spot, at_s=stretch.cut_s) for spot, stretch in zip(spots, stretches, strict=True))
    return replace(cuts, hot_spots=tuple(timed))


def heatings_of_cuts(
    nest: Nest, cuts: CutSequence, runs: Sequence[TorchRun], profile: Profile, unpierced: Collection[int] = ()
) -> Iterator[Heating]:
    """The stretches of a plan, at the times that it states; marks heat nothing worth speaking of.

    The cuts at the positions `unpierced` begin in an old kerf, where the torch does not stand for a pierce.
    """
    machine, pierced = profile.machine, cuts.pierced
    holes = {hole.contour for hole in cuts.pierces}
    for run in runs:
        for hole in pierced.get(run.position, ()):
            yield Heating(hole.contour, np.array([hole.at]), hole.start_s, hole.end_s, 0.0, hole.start_s)
        if run.marks or run.contour is None:
            continue
        cut = cuts[run.position - 1]
        points = np.concatenate([shapely.get_coordinates(line) for line in _in_order(run, cut)])
        pierced_here = run.position not in unpierced and _pierced(nest, cut.pierce)
        pierce_s = machine.pierce_time_s if pierced_here else _preheat_s(profile)
        cold = profile.machine.process == "oxyfuel"
        pierce_s = _preheat_s(profile) * cold if cut.contour in holes else pierce_s
        pierce_s = 0.0 if cut.linked else pierce_s
        end_s = max(cut.start_s, cut.end_s)
        yield Heating(run.name, points, cut.start_s, end_s, pierce_s, cut.start_s, slowness_of(points, profile))


def heatings_of_program(program: NcProgram) -> Iterator[Heating]:
    """The stretches of a program at its own feeds, with the waits that it makes or leaves to the machine."""
    for burn in program.burns:
        if burn.tool == 0:
            points, slowness = chords(burn.path, burn.paced, _CHORD_MM)
            stood_s = burn.held_s + burn.pierce_s
            yield Heating(f"line {burn.line}", points, burn.start_s, burn.end_s, stood_s, burn.start_s, slowness)


def _preheat_s(profile: Profile) -> float:
    """How long the torch stands where it pierces nothing: a flame heats the edge at least as long as for a pierce."""
    machine = profile.machine
    return machine.edge_preheat_s or (machine.pierce_time_s if machine.process == "oxyfuel" else 0.0)


def _pierced(nest: Nest, point: tuple[float, float]) -> bool:
    return bool(shapely.contains_xy(nest.sheet.polygon, *point))


def _in_order(run: TorchRun, cut: Cut) -> Iterator[shapely.LineString]:
    """Lead-in, the ring once round from where the torch joins it, the way the cut goes, lead-out."""
    if run.lead_in is not None:
        yield run.lead_in
    ring = run.loop
    if run.partial or (run.contour is not None and not run.contour.curve.closed):
        yield ring
        yield from () if run.lead_out is None or not run.partial else (run.lead_out,)
        return
    if shapely.is_ccw(shapely.LinearRing(ring)) != (cut.direction == "ccw"):
        ring = ring.reverse()
    first = shapely.get_point(run.lead_in, -1) if run.lead_in is not None else shapely.Point(cut.pierce)
    along_mm = ring.project(first)
    yield from (ops.substring(ring, a, b) for a, b in ((along_mm, ring.length), (0.0, along_mm)) if b > a)
    if run.lead_out is not None:
        yield run.lead_out
