"""A good program damaged in its text fails, and the rule that is broken is named."""

import re
from collections.abc import Callable

import pytest

from kerfwise.postproc.check import CheckResult, report
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.rules.case import nest, part, rect
from kerfwise.tests.postproc.plans import cut_of, good_cuts, plan_of, plate, profile

PLATE, PROFILE = plate(), profile()
PROGRAM = write_program(plan_of(PLATE, good_cuts(PLATE), PROFILE), PLATE, PROFILE)


def check(program: str) -> CheckResult:
    assert program != PROGRAM
    return check_program(PLATE, program, PROFILE)


def in_cut(name: str, change: Callable[[list[str]], list[str]]) -> str:
    """The program with the blocks of one cut changed, from its comment to the torch off."""
    before, comment, rest = re.split(rf"(?m)(^\((?:CUT|MARK) \d+ {re.escape(name)} .*\n)", PROGRAM)
    blocks, off, after = re.split(r"(?m)(^N\d+ M5 .*\n)", rest, maxsplit=1)
    return before + comment + "".join(line + "\n" for line in change([*blocks.splitlines(), off.strip()])) + after


def x_moved(mm: float) -> Callable[[str], str]:
    return lambda line: re.sub(r"X(\S+)", lambda m: f"X{float(m[1]) + mm:.4f}", line)


def test_torch_left_on_during_a_rapid() -> None:
    result = check(in_cut("A.outer", lambda lines: lines[:-1]))
    assert result.broken() == ("torch-off-travel",)
    assert "line 49: the torch is on during a rapid of 186.8 mm" in report(result)
    assert "tool $0 is started while $0 is on" in report(result)


def test_torch_left_on_at_the_end() -> None:
    result = check(re.sub(r"N\d+ M5 \$0\n\(HOME\)\n.*\n.*\nN\d+ M5 \$-1\n", "", PROGRAM))
    assert result.broken() == ("torch-off-travel", "returns-home")
    assert "the program ends with the torch on" in report(result)


def test_path_shifted_by_a_tenth() -> None:
    result = check(in_cut("E.outer", lambda lines: [x_moved(0.1)(line) for line in lines]))
    assert result.broken() == ("contour-geometry", "no-gouging")
    assert "the torch is up to 0.10 mm off where E.outer asks for it" in report(result)
    assert check(in_cut("E.outer", lambda lines: [x_moved(0.03)(line) for line in lines])).ok


def test_a_torch_lit_in_the_middle_of_a_part_that_does_not_move() -> None:
    result = check(PROGRAM.replace("(HOME)", "G0 X150 Y25\nM3 $0 S1\nM5 $0\n(HOME)"))
    assert {"no-gouging", "every-contour-once"} <= set(result.broken())


def test_one_corner_shifted_by_a_tenth() -> None:
    result = check(in_cut("B.hole1", lambda lines: [*lines[:5], x_moved(-0.1)(lines[5]), *lines[6:]]))
    assert result.broken() == ("contour-geometry",)


def test_a_spike_in_the_path() -> None:
    result = check(in_cut("E.outer", lambda lines: [*lines[:5], "G1 X500 Y70", lines[4], *lines[5:]]))
    assert result.broken() == ("contour-geometry",)
    assert "the torch is up to 9.25 mm off where E.outer asks for it" in report(result)


def test_a_detour_from_the_contour_to_the_contour() -> None:
    """All its ends lie where the torch should be; it crosses scrap between two sides of a part."""
    detour = ["G1 X530 Y60.75", "G1 X480.75 Y110", "G1 X530 Y60.75"]
    result = check(in_cut("E.outer", lambda lines: [*lines[:5], *detour, *lines[5:]]))
    assert result.broken() == ("contour-geometry",)
    assert re.search(r"the torch is up to 2\d\.\d\d mm off where E\.outer asks for it", report(result))


def test_round_not_finished_and_round_twice() -> None:
    result = check(in_cut("B.hole1", lambda lines: [*lines[:7], *lines[9:]]))
    assert "contour-geometry" in result.broken()
    assert "B.hole1 is not closed: " in report(result)
    result = check(in_cut("B.hole1", lambda lines: [*lines[:9], *lines[4:9], *lines[9:]]))
    assert result.broken() == ("links", "contour-geometry")
    assert "the torch goes round B.hole1 more than once" in report(result)
    assert "mm of them once more along it" in report(result)


def test_kerf_on_the_wrong_side() -> None:
    def outside(lines: list[str]) -> list[str]:
        return ["G0 X235 Y100", lines[1], "G1 X237.75 Y100 F2500", "G3 I-12.75", lines[-1]]

    result = check(in_cut("C.hole1", outside))
    assert "kerf-side" in result.broken()
    assert "the torch runs outside C.hole1, so that the kerf is on the part's side" in report(result)


def test_kerf_not_allowed_for() -> None:
    thin = profile(material=type(PROFILE.material)(kerf_mm=0.0))
    cuts = [cut_of(PLATE.contour(c.contour), 0.3, c.direction, c.zone, 0.0) for c in good_cuts(PLATE)]
    program = write_program(plan_of(PLATE, cuts, thin), PLATE, thin)
    assert check_program(PLATE, program, thin).ok
    result = check(program)
    assert "kerf-side" in result.broken()
    assert len(result.rule("kerf-side").violations) == 8
    assert "the torch runs on A.outer itself: the kerf of 1.5 mm is not allowed for" in report(result)


def test_something_cut_that_is_not_in_the_nest() -> None:
    extra = "G0 X560 Y100\nM3 $0 S1\nG4 P0.5\nG1 X580 Y100 F2500\nX580 Y120\nM5 $0\n(HOME)"
    result = check(PROGRAM.replace("(HOME)", extra))
    assert result.broken() == ("every-contour-once",)
    assert "burns along no contour of the nest, at X 560.0 to 580.0, Y 100.0 to 120.0" in report(result)


def test_a_pierce_without_a_path() -> None:
    pierce = "G0 X560 Y100\nM3 $0 S1\nG4 P0.5\nM5 $0\n(HOME)"
    assert check(PROGRAM.replace("(HOME)", pierce)).broken() == ("every-contour-once",)


def test_a_mark_cut_through_and_a_contour_only_marked() -> None:
    swap = {"M3 $1": "M3 $0", "M5 $1": "M5 $0"}
    cut_through = in_cut("A.mark1", lambda lines: [re.sub("M[35] .1", lambda m: swap[m[0]], line) for line in lines])
    result = check(cut_through)
    assert "A.mark1 is a mark, but the torch cuts through it" in report(result)
    only_marked = in_cut("C.hole1", lambda lines: [line.replace("$0", "$1") for line in lines])
    result = check(only_marked)
    assert result.broken() == ("every-contour-once", "feeds", "pierce-delay")
    assert "C.hole1 is only marked, not cut" in report(result)


def test_a_mark_drawn_there_and_back_without_one_side() -> None:
    """The path goes through all corners of the mark, and ends where it began."""
    square = [(60.0, 60.0), (100.0, 60.0), (100.0, 90.0), (60.0, 90.0), (60.0, 60.0)]
    marked = nest(300, 200, part("P", rect(20, 20, 200, 130), (), [square]))
    cuts = [cut_of(contour, 0.3, "cw") for contour in sorted(marked.contours, key=lambda c: c.kind)]
    program = write_program(plan_of(marked, cuts, PROFILE), marked, PROFILE)
    assert check_program(marked, program, PROFILE).ok
    last_side = "N110 G1 X60 Y60\n"
    assert program.count(last_side) == 1
    there_and_back = program.replace(last_side, "G1 X100 Y90\nG1 X60 Y90\nG1 X60 Y60\n")
    result = check_program(marked, there_and_back, PROFILE)
    assert "39.88 mm of P.mark1 are not marked" in report(result)
    assert result.broken() == ("contour-geometry",)


def test_zones_and_start_side_come_from_comments() -> None:
    assert check(PROGRAM.replace("D.outer ZONE 2", "D.outer ZONE 9")).broken() == ("zone-order",)
    assert set(check(PROGRAM.replace("SIDE LEFT", "SIDE RIGHT")).broken()) == {"start-side", "level-ahead"}


@pytest.mark.parametrize(
    ("now", "said"),
    [
        ("CUT 9 D.outer", "the comment names D.outer, but E.outer is cut"),
        ("CUT 9 Z.outer", "the comment names Z.outer, which the nest does not have, but E.outer is cut"),
        ("CUT 3 E.outer", "the comment says number 3, but E.outer is number 9"),
        ("MARK 9 E.outer", "the comment says MARK, but E.outer is cut"),
        ("CUT 9 E.outer ZONE 2 CCW)\n(", "the comment says CCW, but E.outer is cut cw"),
    ],
)
def test_a_comment_that_says_otherwise_than_what_is_cut_is_a_warning(now: str, said: str) -> None:
    (text,) = [line for line in PROGRAM.splitlines() if line.startswith("(CUT 9 E.outer")]
    damaged = now.removesuffix("\n(") if "\n" in now else text[1:].replace("CUT 9 E.outer", now)
    result = check(PROGRAM.replace(text, f"({damaged}"))
    assert result.ok
    assert len(result.warnings) == 1
    assert said in result.warnings[0]


def test_feeds_other_than_the_profile_says() -> None:
    result = check(in_cut("E.outer", lambda lines: [line.replace("F2500", "F2750") for line in lines]))
    assert result.broken() == ("feeds",)
    assert "it cuts at 2750 mm/min, the profile says 2500 mm/min" in report(result)
    assert check(PROGRAM.replace("F6000", "F3000")).broken() == ("feeds",)
    assert check(PROGRAM.replace("M68 E3 Q0", "M68 E3 Q60")).broken() == ("feeds",)
    slow = check(in_cut("E.outer", lambda lines: [lines[0].replace("G0", "G1"), *lines[1:]]))
    assert slow.broken() == ("feeds",)
    assert "at cutting feed with the torch off" in report(slow)


def test_pierces_too_short_too_long_and_in_the_middle() -> None:
    wait = "G4 P0.5"
    for other, says in (("", "0 s"), ("G4 P0.25", "0.25 s"), ("G4 P1", "1 s")):
        result = check(in_cut("E.outer", lambda lines, other=other: [line.replace(wait, other) for line in lines]))  # type: ignore[misc]
        assert result.broken() == ("pierce-delay",)
        assert f"the torch stands for {says} before it moves, the profile asks for 0.5 s" in report(result)
    result = check(in_cut("E.outer", lambda lines: [*lines[:6], wait, *lines[6:]]))
    assert result.broken() == ("pierce-delay",)
    halted = check(in_cut("E.outer", lambda lines: [*lines[:6], "M0", *lines[6:]]))
    assert halted.broken() == ("torch-off-travel",)


def test_the_way_home_is_missing() -> None:
    result = check(re.sub(r"(?<=\(HOME\)\n).*\n", "", PROGRAM))
    assert result.broken() == ("returns-home",)
    assert "the program ends at (481.350, 76.800), the machine's home is (0, 0)" in report(result)


@pytest.mark.parametrize(
    ("word", "says"),
    [
        ("G21", "its units (G21 or G20)"),
        ("G90 ", "how it counts (G90 or G91)"),
        ("G17 ", "the plane of arcs (G17)"),
        ("G91.1 ", "how it counts their centres (G91.1 or G90.1)"),
        ("G40 ", "that the control leaves the kerf alone (G40)"),
        ("G94", "what F means (G94)"),
        (" P0.05", "how near the control keeps to the path (G61, or G64 with P, and Q, of at most 0.05 mm)"),
    ],
)
def test_nothing_is_left_to_the_state_of_the_control(word: str, says: str) -> None:
    result = check(PROGRAM.replace(word, "", 1))
    assert result.broken() == ("program-state",)
    assert f"it moves before it has said {says}" in report(result)


def test_rounded_corners_and_a_tool_that_does_not_start() -> None:
    assert check(PROGRAM.replace("G64 P0.05", "G64 P0.5")).broken() == ("program-state",)
    assert check(in_cut("E.outer", lambda lines: ["G64", *lines])).broken() == ("program-state",)
    result = check(in_cut("E.outer", lambda lines: [line.replace(" S1", "") for line in lines]))
    assert result.broken() == ("program-state",)
    assert "tool $0 is started without S1" in report(result)
