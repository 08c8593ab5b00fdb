"""Every mistake in a profile is answered with its place, what was expected, and the nearest valid name."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise import InputError, load_profile


def error_of(tmp_path: Path, text: str) -> list[str]:
    path = tmp_path / "plant.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        load_profile(path)
    return str(caught.value).replace(f"{tmp_path}/", "").splitlines()


KEYS = (
    "based_on, corners, cuts, distortion, drawing, heat, leads, locks, machine, material, models, name, nesting, "
    "objective, own_rules, prices, python, rules, small_holes, time"
)
OF_MATERIAL = (
    "amps, chart, chart_units, cut_height, gas, gas_flow, interpolate, kerf, mark_power, name, pierce_height, "
    "pierce_power, power, process, row, thickness, volts"
)
LENGTH = "a length of at least 0 such as 1.5 or '1.5 mm' (also cm, m, in)"
SHIPPED = "laser-amg3m-1mm, laser-st10kp-2mm, laser-wood, oxyfuel-thick-plate, plasma-carbon-steel, water-jet"
OF_CONTOUR = "what can be locked of a contour is before, position, entry, direction, linked or tab"
OF_PART = "what can be locked of a part is its zone: {part: ID, zone: N}"
OF_WHAT = "a lock is about one contour or one part: give either contour or part, with an id"
TOGETHER = (
    "marks cannot stay with their part while marks-first puts all marks of the sheet first; say marks: apart, or "
    "marks-first: {scope: part}"
)
WITHIN = "is within the kerf; a pierce lies further from every contour than half the kerf, 2 mm (Petunin 2009)"
ENERGY = "an energy over 0 such as 300 or '300 kJ', or the word 'off'"
ZONE_KEYS = "square_ratio, strength, weight, zone_contours, zone_heat"

MISTAKES = {
    "machin: {}": f"1:1: unknown key 'machin': did you mean 'machine'? (valid: {KEYS})",
    "- 1": "1:1: profile: expected a mapping (key: value), got a list of 1",
    "name: ''": "1:7: name: expected a text, got ''",
    "machine: fast": "1:10: machine: expected a mapping (key: value), got 'fast'",
    "machine: {dialect: trumpf}": (
        "1:20: machine.dialect: expected one of burny, eia, essi, fanuc, grbl, hpgl, linuxcnc, linuxcnc-qtplasmac, "
        "mach, marlin, sinumerik, or a dialect file of your own that ends in .yaml, got 'trumpf'"
    ),
    "machine: {travel_x: [0, 3 m], home: [-5, 0]}": (
        "1:37: machine.home: -5 mm lies outside machine.travel_x, 0 to 3000 mm"
    ),
    "machine: {travel_y: [1500, 0]}": (
        "1:21: machine.travel_y: expected [least, most] in mm, the least first, or 'unknown', got 1500 and 0"
    ),
    "based_on: plasma-carbon-steel\nleads: {lead: none}": (
        "2:15: leads.lead: without a lead the torch pierces on its path, 0.75 mm from the contour, and rules.pierce "
        "asks for more: give a lead (line, arc), or switch that off: rules: {pierce: off}"
    ),
    "leads: {edge_start: true}\nmachine: {process: oxyfuel}": (
        "1:21: leads.edge_start: a flame has to heat the sheet's edge before it cuts: give machine.edge_preheat, such "
        "as 7 s"
    ),
    "material:\n  kerv: 1": f"2:3: material: unknown key 'kerv': did you mean 'kerf'? (valid: {OF_MATERIAL})",
    "material:\n  kerf: wide": f"2:9: material.kerf: expected {LENGTH}, got 'wide'",
    "time: {acceleration: 2 m/s}": (
        "1:22: time.acceleration: unknown unit 'm/s' in '2 m/s': expected an acceleration over 0 such as 1.5 or "
        "'1.5 m/s2' (also mm/s2, g)"
    ),
    "time: {modle: blocks}": (
        "1:8: time: unknown key 'modle': did you mean 'model'? (valid: acceleration, corner_deviation, "
        "feed_by_blocks, model)"
    ),
    "time: {model: block}": (
        "1:15: time.model: expected one of constant, blocks, acceleration, got 'block': did you mean 'blocks'?"
    ),
    "prices: {gas_hour: -1}": "1:20: prices.gas_hour: expected a number of at least 0, got '-1'",
    "material: {kerf: 1,5}": (
        f"1:20: material: unknown key '5' (valid: {OF_MATERIAL}); decimals are written with a point"
    ),
    "material: {kerf: 1,5 mm}": (
        f"1:20: material: unknown key '5 mm' (valid: {OF_MATERIAL}); decimals are written with a point"
    ),
    "material:\n  kerf: 1,5 mm": (
        f"2:9: material.kerf: expected {LENGTH}, got '1,5 mm': write decimals with a point, 1.5 mm"
    ),
    "material:\n\tkerf: 1": "2:1: not YAML: a tab; YAML is indented with spaces",
    "based_on: lasr": f"1:11: based_on: unknown profile 'lasr': did you mean 'laser-amg3m-1mm'? (valid: {SHIPPED})",
    "rules: [hard]": "1:8: rules: expected a mapping (key: value), got a list of 1",
    "rules: {hull-before: strong}": "1:22: rules.hull-before: expected one of hard, soft, off, got 'strong'",
    "rules:\n  zone-order: {zone_contour: 3}": (
        f"2:16: rules.zone-order: unknown key 'zone_contour': did you mean 'zone_contours'? (valid: {ZONE_KEYS})"
    ),
    "rules:\n  zone-order:\n    zone_contours: 0": (
        "3:20: rules.zone-order.zone_contours: expected a whole number of at least 1, or the word 'auto', got '0'"
    ),
    "rules:\n  zone-order: {zone_heat: 0}": (f"2:27: rules.zone-order.zone_heat: expected {ENERGY}, got '0'"),
    "rules:\n  zone-order: {zone_heat: 3 kW}": (
        f"2:27: rules.zone-order.zone_heat: unknown unit 'kW' in '3 kW': expected {ENERGY}"
    ),
    "rules:\n  level-ahead: {strength: hard, weight: 5}": (
        "2:41: rules.level-ahead.weight: only a soft rule has a weight, this one is hard"
    ),
    "rules: {locks: off}": "1:16: rules.locks: expected one of hard, got 'off'",
    "rules: {locks: {locks: []}}": ("1:17: rules.locks: there is no key 'locks' here, it belongs under locks: …"),
    "locks: {contour: P1.outer}": "1:8: locks: expected a list, got a mapping",
    "locks:\n  - first": "2:5: locks[1]: expected a mapping (key: value), got 'first'",
    "locks:\n  - {contour: P1.outer}": f"2:5: locks[1]: {OF_CONTOUR}",
    "locks:\n  - {contour: B, zone: 1}": f"2:5: locks[1]: {OF_CONTOUR}",
    "locks:\n  - {contour: A, part: B, zone: 1}": f"2:5: locks[1]: {OF_WHAT}",
    "locks:\n  - {before: B}": f"2:5: locks[1]: {OF_WHAT}",
    "locks:\n  - {part: B, before: C}": f"2:5: locks[1]: {OF_PART}",
    "locks:\n  - {contour: B, before: B}": "2:5: locks[1]: B cannot be cut before itself",
    "locks:\n  - {contour: B, position: 0}": (
        "2:28: locks[1].position: expected first, last or a position counted from 1, got '0'"
    ),
    "own_rules:\n  - !odd x": "2:5: own_rules[1]: expected a mapping (key: value), got 'x'",
    "own_rules: heavy": "1:12: own_rules: expected a list, got 'heavy'",
    "based_on: water": f"1:11: based_on: unknown profile 'water': did you mean 'water-jet'? (valid: {SHIPPED})",
    "based_on: plant.yaml": "1:11: based_on: it goes in a circle: plant.yaml → plant.yaml",
    "leads: {lead_in: 2, lead_in_min: 3}": "1:34: leads.lead_in_min: 3 mm is more than lead_in, 2 mm",
    "material: {kerf: 4}": f"1:1: rules.pierce.clearance: 1.5 mm {WITHIN}",
    "heat: {material: carbon-stel}": (
        "1:18: heat.material: expected one of carbon-steel, stainless-steel, aluminium-amg3m, plywood, got "
        "'carbon-stel': did you mean 'carbon-steel'?"
    ),
    "heat: {limit_c: 15}": "1:17: heat.limit_c: 15 °C is not above ambient_c, 20 °C: everything is too hot",
    "rules: {t-max: {strength: hard, limit: 15}}": (
        "1:40: rules.t-max.limit: 15 °C is not above heat.ambient_c, 20 °C: no metal is ever so cool"
    ),
    "heat:\n  logical_conduction: 0.2": (
        "2:23: heat.logical_conduction: 0.2 for each of 8 neighbours is more than a point has; the scheme is stable up "
        "to 0.125"
    ),
    "rules: {part-contiguous: {marks: together}}": f"1:34: rules.part-contiguous.marks: {TOGETHER}",
}


@pytest.mark.parametrize("text", MISTAKES)
def test_mistake(tmp_path: Path, text: str) -> None:
    assert error_of(tmp_path, text)[0] == f"plant.yaml:{MISTAKES[text]}"


def test_unknown_rule_lists_all_of_them(tmp_path: Path) -> None:
    (line,) = error_of(tmp_path, "rules:\n  level_ahed: off")
    assert line.startswith(
        "plant.yaml:2:3: rules: unknown rule 'level_ahed': did you mean 'level-ahead'? (valid: cut-dir"
    )


def test_all_mistakes_are_reported_at_once(tmp_path: Path) -> None:
    lines = error_of(tmp_path, "kerf: 1\nmachine:\n  cut_feed: quick\n  home: 3\nrules: {pierce: {clearance: -1}}\n")
    assert [line.split(" ")[0] for line in lines[:1]] == ["plant.yaml:1:1:"]
    assert [line.split(" ")[3] for line in lines[1:]] == ["plant.yaml:3:13:", "plant.yaml:4:9:", "plant.yaml:5:29:"]


def test_mistake_in_the_base_is_reported_there(tmp_path: Path) -> None:
    (tmp_path / "base.yaml").write_text("material: {kerf: x}", encoding="utf-8")
    assert error_of(tmp_path, "based_on: base.yaml")[0].startswith("base.yaml:1:18: material.kerf: expected a length")


def test_marks_stay_with_their_part_when_the_scope_allows(tmp_path: Path) -> None:
    path = tmp_path / "plant.yaml"
    path.write_text("rules: {part-contiguous: {marks: together}, marks-first: {scope: part}}", encoding="utf-8")
    assert load_profile(path).rules["part-contiguous"].options.marks == "together"


def test_unknown_name_lists_the_shipped_ones() -> None:
    with pytest.raises(InputError) as caught:
        load_profile("plasma")
    assert str(caught.value) == f"unknown profile 'plasma': did you mean 'plasma-carbon-steel'? (valid: {SHIPPED})"


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.yaml: cannot read the profile: No such file or directory"):
        load_profile(tmp_path / "none.yaml")


def test_not_text(tmp_path: Path) -> None:
    path = tmp_path / "plant.yaml"
    path.write_bytes(b"name: \xff")
    with pytest.raises(InputError, match=r"plant\.yaml: not a profile: the file is not UTF-8 text"):
        load_profile(path)


def test_a_file_named_without_its_ending(tmp_path: Path) -> None:
    (tmp_path / "shop.yaml").write_text("name: shop\n")
    (said,) = error_of(tmp_path, "based_on: shop")
    assert said.endswith(f"(valid: {SHIPPED}); there is a file shop.yaml: give its ending too")


def test_a_base_that_cannot_be_read_is_told_where_it_is_named(tmp_path: Path) -> None:
    for base, said in (
        ("nowhere.yaml", "cannot read the profile: No such file"),
        ("n" * 300, "unknown profile"),
        ("n" * 300 + ".yaml", "cannot read the profile: File name too long"),
        ("/", "unknown profile"),
        ("near.yaml", "it goes in a circle"),
    ):
        (tmp_path / "near.yaml").write_text("based_on: plant.yaml")
        place = "near.yaml" if base == "near.yaml" else "plant.yaml"
        (line, *_) = error_of(tmp_path, f"based_on: {base}")
        assert line.startswith(f"{place}:1:11: based_on: "), line
        assert said in line


def test_a_chain_without_end(tmp_path: Path) -> None:
    for k in range(40):
        (tmp_path / f"p{k}.yaml").write_text(f"based_on: p{k + 1}.yaml")
    (line, *_) = error_of(tmp_path, "based_on: p0.yaml")
    assert "more than 20 profiles are based on each other in a row" in line
    assert line.startswith("p18.yaml:1:11: ")


def test_a_file_that_is_nearly_called_so_is_named(tmp_path: Path) -> None:
    (tmp_path / "laser.yaml").write_text("name: laser\n")
    with pytest.raises(InputError, match=r"No such file or directory; did you mean 'laser\.yaml'\?"):
        load_profile(tmp_path / "lser.yaml")
    with pytest.raises(InputError, match=r"No such file or directory$"):
        load_profile(tmp_path / "gone" / "lser.yaml")


def test_mistakes_of_all_files_are_said_at_once(tmp_path: Path) -> None:
    """Of the profile, of the one that it is based on, and of the rules' files."""
    (tmp_path / "base.yaml").write_text("material: {kerff: 2}\nleads: {led: line}\n")
    (tmp_path / "plant.yaml").write_text(
        "based_on: base.yaml\nmachine: {cut_fed: 1}\npython: [no.py]\nmodels: [no.mzn]\nrules: {of base: hard}\n"
    )
    with pytest.raises(InputError) as caught:
        load_profile(tmp_path / "plant.yaml")
    lines = str(caught.value).splitlines()
    assert [line.split(": ")[0].split("/")[-1] for line in lines] == [
        "plant.yaml:2:11", "plant.yaml:4:10", "base.yaml:1:12", "base.yaml:2:9", "plant.yaml:3:10",
    ]  # fmt: skip
