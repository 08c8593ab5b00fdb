"""The filter judges as QtPlasmaC documents it."""

import pytest

from kerfwise.tests.tools.qtplasmac import complaints

pytestmark = pytest.mark.linuxcnc

GOOD = "G21\nG0 X10 Y10\nM3 $0 S1\nG1 X20 F2500\nM5 $0\nM2\n"


def test_a_good_program_passes() -> None:
    assert complaints(GOOD, 2500, 1.5) == []


def test_a_torch_on_before_any_movement_does_not() -> None:
    assert any(
        "M3 command detected before movement" in line
        for line in complaints(GOOD.replace("G0 X10 Y10\n", ""), 2500, 1.5)
    )


def test_another_feed_than_the_material_s_does_not() -> None:
    assert any("F2500 does not match" in line for line in complaints(GOOD, 3000, 1.5))
