"""Readers that nobody here has written make of each dialect's programs what the plan says.

A small plate with arcs, a hole within a hole, and where the dialect knows how, a mark; the real nests are in the table
of docs/dialects.md.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
import shapely

from kerfwise.encoder.nest import Nest
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.clock.timed import read_program
from kerfwise.postproc.dialects import dialect_names, load_dialect
from kerfwise.postproc.nc.plan_paths import toolpaths
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.dialect_read_back import read_back
from kerfwise.rules.profile.profile import Profile
from kerfwise.tests.postproc.plans import good_cuts, plan_of, plate, profile
from kerfwise.tests.tools import canon
from kerfwise.tests.tools.outside import gcode_toolpath, meerk40t
from kerfwise.tests.tools.outside.heard import Heard
from kerfwise.tests.tools.outside.mapped import in_linuxcnc

APART_MM = 0.01


def without_marks(nest: Nest) -> Nest:
    return dataclasses.replace(nest, parts=tuple(dataclasses.replace(part, marks=()) for part in nest.parts))


@cache
def case(name: str) -> tuple[Nest, Plan, Profile, str]:
    """A nest, its plan, the profile, and the program in a dialect."""
    dialect = load_dialect(name)
    machine = dataclasses.replace(profile().machine, dialect=name, process=dialect.processes[0], pierce_dwell=None)
    plant = profile(machine=machine)
    nest = plate() if dialect.marks else without_marks(plate())
    plan = plan_of(nest, [cut for cut in good_cuts(plate()) if cut.contour in nest.index], plant)
    return nest, plan, plant, write_program(plan, nest, plant)


def differences(name: str, heard: Heard, text: str | None = None) -> list[str]:
    """Where what a reader has heard is not what the plan says."""
    nest, plan, plant, _ = case(name)
    paths = [made.path for made in toolpaths(plan, nest, plant)]
    if len(paths) != len(heard.burns):
        return [f"{len(heard.burns)} burns for {len(paths)} cuts"]
    found = []
    for k, (path, points, length_mm) in enumerate(zip(paths, heard.burns, heard.lengths_mm, strict=True), 1):
        ours, theirs = shapely.LineString(path.flatten(0.001)), shapely.LineString(np.array(points))
        apart = max(
            shapely.distance(theirs, shapely.points(shapely.get_coordinates(ours))).max(),
            shapely.distance(ours, shapely.points(shapely.get_coordinates(theirs))).max(),
            math.dist(points[0], path.point_at(0.0)),
            math.dist(points[-1], path.vertices[-1, :2]),
        )
        if apart > APART_MM or abs(path.length_mm - length_mm) > APART_MM + 1e-4 * path.length_mm:
            found.append(f"cut {k} is {apart:.4f} mm off, {length_mm:.3f} mm long for {path.length_mm:.3f}")
    if abs(heard.idle_mm - plan.totals.idle_mm) > 0.1:
        found.append(f"{heard.idle_mm:.3f} mm of travel for {plan.totals.idle_mm:.3f}")
    return found


def of_linuxcnc(name: str, text: str) -> Heard:
    run = canon.run(in_linuxcnc(text, load_dialect(name).control))
    assert (run.error, run.warnings, run.dry_feeds) == (None, [], [])
    return Heard([b.points for b in run.burns], [b.length_mm for b in run.burns], run.idle_mm)


@pytest.mark.linuxcnc
@pytest.mark.parametrize("name", dialect_names())
def test_linuxcncs_interpreter(name: str) -> None:
    text = case(name)[3]
    assert differences(name, of_linuxcnc(name, text)) == []
    run = canon.run(in_linuxcnc(text, load_dialect(name).control))
    assert [b.tool != 0 for b in run.burns] == [planned.kind == "mark" for planned in case(name)[1].cuts]


@pytest.mark.node
@pytest.mark.parametrize("name", [name for name in dialect_names() if load_dialect(name).line])
def test_gcode_toolpath(name: str) -> None:
    text = case(name)[3]
    heard = gcode_toolpath.read(text)
    assert differences(name, heard) == []


def grbl_of_lines() -> tuple[str, Heard]:
    """The program for GRBL with its arcs as chords within 0.002 mm, and what MeerK40t makes of it."""
    nest, plan, plant, _ = case("grbl")
    import kerfwise.postproc.nc.program as program_module

    dialect = dataclasses.replace(load_dialect("grbl"), arc_centre="none", chord_mm=0.002)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(program_module, "fitting_dialect", lambda profile: dialect)
        text = write_program(plan, nest, plant)
    return text, meerk40t.read(text)


def test_meerk40ts_grbl_reader() -> None:
    text, heard = grbl_of_lines()
    assert "G2 " not in text
    assert differences("grbl", heard) == []
    powers = [200 if planned.kind == "mark" else 1000 for planned in case("grbl")[1].cuts]
    assert heard.powers == powers


@pytest.mark.parametrize("name", dialect_names())
def test_the_checks_own_reader(name: str) -> None:
    nest, plan, plant, text = case(name)
    read_back(load_dialect(name), name)
    program = read_program(text, nest, plant)
    points = [[(x, y) for x, y in burn.path.flatten(0.001).tolist()] for burn in program.burns]
    heard = Heard(points, [burn.path.length_mm for burn in program.burns], program.idle_mm)
    assert differences(name, heard) == []
    assert program.faults == ()
    assert [burn.tool != 0 for burn in program.burns] == [planned.kind == "mark" for planned in plan.cuts]


Damage = Callable[[str], str]
DAMAGES: dict[str, tuple[str, Damage]] = {
    "an arc's sign": ("eia", lambda text: text.replace("G02", "G03", 1)),
    "a missing off": ("eia", lambda text: text.replace(" M08\n", " G40\n", 1)),
    "a point": ("grbl", lambda text: text.replace("G1 X64 Y19.25", "G1 X64 Y19.45", 1)),
    "a centre": ("grbl", lambda text: text.replace("G2 X19.25 Y20 I0", "G2 X19.25 Y20 I4", 1)),
    "a way": ("burny", lambda text: text.replace("X64Y", "X65Y", 1).replace("X64 Y", "X65 Y", 1)),
}


@pytest.mark.linuxcnc
@pytest.mark.parametrize("what", DAMAGES)
def test_the_comparison_can_fail(what: str) -> None:
    name, damage = DAMAGES[what]
    text = case(name)[3]
    assert damage(text) != text
    run = canon.run(in_linuxcnc(damage(text), load_dialect(name).control))
    heard = Heard([b.points for b in run.burns], [b.length_mm for b in run.burns], run.idle_mm)
    assert run.error is not None or run.warnings or differences(name, heard) != []
