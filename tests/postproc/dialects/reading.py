"""How far what a reader makes of a program is from what its plan says."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise import Nest, Plan, Profile
from kerfwise.postproc.clock import read_program
from kerfwise.postproc.dialects import Dialect, load_dialect
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.nc.toolpaths import toolpaths
from kerfwise.rule_kit import Curve
from kerfwise.tests.tools import canon
from kerfwise.tests.tools.outside import gcode_toolpath, meerk40t
from kerfwise.tests.tools.outside.heard import Heard
from kerfwise.tests.tools.outside.mapped import in_linuxcnc


@dataclass(frozen=True, slots=True)
class Differences:
    """Of a reader's burns and a plan's paths, mm: the farthest that one is from the other, and of their lengths."""

    burns: int
    paths: int
    apart_mm: float
    cut_mm: float
    idle_mm: float

    def within(self, apart_mm: float = 0.01, length_mm: float = 0.1) -> bool:
        """Whether they are as many, as near, and as long."""
        same = self.burns == self.paths and self.apart_mm <= apart_mm
        return same and abs(self.cut_mm) <= length_mm and abs(self.idle_mm) <= length_mm


def agree(found: Differences, dialect: Dialect, cut_mm: float) -> bool:
    """Whether they are as near as the dialect's digits let them be; `cut_mm` is the length of the plan's paths.

    Where it counts in whole tenths, chords zigzag by as much, and add a thousandth to lengths.
    """
    if dialect.step_mm < 0.01:
        return found.within()
    chord_mm = dialect.chord_mm if dialect.arc_centre == "none" else 0.0
    return found.within(max(dialect.step_mm, dialect.step_mm / math.sqrt(2) + chord_mm), 0.1 + cut_mm / 1000)


def with_dialect(profile: Profile, name: str) -> Profile:
    """The profile with a machine of a dialect, whatever process that is for."""
    machine = dataclasses.replace(profile.machine, dialect=name, accept_dialect=True, pierce_dwell=None)
    return dataclasses.replace(profile, machine=machine)


def burnt_paths(plan: Plan, nest: Nest, profile: Profile, over_tabs: bool = False) -> list[Curve]:
    """What a plan burns without a break: cuts that are linked in one path, those with tabs in several.

    `over_tabs` is for readers that take the torch's way over a tab for a part of the burn.
    """
    paths: list[Curve] = []
    for made in toolpaths(plan, nest, profile):
        pieces = [made.path] if over_tabs else list(made.pieces[::2])
        if made.linked:
            before = paths.pop()
            pieces[0] = Curve(np.vstack([before.vertices[:-1], pieces[0].vertices]), closed=False)
        paths += pieces
    return paths


def differences(plan: Plan, nest: Nest, profile: Profile, heard: Heard) -> Differences:
    """A reader's burns against the plan's paths, in order."""
    paths = burnt_paths(plan, nest, profile, heard.over_tabs)
    apart = [apart_mm(path, points) for path, points in zip(paths, heard.burns, strict=False)]
    cut_mm = sum(heard.lengths_mm) - sum(path.length_mm for path in paths)
    idle_mm = heard.idle_mm - plan.totals.idle_mm
    return Differences(len(heard.burns), len(paths), max(apart, default=0.0), cut_mm, idle_mm)


def apart_mm(path: Curve, points: list[tuple[float, float]]) -> float:
    """How far a path and a chain of points are from each other at most, their ends included."""
    ours, theirs = shapely.LineString(path.flatten(0.0005)), shapely.LineString(np.array(points))
    return float(
        max(
            shapely.distance(theirs, shapely.points(shapely.get_coordinates(ours))).max(),
            shapely.distance(ours, shapely.points(shapely.get_coordinates(theirs))).max(),
            math.dist(points[0], path.point_at(0.0)),
            math.dist(points[-1], path.vertices[-1, :2]),
        )
    )


def of_linuxcnc(text: str, control: str, tabs: bool = False, dialect: str = "", kerf_mm: float = 0.0) -> Heard:
    """What LinuxCNC's interpreter makes of a program, once it is spelt in its words; `tabs` are gone over unlit.

    The kerf is the width of tool 1, for programs that have the control add it.

    Raises
    ------
    AssertionError
        With what the interpreter says against it.
    """
    run = canon.run(in_linuxcnc(text, control, dialect), tolerance_mm=0.002, kerf_mm=kerf_mm)
    assert (run.error, run.warnings) == (None, [])
    assert tabs or not run.dry_feeds, "moves at a feed with the torch off"
    return Heard([b.points for b in run.burns], [b.length_mm for b in run.burns], run.idle_mm)


def of_toolpath(text: str, control: str, dialect: str = "") -> Heard:
    """What gcode-toolpath makes of a program; one without letters is spelt with them first."""
    letterless = control.startswith("essi") or dialect == "hpgl"
    heard = gcode_toolpath.read(in_linuxcnc(text, control, dialect) if letterless else text)
    return dataclasses.replace(heard, over_tabs=True)


def of_check(text: str, nest: Nest, profile: Profile) -> Heard:
    """What the check's own reader makes of a program."""
    program = read_program(text, nest, profile)
    assert program.faults == ()
    points = [[(x, y) for x, y in burn.path.flatten(0.0005).tolist()] for burn in program.burns]
    return Heard(points, [burn.path.length_mm for burn in program.burns], program.idle_mm, over_tabs=True)


def of_meerk40t(plan: Plan, nest: Nest, profile: Profile) -> Heard:
    """What MeerK40t makes of the program with chords within 0.0004 mm for its arcs."""
    dialect = load_dialect(profile.machine.dialect)
    chords = dataclasses.replace(dialect, arc_centre="none", chord_mm=0.0004)
    heard = meerk40t.read(write_program(plan, nest, profile, chords))
    unlit_mm = sum(high - low for made in toolpaths(plan, nest, profile) for low, high in made.unlit)
    return dataclasses.replace(heard, idle_mm=heard.idle_mm - unlit_mm)  # it counts the way over tabs as travel
