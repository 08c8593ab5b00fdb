"""Points that the machine cannot go to: of every path with the torch on, of every rapid, and of the way home."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

import shapely

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.geometry.segment import Box, Point
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.check.reader.program import NcProgram
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.rule import Violation

from .program_rules import tolerance_mm
from .torch_run import TorchRun

_RULE = "within-travel"


def beyond_travel(nest: Nest, cuts: CutSequence, runs: Sequence[TorchRun], profile: Profile) -> Iterator[Violation]:
    """Torch paths, pierces and ends of the cuts, and the home, that lie beyond what the machine reaches."""
    reach = profile.reach_on(nest)
    if reach is None:
        return
    corner = profile.frame_on(nest).corner
    if (text := _beyond([cuts.home], reach, corner)) is not None:
        yield Violation(_RULE, (), f"the machine's home is {text}")
    by_position: dict[int, list[Point]] = {k: [cut.pierce, cut.end] for k, cut in enumerate(cuts, 1)}
    for run in runs:
        points = by_position.setdefault(run.position, [])
        points += [(x, y) for line in (run.loop, *run.leads) for x, y in shapely.get_coordinates(line).tolist()]
        if (text := _beyond(points, reach, corner)) is not None:
            contours = () if run.contour is None else (run.contour.id,)
            yield Violation(_RULE, contours, f"{run.where}: the path of {run.name} is {text}", (run.position,))


def rapids_beyond_travel(nest: Nest, program: NcProgram, profile: Profile) -> Iterator[Violation]:
    """Rapids of a program that lead beyond what the machine reaches."""
    reach = profile.reach_on(nest)
    if reach is None:
        return
    corner = profile.frame_on(nest).corner
    for line, at in program.rapids:
        if (text := _beyond([at], reach, corner)) is not None:
            yield Violation(_RULE, (), f"line {line}: the way without torch leads {text}")


def _beyond(points: Iterable[Point], reach: Box, corner: Point) -> str | None:
    """How far, and where, the worst of the points is beyond the reach; None if none is."""
    x0, y0, x1, y1 = reach
    off = [(max(x0 - x, x - x1, y0 - y, y - y1), x, y) for x, y in points]
    off_mm, x, y = max(off, default=(-math.inf, 0.0, 0.0))
    if off_mm <= tolerance_mm():
        return None
    return f"{off_mm:.1f} mm out of the machine's travel, at ({x - corner[0]:.1f}, {y - corner[1]:.1f}) of the machine"
