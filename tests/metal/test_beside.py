"""Kerf that the control adds: this judge's paths beside what is named, against LinuxCNC's interpreter and by hand."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from kerfwise.tests.metal.beside import Move, NoRoom, torch_ways
from kerfwise.tests.metal.hand_made import HEAD, TAIL
from kerfwise.tests.metal.made_nests import made
from kerfwise.tests.metal.planned import tried
from kerfwise.tests.metal.plant import plant
from kerfwise.tests.metal.program import UnreadableProgram, read_program
from kerfwise.tests.metal.simulate import by_kind, simulate
from kerfwise.tests.metal.test_program import shared_mm
from kerfwise.tests.postproc.dialects.test_kerf_by_control import BY_TABLE, DYNAMIC, PLATE, planned, shop
from kerfwise.tests.tools import canon

LINES = ["G0 X-10 Y50", "G41 D1", "G0 X-5", "M3 $0 S1", "G1 X0 F2000", "G1 Y100", "G1 X100", "G1 Y0", "G1 X0", "G1 Y50"]
SQUARE = [*LINES, "M5 $0", "G40"]


def text_of(blocks: list[str]) -> str:
    return "\n".join([*HEAD, *blocks, *TAIL])


@pytest.mark.linuxcnc
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("kerf", [DYNAMIC, BY_TABLE])
def test_programs_are_read_as_linuxcnc_reads_them(kerf: str, turned: bool, tmp_path: Path) -> None:
    profile = shop(tmp_path, "linuxcnc", kerf)
    plan, text = planned(profile, turned=turned)
    own = read_program(text, profile.material.kerf_mm)
    machine = canon.run(text, tolerance_mm=0.002, kerf_mm=profile.material.kerf_mm)
    assert machine.error is None
    assert len(own.paths) == len(machine.burns) == len(plan.cuts)
    for path, burn in zip(own.paths, machine.burns, strict=True):
        assert shared_mm(path.points, burn.points) < 0.005
    assert math.fsum(math.dist(a, b) for a, b in own.idle) == pytest.approx(
        math.fsum(math.dist(a, b) for a, b in machine.rapids), abs=0.01
    )


def test_a_square_by_hand() -> None:
    (burn,) = read_program(text_of(SQUARE), 2.0).paths
    assert burn.points[0].tolist() == [-5.0, 51.0]
    assert burn.points[-1].tolist() == [-1.0, 50.0]
    length = sum(math.dist(a, b) for a, b in zip(burn.points[:-1], burn.points[1:], strict=True))
    assert length == pytest.approx(4 + 49 + 50 + 300 + 2 * math.pi, abs=0.01)
    (inside,) = read_program(text_of(SQUARE).replace("G41", "G42"), 2.0).paths
    assert (inside.points.min(axis=0).tolist(), inside.points.max(axis=0).tolist()) == ([-5.0, 1.0], [99.0, 99.0])


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("G0 X-10 Y50", "G0 X-5.5 Y50", "the first move is no line of half the kerf or more"),
        ("G1 Y50\n", "G1 Y50\nG3 X-0.8 Y49.2 I-0.4 J-0.4\n", "an arc of 0.5657 mm is no more than half the kerf"),
        ("G1 Y50\n", "G1 Y50\nG1 X-0.5\nG1 Y20\n", "half the kerf has no room in the corner at"),
        ("G40\n(HOME)", "(HOME)", "the program ends before G40"),
        ("M3 $0 S1", "M3 $0 S1\nG1 X-4 F2000\nG41 D1", "G41 is not known here"),
        ("G41 D1\nG0 X-5", "G41 D1 G0 X-5", "G41 is not known here"),
    ],
)
def test_what_no_control_does_is_refused(old: str, new: str, said: str) -> None:
    text = text_of(SQUARE)
    assert old in text
    with pytest.raises(UnreadableProgram, match=said):
        read_program(text.replace(old, new), 2.0)
    with pytest.raises(UnreadableProgram, match="G41 is not known here"):
        read_program(text)


def test_an_arc_gives_up_what_the_torch_has_no_room_for() -> None:
    ways = torch_ways([Move((-3, 0), (0, 0)), Move.arc((0, 0), (0, 4), (4, 4), ccw=True), Move((4, 4), (9, 4))], -1.0)
    assert ways[1][:2].tolist()[0] != ways[1][-1].tolist()
    assert math.dist(ways[1][-1], (0, 4)) == pytest.approx(5.0, abs=0.003)
    assert ways[1][-1][1] == pytest.approx(3.0)  # where the circle of 5 mm meets the line a millimetre below
    with pytest.raises(NoRoom):
        torch_ways([Move.arc((0, 0), (0, 4), (4, 4), ccw=True)], 1.0)


def test_a_wrong_side_or_kerf_makes_scrap(tmp_path: Path) -> None:
    profile = shop(tmp_path, "linuxcnc", DYNAMIC)
    _, text = planned(profile)
    asked = plant(profile)
    assert "part-eroded" not in by_kind(simulate(PLATE, text, **asked))
    assert "part-eroded" in by_kind(simulate(PLATE, text.replace("G41.1", "G42.1"), **asked))
    assert "part-eroded" in by_kind(simulate(PLATE, re.sub(r"(G41\.1 D)1\.5", r"\g<1>1.2", text, count=1), **asked))
    assert "left-uncut" in by_kind(simulate(PLATE, re.sub(r"(G41\.1 D)1\.5", r"\g<1>1.8", text, count=1), **asked))


def test_a_made_nest_is_planned_and_burnt_without_a_finding() -> None:
    done = tried(made(0), "plasma-carbon-steel", ("--work", "0.1"), True, "kerf by the control")
    assert [(one.refused, one.broken, one.findings, one.cuts > 0) for one in done] == [("", "", (), True)] * 2
