"""The text of programs: two small ones to the letter, and what every one keeps to."""

import re
from dataclasses import fields, replace
from pathlib import Path

import pytest

from kerfwise import InputError, Nest, Plan
from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.cut import Pierce, Span, Tab
from kerfwise.models.plan.read_plan import read_plan
from kerfwise.postproc.clock import with_times
from kerfwise.postproc.dialects import load_dialect
from kerfwise.postproc.nc import program
from kerfwise.postproc.nc.gcode import GcodeWriter, comment
from kerfwise.postproc.nc.program import write_program
from kerfwise.rule_kit import Curve, Cut, circle, nest, part, rect
from kerfwise.tests.postproc.plans import cut_of, good_cuts, plan_of, plate, profile
from kerfwise.tests.tools.qtplasmac import complaints

GOLDEN = Path(__file__).parent / "golden"
PROFILE = profile()
DIALECT = load_dialect("linuxcnc-qtplasmac")


def square() -> tuple[Nest, list[Cut]]:
    """One square part, cut once."""
    plain = replace(nest(100, 100, part("P1", rect(20, 20, 50, 50))), file="square.json", sha256="0a1b2c3d" * 8)
    return plain, [cut_of(plain.contour("P1.outer"), 0.1, "cw")]


def ring() -> tuple[Nest, list[Cut]]:
    """A ring with a mark, on a sheet with another home."""
    marked = nest(
        120, 120, part("Ring (left)", circle(60, 60, 40), [circle(60, 60, 20)], [[(40, 88), (80, 88, 0.5), (84, 84)]])
    )
    marked = replace(marked, file="ring.dxf", sha256="4e5f6071" * 8)
    ways = [("mark1", 0.0, "cw"), ("hole1", 0.75, "ccw"), ("outer", 0.25, "cw")]
    return marked, [cut_of(marked.contour(f"Ring (left).{name}"), at, way) for name, at, way in ways]  # type: ignore[arg-type]


def written(made: tuple[Nest, list[Cut]]) -> str:
    return write_program(plan_of(*made, PROFILE), made[0], PROFILE)


@pytest.mark.parametrize("make", [square, ring])
def test_to_the_letter(make) -> None:  # type: ignore[no-untyped-def]
    assert written(make()) == (GOLDEN / f"{make.__name__}.ngc").read_text()


def test_the_comparison_can_fail() -> None:
    sheet, (cut,) = square()
    assert cut.lead_in is not None
    other = [replace(cut, lead_in=cut.lead_in.moved(0.001, 0.0))]
    assert written((sheet, other)) != (GOLDEN / "square.ngc").read_text()


def test_same_input_same_bytes() -> None:
    assert written((plate(), good_cuts(plate()))) == written((plate(), good_cuts(plate())))


def test_a_plan_read_back_from_its_file_gives_the_same_bytes(tmp_path: Path) -> None:
    sheet = plate()
    found = build_candidates(sheet, PROFILE.lead_options())
    ways = [next(c for c in found if c.contour == k) for k in range(len(sheet.contours))]
    cuts = [Cut(sheet.contours[w.contour].id, w.entry, w.direction, w.pierce, w.lead_in, w.lead_out) for w in ways]
    plan = plan_of(sheet, cuts, PROFILE)
    (tmp_path / "plan.json").write_text(plan.to_json())
    again = read_plan(tmp_path / "plan.json")
    assert write_program(again, sheet, PROFILE) == write_program(plan, sheet, PROFILE)


def test_lines_are_numbered_short_and_plain() -> None:
    sheet = plate()
    lines = written((sheet, good_cuts(sheet))).splitlines()
    numbers = [int(m[1]) for m in (re.match(r"N(\d+) ", line) for line in lines) if m]
    assert numbers == list(range(10, 10 * len(numbers) + 10, 10))
    assert all(line.startswith(("N", "(")) and len(line) <= DIALECT.max_line and line.isascii() for line in lines)
    assert all(line.count("(") == line.count(")") <= 1 for line in lines)


@pytest.mark.linuxcnc
def test_qtplasmac_itself_has_nothing_to_say() -> None:
    sheet = plate()
    unmarked = [cut for cut in good_cuts(sheet) if "mark" not in cut.contour]
    assert complaints(written((sheet, unmarked)), 2500, 1.5) == []


def test_a_long_and_wild_name_is_cut_short_but_keeps_what_follows() -> None:
    text = comment(DIALECT, "CUT 3", "Träger (links) №7; M3 $0 " + "x" * 300, "ZONE 2 CW")
    assert text.startswith("(CUT 3 Trager _links_ No7_ M3 _0 xxx")
    assert text.endswith("x ZONE 2 CW)")
    assert len(text) == DIALECT.max_line


def test_an_edge_start_does_not_wait() -> None:
    edge = nest(100, 100, part("P1", rect(4, 20, 50, 50)))
    cut = cut_of(edge.contour("P1.outer"), 0.9, "cw", lead_mm=6.0)
    assert cut.pierce[0] < 0
    assert "G4 P" not in written((edge, [cut]))


def test_a_plan_of_another_nest_is_refused() -> None:
    sheet, cuts = square()
    plan = plan_of(sheet, cuts, PROFILE)
    with pytest.raises(
        InputError, match=r"made from another nest: its sha256 begins 0a1b2c3d0a1b, that of square\.json ffff"
    ):
        write_program(plan, replace(sheet, sha256="f" * 64), PROFILE)
    with pytest.raises(InputError, match="which is no contour of it"):
        write_program(plan, nest(100, 100), PROFILE)


def test_a_header_longer_than_the_control_takes_is_refused(tmp_path: Path) -> None:
    text = (Path(__file__).parents[3] / "postproc/dialects/linuxcnc-qtplasmac.yaml").read_text()
    (tmp_path / "shop.yaml").write_text(text.replace("- G21\n", f"- {'G21 ' * 70}\n"))
    plant = profile(machine=replace(PROFILE.machine, dialect=str(tmp_path / "shop.yaml")))
    sheet, cuts = square()
    with pytest.raises(InputError, match="block longer than max_line 250"):
        write_program(plan_of(sheet, cuts, plant), sheet, plant)


def test_an_arc_of_almost_a_full_turn_is_cut_in_two() -> None:
    # its ends are the same point once rounded: as one block it would be nothing, or a matter of the control's opinion
    circle_but_for_a_hair = Curve.of([(50, 0, 2e7), (50, -1e-5)], closed=False)
    blocks = GcodeWriter(DIALECT, (0, 0)).path(circle_but_for_a_hair, 10.0)
    assert blocks == ["G3 X-50 Y0 I-50 J0 F600", "G3 X50 Y0 I50 J0"]


def test_an_arc_of_a_thousandth_is_a_line() -> None:
    assert GcodeWriter(DIALECT, (0, 0)).path(Curve.of([(0, 0, 1), (0, -0.0025)], closed=False), 10.0) == [
        "G1 X0 Y-0.0025 F600"
    ]


def test_what_is_too_flat_or_too_short_for_an_arc_is_a_line_or_nothing() -> None:
    path = Curve.of([(0, 0, 1e-6), (10, 0, 0.5), (10.0008, 0), (10.00082, 0), (10.00082, 5)], closed=False)
    assert GcodeWriter(DIALECT, (0, 0)).path(path, 10.0) == ["G1 X10 Y0 F600", "G1 X10.0008 Y0", "G1 X10.0008 Y5"]


OF_BODY = profile()
OTHERS: dict[str, object] = {
    "contour": "B.outer",
    "direction": "ccw",
    "pierce": (1.0, 2.0),
    "lead_in": None,
    "lead_out": None,
    "zone": 9,
    "linked": True,
    "span": Span((0.0, 0.0), (1.0, 1.0)),
    "tabs": (Tab((1.0, 1.0), 0.5),),
    "torch": 2,
    "together": "A.outer",
    "way": "snake1",
}
NOT_IN_BLOCKS = {"start_s": 12.0, "end_s": 13.0, "excused": ("part-rigidity",), "entry": (1.0, 1.0)}


def test_every_field_of_a_cut_is_tried() -> None:
    assert {field.name for field in fields(Cut)} == OTHERS.keys() | NOT_IN_BLOCKS.keys()


@pytest.mark.parametrize("name", [*OTHERS, *NOT_IN_BLOCKS])
def test_what_blocks_hang_on(name: str) -> None:
    cut = next(cut for cut in good_cuts(plate()) if cut.lead_in is not None and cut.lead_out is not None)
    cut = replace(cut, direction="cw")
    other = replace(cut, **{name: {**OTHERS, **NOT_IN_BLOCKS}[name]})  # type: ignore[arg-type]
    assert (program._geometry(cut) == program._geometry(other)) == (name in NOT_IN_BLOCKS)


def made() -> Plan:
    sheet = plate()
    return plan_of(sheet, good_cuts(sheet), OF_BODY)


def test_a_program_is_spelt_once_with_its_times(monkeypatch: pytest.MonkeyPatch) -> None:
    sheet, spelt = plate(), []
    plain = program._body
    monkeypatch.setattr(program, "_body", lambda *given: spelt.append(1) or plain(*given))  # type: ignore[func-returns-value]
    plan = with_times(made(), sheet, OF_BODY)
    assert write_program(plan, sheet, OF_BODY) == write_program(plan, plate(), OF_BODY)
    assert len(spelt) == 2


def test_other_plans_profiles_and_dialects_have_blocks_of_their_own() -> None:
    sheet, plan = plate(), made()
    first, *rest = plan.cuts
    faster = replace(OF_BODY, machine=replace(OF_BODY.machine, cut_feed_mm_s=2 * OF_BODY.machine.cut_feed_mm_s))
    essi = replace(OF_BODY, machine=replace(OF_BODY.machine, dialect="essi"))
    asked = [
        (plan, OF_BODY),
        (replace(plan, cuts=(*rest, first)), OF_BODY),
        (replace(plan, cuts=(replace(first, dwell_s=3.0), *rest)), OF_BODY),
        (replace(plan, pierces=(Pierce(first.cut.contour, first.cut.pierce, 1),)), OF_BODY),
        (plan, faster),
        (plan, essi),
    ]
    of_own = [write_program(one, plate(), by) for one, by in asked]
    assert len(set(of_own)) == len(asked)
    assert [write_program(one, sheet, by) for one, by in asked] == of_own
