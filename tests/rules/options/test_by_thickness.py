"""Lengths in thicknesses of the sheet, and the profile's section of small holes."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.by_thickness import ByThickness, LengthByThickness
from kerfwise.rules.options.kind import Unfit
from kerfwise.rules.profile.profile import load_profile

KIND = LengthByThickness()


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1 × thickness", ByThickness(1.0)),
        ("0.5 x thickness", ByThickness(0.5)),
        (".25*thickness", ByThickness(0.25)),
        ("2 thicknesses", ByThickness(2.0)),
        ("5", ByThickness(None, 5.0)),
        ("0.5 cm", ByThickness(None, 5.0)),
    ],
)
def test_it_is_read_and_written(text: str, value: ByThickness) -> None:
    assert KIND.read(yaml.compose(text)) == value
    assert KIND.read(yaml.compose(KIND.write(value))) == value


@pytest.mark.parametrize("text", ["-1 × thickness", "thick", "1 × height", "[1]", "-3 mm", ""])
def test_what_is_neither_is_refused(text: str) -> None:
    with pytest.raises(Unfit, match=r"a length such as '5 mm', or '1\.5 × thickness'"):
        KIND.read(yaml.compose(text) or yaml.ScalarNode("tag:yaml.org,2002:null", ""))


def test_the_limits_follow_the_thickness_and_the_room_of_a_pierce(tmp_path: Path) -> None:
    file = tmp_path / "plant.yaml"
    head = "based_on: plasma-carbon-steel\nmaterial: {thickness: 12 mm}\n"
    file.write_text(head + "small_holes: {min_hole: 1.5 × thickness, under: skip}\n", encoding="utf-8")
    limits = load_profile(file).hole_limits()
    assert (limits.least_mm, limits.room_mm, limits.full_feed_mm, limits.under) == (18, 6, 60, "skip")


def test_a_full_feed_that_begins_below_the_least_hole_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "plant.yaml"
    file.write_text("based_on: plasma-carbon-steel\nsmall_holes: {full_feed_hole: 5 mm}\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"full_feed_hole: 5 mm is less than min_hole, 6 mm"):
        load_profile(file)


@pytest.mark.parametrize(
    ("name", "least_mm", "share_at_least"),
    [
        ("plasma-carbon-steel", 6.0, 0.6),
        ("oxyfuel-thick-plate", 20.0, 0.75),
        ("laser-amg3m-1mm", 0.5, 0.5),
        ("laser-st10kp-2mm", 1.0, 0.5),
        ("laser-wood", 2.0, 1.0),
        ("water-jet", 4.0, 0.5),
    ],
)
def test_shipped_profiles(name: str, least_mm: float, share_at_least: float) -> None:
    limits = load_profile(name).hole_limits()
    assert limits.under == "refuse"
    assert limits.least_mm == pytest.approx(least_mm)
    assert limits.share_at(least_mm) == pytest.approx(share_at_least)
    assert limits.share_at(1000) == 1
