"""Names that a program cannot hold: replaced, the map kept in its header, and found again by the check."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.postproc.check.reader.controls import CONTROLS
from kerfwise.postproc.check.reader.rs274 import read_nc
from kerfwise.postproc.check.result import ids_by_name, normalize_name
from kerfwise.postproc.dialects import load_dialect
from kerfwise.postproc.nc.gcode import comment
from kerfwise.postproc.nc.head_comments import name_comments, program_names
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.rules.case import nest, part, rect
from kerfwise.tests.fuzz import control as controls
from kerfwise.tests.postproc.plans import cut_of, plan_of, profile
from kerfwise.tests.tools.amount import examples

DIALECT = load_dialect("linuxcnc-qtplasmac")
PROFILE = profile()


def plates(*names: str):
    parts = [part(name, rect(30 + 120 * (k % 8), 30 + 120 * (k // 8), 80, 80)) for k, name in enumerate(names)]
    return nest(1000, 1000, *parts)


def told(names: list[str]) -> list[str]:
    return list(program_names(plates(*names), DIALECT).values())


@pytest.mark.parametrize("name", ["P1", "Plate (2)-a", "Bracket 7, left", "x" * 150])
def test_a_plain_name_is_kept(name: str) -> None:
    sheet = plates(name)
    names = program_names(sheet, DIALECT)
    assert list(name_comments(names, DIALECT)) == []
    assert normalize_name(names[f"{name}.outer"]) == normalize_name(f"{name}.outer")


def test_others_are_replaced() -> None:
    assert told(["Плита №7", "a", "A", "(;)", " x", "b ZONE 7", "é" * 200]) == [
        "No7.outer-1",
        "a.outer-2",
        "A.outer-3",
        "outer-4",
        "x.outer-5",
        "b_ZONE_7.outer-6",
        "eeeeeeeeeeeeeeeeeeeeeeee-7",
    ]


names = st.text(st.characters(codec="utf-8") | st.sampled_from("();%=/\n\x0b\u2028 aA.-_"), min_size=1, max_size=40)


@examples(200)
@given(
    st.lists(names | st.sampled_from(["abort,", "o=0", "a" * 300, "A", "a", "NAME 1 a IS b"]), unique=True, max_size=6)
)
def test_every_name_is_found_again(ids: list[str]) -> None:
    sheet = plates(*ids)
    made = program_names(sheet, DIALECT)
    mapped = list(name_comments(made, DIALECT))
    cuts = [comment(DIALECT, f"CUT {k}", name, "ZONE 1 CW") for k, name in enumerate(made.values(), 1)]
    assert all(line.isascii() and line.isprintable() and len(line) <= DIALECT.max_line for line in [*mapped, *cuts])
    program = read_nc("\n".join([*mapped, *cuts, "M2", ""]))
    found = ids_by_name(sheet, program.comments)
    said = [text.split(" ", 2)[2].removesuffix(" ZONE 1 CW") for text in program.comments[len(mapped) :]]
    assert [found[normalize_name(name)] for name in said] == [contour.id for contour in sheet.contours]


@pytest.mark.linuxcnc
@pytest.mark.parametrize("name", ["Плита (1); M3 $0\n", "\u202eabc", "x" * 400, "abort,now", "\x0bM5 $0"])
@pytest.mark.parametrize("dialect", ["linuxcnc-qtplasmac", "linuxcnc"])
def test_the_control_reads_such_a_program_and_the_check_finds_its_contours(name: str, dialect: str) -> None:
    sheet = plates(name, "A", "a")
    plant = replace(PROFILE, machine=replace(PROFILE.machine, dialect=dialect))
    cuts = [cut_of(sheet.contours[k], 0.5, "cw") for k in (1, 2, 0)]
    program = write_program(plan_of(sheet, cuts, plant), sheet, plant)
    assert program.isascii()
    assert all(len(line) <= DIALECT.max_line and line.isprintable() for line in program.split("\n"))
    run = controls.run(program.encode(), dialect)
    assert (run.error, run.warnings, len(run.burns)) == (None, [], 3)
    assert len(read_nc(program, control=CONTROLS[dialect]).burns) == 3
    assert not [text for text in check_program(sheet, program, plant).warnings if "the comment names" in text]
    swapped = program.replace("CUT 1 A.outer-2 ", "CUT 1 a.outer-3 ")
    assert swapped != program
    assert [text for text in check_program(sheet, swapped, plant).warnings if "the comment names a.outer" in text]
