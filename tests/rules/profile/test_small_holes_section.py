"""The profile's section of small holes."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise import InputError, load_profile


def test_the_limits_follow_the_thickness_and_the_room_of_a_pierce(tmp_path: Path) -> None:
    file = tmp_path / "plant.yaml"
    head = "based_on: plasma-carbon-steel\nmaterial: {thickness: 12 mm}\n"
    file.write_text(head + "small_holes: {min_hole: 1.5 × thickness, under: skip}\n", encoding="utf-8")
    limits = load_profile(file).hole_limits()
    assert (limits.least_mm, limits.room_mm, limits.full_feed_mm, limits.under) == (18, 6, 60, "skip")


def test_the_least_hole_may_be_a_table(tmp_path: Path) -> None:
    file = tmp_path / "plant.yaml"
    head = "based_on: plasma-carbon-steel\nmaterial: {thickness: 9 mm}\n"
    file.write_text(head + "small_holes: {min_hole: {6 mm: 6 mm, 12 mm: 18 mm}}\n", encoding="utf-8")
    assert load_profile(file).hole_limits().least_mm == 12


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
    assert limits.under == "ask"
    assert limits.least_mm == pytest.approx(least_mm)
    assert limits.share_at(least_mm) == pytest.approx(share_at_least)
    assert limits.share_at(1000) == 1
