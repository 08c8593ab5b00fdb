"""Readers that nobody here has written make of each dialect's programs what the plan says.

A small plate with arcs, a hole within a hole, and where the dialect knows how, a mark; the real nests are in the table
of docs/dialects.md.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import cache

import pytest

from kerfwise.encoder.nest import Nest
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.dialects import dialect_names, load_dialect
from kerfwise.postproc.nc.program import write_program
from kerfwise.rules.profile.profile import Profile
from kerfwise.tests.postproc.dialects import reading
from kerfwise.tests.postproc.plans import good_cuts, plan_of, plate, profile
from kerfwise.tests.tools import canon
from kerfwise.tests.tools.outside.heard import Heard
from kerfwise.tests.tools.outside.mapped import in_linuxcnc


@cache
def case(name: str) -> tuple[Plan, Nest, Profile, str]:
    """A plan, its nest, the profile, and the program in a dialect."""
    plant, nest = reading.with_dialect(profile(), name), plate()
    if not load_dialect(name).marks:
        nest = dataclasses.replace(nest, parts=tuple(dataclasses.replace(part, marks=()) for part in nest.parts))
    plan = plan_of(nest, [cut for cut in good_cuts(plate()) if cut.contour in nest.index], plant)
    return plan, nest, plant, write_program(plan, nest, plant)


def agrees(name: str, heard: Heard) -> bool:
    plan, nest, plant, _ = case(name)
    found = reading.differences(plan, nest, plant, heard)
    return reading.agree(found, load_dialect(name), plan.totals.cut_mm)


@pytest.mark.linuxcnc
@pytest.mark.parametrize("name", dialect_names())
def test_linuxcncs_interpreter(name: str) -> None:
    text, control = case(name)[3], load_dialect(name).control
    assert agrees(name, reading.of_linuxcnc(text, control, dialect=name))
    run = canon.run(in_linuxcnc(text, control, name))
    assert [b.tool != 0 for b in run.burns] == [planned.kind == "mark" for planned in case(name)[0].cuts]


@pytest.mark.node
@pytest.mark.parametrize("name", [name for name in dialect_names() if load_dialect(name).line])
def test_gcode_toolpath(name: str) -> None:
    assert agrees(name, reading.of_toolpath(case(name)[3], load_dialect(name).control, name))


def test_meerk40ts_grbl_reader() -> None:
    heard = reading.of_meerk40t(*case("grbl")[:3])
    assert agrees("grbl", heard)
    assert heard.powers == [200 if planned.kind == "mark" else 1000 for planned in case("grbl")[0].cuts]


@pytest.mark.parametrize("name", dialect_names())
def test_the_checks_own_reader(name: str) -> None:
    _, nest, plant, text = case(name)
    assert agrees(name, reading.of_check(text, nest, plant))


@pytest.mark.parametrize(
    "change",
    [{"arc_centre": "none"}, {"arc_centre": "radius"}, {"positions": "incremental"}, {"feed_alone": True}],
    ids=lambda change: next(iter(change)) + " " + str(next(iter(change.values()))),
)
@pytest.mark.linuxcnc
def test_other_spellings_of_the_same_paths(change: dict[str, object]) -> None:
    plan, nest, plant, _ = case("linuxcnc")
    dialect = dataclasses.replace(load_dialect("linuxcnc"), **change)  # type: ignore[arg-type]
    if dialect.positions == "incremental":
        dialect = dataclasses.replace(dialect, header=tuple(b.replace("G90 ", "G91 ") for b in dialect.header))
    text = write_program(plan, nest, plant, dialect)
    heard = reading.of_linuxcnc(text, "linuxcnc")
    near_mm = dialect.chord_mm + 0.005 if dialect.arc_centre == "none" else 0.01
    assert reading.differences(plan, nest, plant, heard).within(near_mm, length_mm=0.5)
    assert reading.differences(plan, nest, plant, reading.of_check(text, nest, plant)).within(near_mm, length_mm=0.5)


Damage = Callable[[str], str]
DAMAGES: dict[str, tuple[str, Damage]] = {
    "an arc's sign": ("eia", lambda text: text.replace("G02", "G03", 1)),
    "a missing off": ("eia", lambda text: text.replace(" M08\n", " G40\n", 1)),
    "a point": ("grbl", lambda text: text.replace("G1 X64 Y19.25", "G1 X64 Y19.45", 1)),
    "a centre": ("grbl", lambda text: text.replace("G2 X19.25 Y20 I0", "G2 X19.25 Y20 I4", 1)),
    "a step": ("essi", lambda text: text.replace("39+2500\n+", "39+2500\n+9", 1)),
    "a way": ("burny", lambda text: text.replace("X64 Y15.25", "X65 Y15.25", 1)),
}


@pytest.mark.linuxcnc
@pytest.mark.parametrize("what", DAMAGES)
def test_the_comparison_can_fail(what: str) -> None:
    name, damage = DAMAGES[what]
    text = case(name)[3]
    assert damage(text) != text
    run = canon.run(in_linuxcnc(damage(text), load_dialect(name).control))
    heard = Heard([b.points for b in run.burns], [b.length_mm for b in run.burns], run.idle_mm)
    assert run.error is not None or run.warnings or not agrees(name, heard)
