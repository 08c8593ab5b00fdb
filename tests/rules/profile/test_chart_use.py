"""A profile and its chart: what the chart gives, what the profile says itself, what is said aloud, and its sha256."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise import InputError, Profile, load_profile
from kerfwise.tests.commands.run_cli import kerfwise

CHART = """\
material, thickness [mm], kerf [mm], feed [mm/min], pierce_delay [s], cut_height [mm], amps, gas
S235, 6, 1.5, 2500, 0.5, 1.5, 85, O2/air
S235, 10, 1.9, 1500, , 1.7, 85, O2/air
S355, 6, 1.6, 2300, 0.6, 1.5, 85, O2/air
"""


@pytest.fixture(autouse=True)
def chart(tmp_path: Path) -> Path:
    (tmp_path / "charts").mkdir()
    (tmp_path / "charts" / "shop.csv").write_text(CHART)
    return tmp_path / "charts" / "shop.csv"


def loaded(tmp_path: Path, text: str, name: str = "plant.yaml") -> Profile:
    (tmp_path / name).write_text(text)
    return load_profile(tmp_path / name)


def test_the_chart_gives_what_the_profile_does_not_say(tmp_path: Path) -> None:
    plant = loaded(tmp_path, "material: {chart: charts/shop.csv, thickness: 10 mm, kerf: 2 mm}\n")
    assert (plant.material.kerf_mm, plant.material.cut_height_mm, plant.material.amps) == (2.0, 1.7, 85.0)
    assert (plant.machine.cut_feed_mm_s, plant.machine.pierce_time_s, plant.material.gas) == (25.0, 0.5, "O2/air")
    assert list(plant.chart_notes()) == [
        "material chart shop.csv: the profile says kerf 2 mm itself, the chart says 1.9 mm for S235, 10 mm",
        "material chart shop.csv says nothing of pierce_delay for S235, 10 mm: 0.5 s holds",
    ]


def test_what_lies_between_two_rows_is_said_aloud(tmp_path: Path) -> None:
    text = "material: {chart: charts/shop.csv, thickness: 8 mm, interpolate: true}\n"
    plant = loaded(tmp_path, text)
    assert (plant.material.kerf_mm, plant.machine.cut_feed_mm_s * 60) == (1.7, pytest.approx(2000))
    assert list(plant.chart_notes()) == [
        "material chart shop.csv: kerf 1.7 mm, feed 2000 mm/min, cut_height 1.6 mm are interpolated between 6 mm "
        "(line 2) and 10 mm (line 3)",
        "material chart shop.csv says nothing of pierce_delay for S235, 8 mm: 0.5 s holds",
    ]
    with pytest.raises(InputError, match=r"plant\.yaml:1:\d+: material\.row: .*shop\.csv has no row of S235 at 8 mm"):
        loaded(tmp_path, text.replace("true", "false"))


def test_a_chart_beats_what_the_profile_is_based_on_and_is_beaten_by_what_is_based_on_it(tmp_path: Path) -> None:
    loaded(tmp_path, "material: {kerf: 1.2 mm}\nmachine: {cut_feed: 1 m/min}\n", "base.yaml")
    loaded(tmp_path, "based_on: base.yaml\nmaterial: {chart: charts/shop.csv}\n", "charted.yaml")
    plant = loaded(tmp_path, "based_on: charted.yaml\nmachine: {cut_feed: 3 m/min}\n")
    assert (plant.material.kerf_mm, plant.machine.cut_feed_mm_s) == (1.5, 50.0)
    (note,) = plant.chart_notes()
    assert note.endswith("the profile says feed 3000 mm/min itself, the chart says 2500 mm/min for S235, 6 mm")
    other = loaded(tmp_path, "based_on: charted.yaml\nmaterial: {name: S355}\n")
    assert (other.material.kerf_mm, other.machine.cut_feed_mm_s * 60) == (1.6, pytest.approx(2300))


def test_a_row_for_another_thickness_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"material\.thickness: 6 mm, but the row 'S235, 10 mm' of the chart"):
        loaded(tmp_path, "material: {chart: charts/shop.csv, row: {thickness: 10 mm}, thickness: 6 mm}\n")


def test_row_without_a_chart(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r":1:17: material\.row: there is no chart: give material\.chart"):
        loaded(tmp_path, "material: {row: S235}\n")


def test_each_value_says_where_it_is_from(tmp_path: Path, chart: Path) -> None:
    plant = loaded(tmp_path, "material:\n  chart: charts/shop.csv\n  cut_height: 2 mm\n")
    assert plant.chart is not None
    told = kerfwise("profile", "show", tmp_path / "plant.yaml", "--sources").out
    from_where = {row.split(":")[0].strip(): row.rpartition("; ")[2] for row in told.splitlines()}
    assert from_where["cut_feed"] == f"{chart}:2"
    assert from_where["cut_height"] == f"{tmp_path / 'plant.yaml'}:3"
    assert from_where["home"] == "default"
    assert f"machine.cut_feed: 2500 mm/min, {chart}:2" in kerfwise("profile", "check", tmp_path / "plant.yaml").out
    assert str(chart) + ":2" not in kerfwise("profile", "show", tmp_path / "plant.yaml").out


def test_what_show_prints_is_the_same_profile(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("plant.yaml").write_text(
        "material: {chart: charts/shop.csv, row: {gas: O2/air}, thickness: 8 mm, interpolate: true}\n"
        "corners: {corner_feed: 0.5}\n"
    )
    plant = load_profile("plant.yaml")
    Path("plant.yaml").write_text(kerfwise("profile", "show", "plant.yaml").out)
    assert load_profile("plant.yaml") == plant
    assert not load_profile("plant.yaml").chart_notes()


def test_the_sha256_covers_every_file(tmp_path: Path, chart: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("shop.yaml").write_text(kerfwise("dialects", "show", "linuxcnc").out)
    loaded(tmp_path, "machine: {travel: 10 m/min}\n", "base.yaml")
    text = "based_on: base.yaml\nmaterial: {chart: charts/shop.csv}\nmachine: {dialect: shop.yaml}\n"
    seen = [loaded(tmp_path, text).sha256]
    assert loaded(tmp_path, text).sha256 == seen[0]
    for file in (chart, Path("shop.yaml"), Path("base.yaml")):
        file.write_text(file.read_text() + "# seen\n")
        seen.append(loaded(tmp_path, text).sha256)
    assert len(set(seen)) == 4


BEVELS = """\
material, thickness [mm], kerf [mm], kerf_30 [mm], kerf_45 [mm], kerf_22.5 [mm]
S235, 10, 1.8, 2.0, 2.2, 1.9
S235, 20, 2.0, 2.2, 2.6,
"""


def test_kerfs_by_angle_are_those_of_bevels(tmp_path: Path, chart: Path) -> None:
    chart.write_text(BEVELS)
    text = "material: {chart: charts/shop.csv, thickness: 20 mm}\ncuts: {bevel: {head: tilting}}\n"
    text += "machine: {dialect: linuxcnc}\n"
    plant = loaded(tmp_path, text)
    assert plant.cuts.bevel.kerfs == ((30.0, 2.2), (45.0, 2.6))
    options = plant.bevel_options()
    assert options is not None
    assert [options.kerf_mm(angle) for angle in (0, 30, 37.5, -45)] == pytest.approx([2.0, 2.2, 2.4, 2.6])
    assert f"cuts.bevel.kerfs at 45°: 2.6 mm, {chart}:3" in kerfwise("profile", "check", tmp_path / "plant.yaml").out
    between = loaded(tmp_path, text.replace("20 mm", "15 mm, interpolate: true"))
    assert between.cuts.bevel.kerfs == ((30.0, 2.1), (45.0, 2.4))
    note = "kerf 1.9 mm, kerf_30 2.1 mm, kerf_45 2.4 mm are interpolated between 10 mm (line 2) and 20 mm (line 3)"
    assert any(note in one for one in between.chart_notes())


def test_a_profile_beats_the_kerfs_by_angle_of_its_chart_and_is_told_where_that_has_none(
    tmp_path: Path, chart: Path
) -> None:
    chart.write_text(BEVELS)
    text = "material: {chart: charts/shop.csv, thickness: 10 mm}\ncuts: {bevel: {head: tilting}}\n"
    own = loaded(tmp_path, text.replace("tilting", "tilting, kerfs: {30: 2.5 mm, 45: 2.2 mm}"))
    assert own.cuts.bevel.kerfs == ((30.0, 2.5), (45.0, 2.2))
    said = [one for one in own.chart_notes() if "itself" in one]
    assert [one.partition(": ")[2] for one in said] == [
        "the profile says kerf_30 2.5 mm itself, the chart says 2 mm for S235, 10 mm",
        "the profile says kerf_22.5 {30: 2.5 mm, 45: 2.2 mm} itself, the chart says 1.9 mm for S235, 10 mm",
    ]
    loaded(tmp_path, text, "base.yaml")
    based = loaded(tmp_path, "based_on: base.yaml\ncuts: {bevel: {kerfs: {30: 2.5 mm}}}\n")
    assert based.cuts.bevel.kerfs == ((30.0, 2.5),)
    assert any("the profile says kerf_30 2.5 mm itself" in one for one in based.chart_notes())
    thicker = loaded(tmp_path, "based_on: base.yaml\nmaterial: {thickness: 20 mm}\n")
    assert thicker.cuts.bevel.kerfs == ((30.0, 2.2), (45.0, 2.6))
    chart.write_text(CHART)
    silent = loaded(tmp_path, text)
    note = "says nothing of the kerf of a torch that leans (such as kerf_45) for S235, 10 mm: that of an upright one"
    assert any(note in one for one in silent.chart_notes())


@pytest.mark.parametrize("column", ["kerf_0", "kerf_75", "kerf_-30", "kerf_30,5"])
def test_an_angle_that_no_bevel_has_is_no_column(tmp_path: Path, chart: Path, column: str) -> None:
    chart.write_text(f'"{column} [mm]", thickness [mm]\n2, 10\n')
    with pytest.raises(InputError, match="expected the angle of a bevel in degrees, 1 to 60, such as kerf_45"):
        loaded(tmp_path, "material: {chart: charts/shop.csv, thickness: 10 mm}\n")
