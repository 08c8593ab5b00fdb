"""Several torches that do not all do the same: what only a second one does is judged, too."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import pytest

from kerfwise.encoder.cut import HotSpot
from kerfwise.encoder.errors import InputError
from kerfwise.postproc.check import Besides
from kerfwise.postproc.check.check import check_program
from kerfwise.postproc.check.cuts_from_program import rebuild
from kerfwise.postproc.check.feeds import Heating, judge_running
from kerfwise.postproc.check.reader.controls import CONTROLS, Setup
from kerfwise.postproc.check.reader.program import expand_torches
from kerfwise.postproc.check.reader.read_program import read_old
from kerfwise.postproc.check.reader.rs274 import read_nc
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.plant_sections import Torches
from kerfwise.rules.profile.profile import Profile
from kerfwise.tests.postproc.plans import profile

APART = Torches(2, 100.0, "y")
PARTS = nest(200, 200, part("A", rect(20, 20, 50, 50)), part("B", rect(20, 120, 50, 50)))


def plant() -> Profile:
    machine = replace(profile().machine, dialect="linuxcnc", torches=APART)
    return replace(profile(), machine=machine)


def program(*rows: str) -> str:
    return "\n".join(("G21 G90", "M64 P1", *rows, "G0 X0 Y0", "M2"))


def test_over_a_tab_goes_on_what_was_lit_before() -> None:
    rows = ("M65 P1", "G0 X0 Y0", "M3 S1", "G1 X10 F600", "M5", "{}", "G1 X11", "M3 S1", "G1 X20", "M5", "M2")
    burnt = []
    for selected in ("M65 P1", "M64 P1"):
        text = "\n".join(("G21 G90", *rows)).format(selected)
        read = read_nc(text, Setup(tab_mm=2.0, torches=2), control=CONTROLS["linuxcnc"])
        burnt.append([(round(burn.path.length_mm), burn.torches) for burn in read.burns])
    assert burnt == [[(20, ())], [(10, ()), (9, (2,))]]


def test_a_torch_pierces_where_the_first_begins_off_the_sheet() -> None:
    plant_ = plant()
    text = program("G0 X100 Y-5", "M3 S1", "G1 Y20 F600", "M5")
    told = {}
    for rows in (text, text.replace("M64", "M65")):
        read = read_nc(rows, Setup(torches=2), control=CONTROLS["linuxcnc"])
        (waits,) = (j for j in judge_running(PARTS, read, plant_) if j.id == "pierce-delay")
        told[rows] = [v.text for v in waits.violations]
    assert told[text] == ["line 4: torch 2 stands for 0 s before it moves, the profile asks for 0.5 s"]
    assert not told[text.replace("M64", "M65")]


def test_holes_of_a_pass_are_pierced_by_each_torch() -> None:
    text = program("G0 X10 Y10", "M3 S1", "G4 P0.5", "M5")
    read = expand_torches(read_nc(text, Setup(torches=2), control=CONTROLS["linuxcnc"]), APART.shift)
    built = rebuild(PARTS, read, 1.5, (0.0, 0.0), in_passes=True)
    assert [hole.at for hole in built.cuts.pierces] == [(10.0, 10.0), (10.0, 110.0)]


def test_heat_is_that_of_all_torches() -> None:
    seen: list[list[float]] = []

    def thermometer(stretches: Sequence[Heating]) -> tuple[HotSpot, ...] | None:
        seen.append(sorted(float(stretch.points[0][1]) for stretch in stretches))
        return None

    text = program("G0 X20 Y10", "M3 S1", "G4 P0.5", "G1 X70 F600", "M5")
    check_program(PARTS, text, plant(), besides=Besides(thermometer))
    assert seen[0] == [10.0, 110.0]


@pytest.mark.parametrize("control", ["linuxcnc-qtplasmac", "grbl", "essi"])
def test_a_control_without_words_for_torches_is_refused(control: str) -> None:
    for read in (read_nc, read_old):
        with pytest.raises(InputError, match="selects torches"):
            read("G21\nM2\n", control=CONTROLS[control], setup=Setup(torches=2))


def test_a_trusted_program_says_which_torches_burn() -> None:
    text = program("G0 X10 Y10", "M3 S1", "G1 X20 F600", "M5").replace("M64 P1\n", "")
    faults = read_old(text, CONTROLS["linuxcnc"], setup=Setup(torches=2)).program.faults
    assert "a tool starts before it is said whether torch 2 burns too" in [fault.text for fault in faults]
