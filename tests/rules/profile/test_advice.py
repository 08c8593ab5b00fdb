"""What a profile's mistakes are answered with: what a number may mean, where a key belongs, what a thickness needs."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from kerfwise import InputError, Profile, load_profile
from kerfwise.encoder.scrap import MOST_PIECES, with_scrap
from kerfwise.jobs.nest_job.job import job_of
from kerfwise.rule_kit import OrWord, nest, part, rect
from kerfwise.rules.charts.read_chart import read_chart
from kerfwise.rules.options.option import Members, options_of
from kerfwise.rules.options.quantities import LengthSpan, PointXY, Quantity
from kerfwise.rules.profile.overrides import read_setting, with_settings
from kerfwise.rules.profile.sections import SECTIONS, default_settings


def profile(folder: Path, text: str) -> Profile:
    path = folder / "plant.yaml"
    path.write_text(text, encoding="utf-8")
    return load_profile(path)


def told(folder: Path, text: str) -> str:
    with pytest.raises(InputError) as caught:
        profile(folder, text)
    return str(caught.value).removeprefix(f"{folder / 'plant.yaml'}:")


NUMBERS = {
    "machine: {cut_feed: '3,200 mm/min'}": "is it 3200 mm/min or 3.2 mm/min? Write it without a comma",
    "machine: {cut_feed: '1,000'}": "is it 1000 or 1? Write it without a comma",
    "machine: {home: ['1,000', 2]}": "is it 1000 or 1? Write it without a comma",
    "material: {kerf: '1,5 mm'}": "write decimals with a point, 1.5 mm",
    "material: {kerf: '0,500'}": "write decimals with a point, 0.5",
    "machine: {travel: '1.234,5'}": "write decimals with a point, 1234.5",
    "machine: {travel: '1,234,567'}": "write decimals with a point, 1234567",
    "machine: {travel: '12 000 mm/min'}": "write 12000 mm/min",
    "machine: {travel: 12_000}": "write 12000",
    'machine: {travel: "12\'000"}': "write 12000",
    "leads: {entries: '1,000'}": "is it 1000 or 1? Write it without a comma",
    "objective: {idle: '1,500'}": "is it 1500 or 1.5? Write it without a comma",
}


@pytest.mark.parametrize("text", NUMBERS)
def test_what_a_number_with_commas_or_divided_thousands_may_mean(text: str, tmp_path: Path) -> None:
    assert told(tmp_path, text).endswith(NUMBERS[text])


UNLIKELY = {
    "machine: {cut_feed: 3200 m/min}": (
        "machine.cut_feed: 3.2e+06 mm/min is not likely, expected 3 mm/min to 120000 mm/min: "
        "did you mean 3200 mm/min or in/min?"
    ),
    "machine: {cut_feed: 2.5}": "did you mean 2.5 mm/s, m/min or in/min?",
    "machine: {cut_feed: 2.500 mm/min}": "did you mean 2500 mm/min, or 2.500 mm/s, m/min or in/min?",
    "machine: {cut_feed: 3.2}": "likely for plasma, expected 20 mm/min and more: did you mean 3.2 m/min?",
    "machine: {mark_feed: 9000 m/min}": "did you mean 9000 mm/min or in/min?",
    "machine: {travel: 15 mm/min}": "did you mean 15 mm/s, m/min or in/min?",
    "machine: {pierce_time: 500}": "500 s is not likely, expected 0 s to 120 s: did you mean 500 ms?",
    "machine: {edge_preheat: 1 min, pierce_time: 3 min}": "expected 0 s to 120 s: did you mean 3 s or ms?",
    "material: {thickness: 6 m}": "6000 mm is not likely, expected 0.05 mm to 500 mm: did you mean 6 mm, cm or in?",
    "material: {thickness: 6000}": "6000 mm is not likely, expected 0.05 mm to 500 mm",
    "material: {kerf: 0}": "0 mm is not likely, expected 0.01 mm to 20 mm",
    "material: {kerf: 15 cm}": "did you mean 15 mm?",
    "material: {pierce_height: 3.8 m}": "did you mean 3.8 mm, cm or in?",
    "leads: {lead_out_length: 5 m}": "did you mean 5 mm, cm or in?",
    "cuts: {scrap: {grid: 1.5}}": "1.5 mm is not likely, expected 20 mm to 100000 mm: did you mean 1.5 m or in?",
    "cuts: {links: {longest: 30 m}}": "did you mean 30 mm, cm or in?",
    "leads: {lead_in: 6 m}": "6000 mm is not likely, expected 0 mm to 500 mm: did you mean 6 mm, cm or in?",
    "leads: {hole_overcut: {6 mm: 1 mm, 25 mm: 2 m}}": "expected 0 mm to 50 mm: did you mean 2 mm or cm?",
    "small_holes: {min_hole: 150 × thickness}": ("150 × thickness is not likely, expected 100 × thickness at most"),
    "nesting: {edge: 10 m}": "10000 mm is not likely, expected 0 mm to 5000 mm: did you mean 10 mm, cm or in?",
    "rules: {hold-small-parts: {strength: hard, width: 1 m}}": "did you mean 1 mm, cm or in?",
    "rules: {pierce: {clearance: 3 m}}": "expected 0 mm to 200 mm: did you mean 3 mm, cm or in?",
    "rules: {heat-lag: {lag: 500 min}}": "did you mean 500 s or ms?",
    "heat: {grid: 5 m}": "did you mean 5 mm, cm or in?",
    "time: {model: acceleration, acceleration: 1 mm/s2, corner_deviation: 5 m}": "did you mean 5 mm or cm?",
}


@pytest.mark.parametrize("text", UNLIKELY)
def test_numbers_that_no_plant_has_are_in_another_unit(text: str, tmp_path: Path) -> None:
    assert told(tmp_path, text).endswith(UNLIKELY[text])


NO_RANGE = {
    "home", "travel_x", "travel_y",  # places on a machine
    "amps", "volts", "power", "pierce_power", "mark_power", "gas_flow",  # their ends are those of any plant
    "head_weight",  # mm of travel, as the weights of rules
}  # fmt: skip


def test_every_quantity_of_a_profile_has_a_range() -> None:
    def bare(group: Any) -> Iterator[str]:
        for one in options_of(group):
            if isinstance(one.kind, Members):
                yield from bare(getattr(group, one.name))
            kind = one.kind.quantity if isinstance(one.kind, OrWord) else one.kind
            if isinstance(kind, PointXY | LengthSpan) or (isinstance(kind, Quantity) and kind.likely is None):
                yield one.key

    sections = [section() for section in SECTIONS.values()]
    rules = [setting.options for setting in default_settings().values()]
    assert {key for group in (*sections, *rules) for key in bare(group)} == NO_RANGE


def test_profiles_and_charts_have_the_same_limits(tmp_path: Path) -> None:
    chart = tmp_path / "shop.csv"
    chart.write_text("material,thickness [m],feed [m/min]\nS235,6,3200\n", encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_chart(chart)
    of_chart = " ".join((str(caught.value), *caught.value.details))
    for text in ("material: {thickness: 6 m}", "machine: {cut_feed: 3200 m/min}"):
        assert told(tmp_path, text).partition(": ")[2].partition(": ")[2] in of_chart


def test_a_water_jet_may_be_slow(tmp_path: Path) -> None:
    assert profile(tmp_path, "based_on: water-jet\nmachine: {cut_feed: 5 mm/min}").machine.cut_feed_mm_s == 5 / 60


BELONGS = {
    "machine: {kerf: 1.5}": "1:11: machine: there is no key 'kerf' here, it belongs under material: {kerf: …}",
    "kerf: 1.5": "1:1: there is no key 'kerf' here, it belongs under material: {kerf: …}",
    "level-ahead: off": "1:1: there is no key 'level-ahead' here, it belongs under rules: {level-ahead: …}",
    "cuts: {shortest: 20}": (
        "1:8: cuts: there is no key 'shortest' here, it belongs under cuts: {common: {shortest: …}}"
    ),
    "cuts: {grid: 200}": (
        "1:8: cuts: there is no key 'grid' here, it belongs under cuts: {scrap: {grid: …}} or heat: {grid: …}"
    ),
    "leads: {clearance: 1}": (
        "1:9: leads: there is no key 'clearance' here, it belongs under rules: {pierce: {clearance: …}}"
    ),
    "rules: {clearance: 1}": (
        "1:9: rules: there is no key 'clearance' here, it belongs under rules: {pierce: {clearance: …}}"
    ),
    "rules: {leads: {lead: arc}}": "1:9: rules: there is no key 'leads' here, it belongs under leads: {…}",
    "machine: {torches: {kerf: 2}}": (
        "1:21: machine.torches: there is no key 'kerf' here, it belongs under material: {kerf: …}"
    ),
    "layers: {cut: x}": "1:1: there is no key 'layers' here, it belongs under drawing: {layers: {…}}",
    "rules: {level-ahead: {clearance: 3}}": (
        "1:23: rules.level-ahead: there is no key 'clearance' here, it belongs under rules: {pierce: {clearance: …}}"
    ),
    "machine: {thicknes: 6}": "1:11: machine: there is no key 'thicknes' here; did you mean material: {thickness: …}?",
    "rules: {heat-lag: {kerf: 2}}": (
        "1:20: rules.heat-lag: there is no key 'kerf' here, it belongs under material: {kerf: …}"
    ),
    "longest: 20": "1:1: there is no key 'longest' here, it belongs under cuts: {links: {longest: …}}",
}


def test_a_beginning_of_a_key_is_not_taken_for_a_section(tmp_path: Path) -> None:
    answer = told(tmp_path, "prices: {machine: 60}")
    assert "prices: unknown key 'machine': did you mean 'machine_hour'?" in answer
    assert "belongs under" not in answer
    assert "rules.t-max: unknown key 't_max' (valid: dwells, limit," in told(tmp_path, "rules: {t-max: {t_max: 900}}")


@pytest.mark.parametrize(
    ("text", "unit"),
    [("machine: {cut_feed: 100 ipm}", "in/min"), ("material: {thickness: 0.25 inch}", "in"),
     ("machine: {pierce_time: 1 sec}", "s")],
)  # fmt: skip
def test_a_unit_that_is_spelt_otherwise_elsewhere(text: str, unit: str, tmp_path: Path) -> None:
    assert told(tmp_path, text).endswith(f": did you mean {unit}?")


@pytest.mark.parametrize("text", BELONGS)
def test_a_key_in_the_wrong_section_is_told_where_it_belongs(text: str, tmp_path: Path) -> None:
    assert told(tmp_path, text) == BELONGS[text]


@pytest.mark.parametrize(
    ("text", "where"),
    [
        ("rules: {heat-lag: {colour: red}}", "rules.heat-lag"),
        ("rules: {heat-lag: {linetype: DASHED}}", "rules.heat-lag"),
        ("rules: {no-islands: {longest: 20}}", "rules.no-islands"),
        ("machine: {colour: red}", "machine"),
        ("material: {longest: 20}", "material"),
        ("rules: {part-rigidity: {tial: 5}}", "rules.part-rigidity"),
    ],
)
def test_a_key_of_a_group_is_advised_in_its_own_section_only(text: str, where: str, tmp_path: Path) -> None:
    answer = told(tmp_path, text)
    assert f"{where}: unknown key" in answer
    assert "belongs under" not in answer


def test_a_key_that_is_set_in_the_wrong_section_is_told_where_it_belongs() -> None:
    with pytest.raises(InputError, match="machine: there is no key 'kerf' here, it belongs under material"):
        with_settings(load_profile(), [read_setting("machine.kerf=1.4 mm")])


def test_a_key_without_its_section_is_told_where_it_belongs() -> None:
    with pytest.raises(InputError) as caught:
        with_settings(load_profile(), [read_setting("kerf=1.4 mm")])
    assert "there is no key 'kerf' here, it belongs under material: {kerf: …}" in str(caught.value)
    with pytest.raises(InputError) as caught:
        job_of("cut_feed: 3 m/min", "plate.job.yaml")
    told = "it belongs under machine: {cut_feed: …} of a profile: in a job file that stands under set"
    assert told in str(caught.value)


ON = {
    "common: {}": ("common", "shortest_mm", 20.0),
    "common:": ("common", "shortest_mm", 20.0),
    "common: {good_side: any}": ("common", "shortest_mm", 20.0),
    "common: {shortest: off}": ("common", "shortest_mm", None),
    "common: {shortest: 30 mm}": ("common", "shortest_mm", 30.0),
    "links: {}": ("links", "longest_mm", 30.0),
    "links: {longest: 0}": ("links", "longest_mm", 0.0),
    "scrap: {}": ("scrap", "grid_mm", 500.0),
    "scrap: {remnant: left}": ("scrap", "grid_mm", None),
    "scrap: {remnant: off}": ("scrap", "grid_mm", None),
}


@pytest.mark.parametrize("text", ON)
def test_an_empty_group_means_its_defaults(text: str, tmp_path: Path) -> None:
    group, name, value = ON[text]
    cuts = profile(tmp_path, f"machine: {{dialect: linuxcnc, accept_dialect: true}}\ncuts:\n  {text}\n").cuts
    assert getattr(getattr(cuts, group), name) == value


def test_what_a_profile_has_that_another_is_based_on_stays_on_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "base.yaml").write_text("cuts: {links: {longest: 12 mm}}", encoding="utf-8")
    assert profile(tmp_path, "based_on: base.yaml\ncuts: {links: {}}").cuts.links.longest_mm == 12.0


def test_a_rule_that_is_off_and_empty_is_refused(tmp_path: Path) -> None:
    said = "1:27: rules.hold-small-parts: the rule is off, and nothing is said of it: give its strength too, one of "
    assert told(tmp_path, "rules: {hold-small-parts: {}}").startswith(said)


KEPT = {
    "material: {thickness: 12}": "kerf 1.5 mm, cut_feed 2500 mm/min and pierce_time 0.5 s stay as they are for 6 mm",
    "material: {thickness: 12, kerf: 2}": "cut_feed 2500 mm/min and pierce_time 0.5 s stay as they are for 6 mm",
    "material: {thickness: 12, kerf: 2}\nmachine: {cut_feed: 2 m/min}": "pierce_time 0.5 s stays as it is for 6 mm",
    "material: {thickness: 12, kerf: 2}\nmachine: {cut_feed: 2 m/min, pierce_time: 1}": None,
    "material: {thickness: 6 mm}": None,
    "material: {kerf: 1.4}": None,
}


@pytest.mark.parametrize("text", KEPT)
def test_another_thickness_names_the_values_that_stay(text: str, tmp_path: Path) -> None:
    notes = profile(tmp_path, f"based_on: plasma-carbon-steel\n{text}").time_and_price_notes()
    assert [KEPT[text] in note for note in notes if KEPT[text]] == [True] * (KEPT[text] is not None)


def test_another_thickness_that_one_nest_is_given_names_them_too() -> None:
    thick = with_settings(load_profile(), [read_setting("material.thickness=20 mm")])
    assert thick.time_and_price_notes()[0].startswith("material.thickness is 20 mm, and kerf 1.5 mm, cut_feed 2500")
    timed = [
        read_setting(f"{key}={value}") for key, value in (("material.kerf", "3 mm"), ("machine.cut_feed", "1 m/min"))
    ]
    assert "pierce_time 0.5 s stays" in with_settings(thick, timed).time_and_price_notes()[0]
    assert not with_settings(thick, [read_setting("material.thickness=6 mm")]).time_and_price_notes()


def test_a_chart_gives_what_its_thickness_needs(tmp_path: Path) -> None:
    (tmp_path / "shop.csv").write_text(
        "material,thickness [mm],kerf [mm],feed [mm/min],pierce_delay [s]\nS235,6,1.5,2500,0.5\nS235,12,2.2,1400,1.1\n",
        encoding="utf-8",
    )
    charted = profile(tmp_path, "based_on: plasma-carbon-steel\nmaterial: {thickness: 12, chart: shop.csv}")
    assert (charted.material.kerf_mm, charted.time_and_price_notes()) == (2.2, ())


LAWS = {
    "{unit: m/s, pieces: [{up_to: 70, power: [1, 500]}, {polynomial: [0.1]}]}": "the feed is no number any more",
    "{unit: m/s, pieces: [{up_to: 9, polynomial: [1, 1e9, 1e9, 1e9]}, {polynomial: [0.1]}]}": "is 8.19e+14 mm/s",
    "{unit: m/s, pieces: [{power: [1, -500]}]}": "the feed is 0 mm/s for some program of up to 100000 blocks",
    "{unit: m/s, pieces: [{power: [1e9, -1e-9]}]}": "the feed is 1e+12 mm/s for some",
    "{points: [[1, 1000 m/s]]}": "6e+07 mm/min is not likely",
    "{points: [[1, 90000 m/min]]}": "did you mean 90000 mm/min?",
}


@pytest.mark.parametrize("text", LAWS)
def test_a_law_whose_feeds_no_machine_has_is_refused(text: str, tmp_path: Path) -> None:
    assert LAWS[text] in told(tmp_path, f"time: {{model: blocks, feed_by_blocks: {text}}}")


def test_a_grid_that_makes_more_pieces_than_anybody_carries_off_is_refused() -> None:
    plate = nest(6000, 2000, part("A", rect(50, 50, 300, 300)))
    with pytest.raises(InputError, match=f"into 30,000 pieces, expected {MOST_PIECES:,} at the most") as caught:
        with_scrap(plate, 1.5, 20.0, None)
    assert "give a larger grid" in str(caught.value)
