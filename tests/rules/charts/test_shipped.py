"""The charts that come with kerfwise: every row with its source, found by grades of its family, out to QtPlasmaC."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.rules.charts import look_up, qtplasmac_text, read_chart, shipped_charts
from kerfwise.rules.charts.chart import NoRow, family_of
from kerfwise.rules.profile.load import load_profile
from kerfwise.tests.commands.run_cli import kerfwise


@pytest.mark.parametrize("name", shipped_charts())
def test_every_row_has_a_source_and_feeds_that_fall_with_thickness(name: str) -> None:
    rows = read_chart(shipped_charts()[name]).rows
    assert all(row.values["source"] for row in rows)
    for material in {row.values["material"] for row in rows}:
        mine = sorted(
            (row.values["thickness"], row.values["feed"]) for row in rows if row.values["material"] == material
        )
        assert [feed for _, feed in mine] == sorted((feed for _, feed in mine), reverse=True)  # type: ignore[type-var]


@pytest.mark.parametrize(
    ("grade", "family"),
    [
        ("S235", "mild steel"), ("s 355 j2", "mild steel"), ("St37-2", "mild steel"), ("A36", "mild steel"),
        ("DC01", "mild steel"), ("Q235A", "mild steel"), ("1.0038", "mild steel"), ("Mild Steel", "mild steel"),
        ("1.4301", "stainless steel"), ("304L", "stainless steel"), ("AISI 316", "stainless steel"),
        ("X5CrNi18-10", "stainless steel"), ("V2A", "stainless steel"), ("Inox", "stainless steel"),
        ("AlMg3", "aluminium"), ("EN AW-5754", "aluminium"), ("5083", "aluminium"), ("Aluminum", "aluminium"),
        ("oak", ""), ("copper", ""), ("", ""),
    ],
)  # fmt: skip
def test_grades_belong_to_families(grade: str, family: str) -> None:
    assert family_of(grade) == family


def test_a_grade_finds_the_row_of_its_family() -> None:
    chart = read_chart(shipped_charts()["plasma-air"])
    assert look_up(chart, None, "S355", 8.0).values["kerf"].value == 1.7
    assert look_up(chart, None, "1.4301", 8.0).values["kerf"].value == 1.8
    with pytest.raises(NoRow, match="unknown material 'oak'"):
        look_up(chart, None, "oak", 8.0)
    with pytest.raises(NoRow, match="has no row of S235 at 25 mm"):
        look_up(chart, None, "S235", 25.0)


def test_a_profile_names_a_shipped_chart_and_is_told_what_it_is(tmp_path: Path) -> None:
    path = tmp_path / "plant.yaml"
    path.write_text("based_on: plasma-carbon-steel\nmaterial: {chart: plasma-air, name: S355, thickness: 8 mm}\n")
    plant = load_profile(path)
    assert (plant.material.kerf_mm, round(plant.machine.cut_feed_mm_s * 60)) == (1.7, 1550)
    notes = plant.chart_notes()
    assert notes[0].startswith("material chart plasma-air.csv: starting values of Hypertherm Powermax SYNC")
    assert not any("itself" in note for note in notes)


@pytest.mark.parametrize(
    ("based_on", "chart", "thickness", "feed_mm_min"),
    [("plasma-carbon-steel", "plasma-air", 7, 2060), ("oxyfuel-thick-plate", "oxyfuel", 30, 264)],
)
def test_between_two_rows_of_a_shipped_chart(
    tmp_path: Path, based_on: str, chart: str, thickness: int, feed_mm_min: int
) -> None:
    path = tmp_path / "plant.yaml"
    row = f"{{chart: {chart}, name: S355, thickness: {thickness} mm, interpolate: true}}"
    path.write_text(f"based_on: {based_on}\nmaterial: {row}\n")
    plant = load_profile(path)
    assert round(plant.machine.cut_feed_mm_s * 60) == feed_mm_min
    assert "starting values of" in next(iter(plant.chart_notes()))


def test_a_flames_chart_has_feeds_and_leaves_kerf_and_preheating_to_the_profile(tmp_path: Path) -> None:
    path = tmp_path / "plant.yaml"
    path.write_text("based_on: oxyfuel-thick-plate\nmaterial: {chart: oxyfuel, name: S355, thickness: 25 mm}\n")
    plant = load_profile(path)
    assert (round(plant.machine.cut_feed_mm_s * 60), plant.material.kerf_mm) == (280, 2.0)
    notes = "\n".join(plant.chart_notes())
    assert "nozzle 1.6 mm" in notes
    assert "says nothing of kerf" in notes
    assert "says nothing of pierce_delay" in notes


def test_charts_on_the_command_line(tmp_path: Path) -> None:
    listed = kerfwise("profile", "chart")
    assert listed.out.count("starting values of") == len(shipped_charts())
    assert "810500MU" in kerfwise("profile", "chart", "plasma-air").out
    assert "did you mean 'plasma-air'?" in kerfwise("profile", "chart", "plasma-aire").err
    assert kerfwise("profile", "chart", "plasma-air", "-o", tmp_path / "x_material.cfg").code == 2
    assert kerfwise("profile", "chart", "examples/charts/shop.csv", "-o", tmp_path / "x.csv").code == 2


def test_what_qtplasmac_is_given_reads_back_the_same(tmp_path: Path) -> None:
    shop = tmp_path / "shop.csv"
    shop.write_text(
        "name,kerf [mm],feed [mm/min],pierce_delay [s],pierce_height [mm],cut_height [mm],amps [A]\n"
        "S235 6 mm,1.5,2900,0.5,3.8,1.5,85\nbare,1.2,1000,0.1,,,\n"
    )
    written = tmp_path / "x_material.cfg"
    written.write_text(qtplasmac_text(read_chart(shop)))
    (row,) = read_chart(written).rows
    before = read_chart(shop).rows[0]
    assert {k: v for k, v in row.values.items() if k != "name"} == pytest.approx(
        {k: v for k, v in before.values.items() if k != "name"}
    )
    assert row.names == ("S235 6 mm", "1")
    shop.write_text("material,thickness [mm],kerf [mm]\nS235,6,1.5\n")
    with pytest.raises(InputError, match="no row has all that QtPlasmaC asks"):
        qtplasmac_text(read_chart(shop))
