"""Profiles: what is read, what is shown, what is shipped, and what the other stages are given."""

from __future__ import annotations

import hashlib
import re
from dataclasses import replace
from pathlib import Path

import pytest

from kerfwise.encoder.candidates.candidate import LeadOptions
from kerfwise.encoder.facts import FactOptions
from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.encoder.small_holes import HoleLimits
from kerfwise.rules.catalogue.zone_order import ZoneOrderOptions
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.option import options_of
from kerfwise.rules.profile.load import DEFAULT, load_profile, shipped_profiles
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.profile_yaml import profile_yaml
from kerfwise.rules.profile.sections import Machine, Material, RuleSetting
from kerfwise.rules.registry import RULES

PLANT = """\
name: my plant
machine:
  home: [10, -5]
  cut_feed: 40 mm/s
  head: down
material: {name: AMg3M, kerf: 0.2 mm}
rules:
  hull-before: off
  level-ahead: {strength: soft, weight: 250}
  part-contiguous: soft
  zone-order: {zone_contours: 6}
  pierce: {clearance: 0.5}
locks:
  - {contour: P1.outer, before: P2.outer}
  - {contour: P2.hole1, entry: [3, 4], direction: ccw, position: 7}
  - {part: P3, zone: 2}
own_rules:
  - {name: heavy last, select: {area_mm2: "> 1000"}, last: true}
  - {name: apart, apart: {cuts: 2, within: 30 mm, from: {not: {id: "P*"}}}, strength: soft}
"""


def write(tmp_path: Path, text: str, name: str = "plant.yaml") -> Path:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


def test_values_are_read(tmp_path: Path) -> None:
    profile = load_profile(write(tmp_path, PLANT))
    assert profile.name == "my plant"
    assert profile.machine == replace(Machine(), home=(10.0, -5.0), cut_feed_mm_s=40.0, head="down")
    assert profile.material == Material("AMg3M", 6.0, 0.2)
    assert profile.rules["hull-before"].strength == "off"
    assert (profile.rules["level-ahead"].strength, profile.rules["level-ahead"].weight) == ("soft", 250.0)
    assert (profile.rules["part-contiguous"].strength, profile.rules["part-contiguous"].weight) == ("soft", 1000.0)
    assert profile.rules["zone-order"] == RuleSetting("hard", None, ZoneOrderOptions(6, 1.25))
    assert profile.locks == (
        Lock(contour="P1.outer", before="P2.outer"),
        Lock(contour="P2.hole1", entry=(3.0, 4.0), direction="ccw", position=7),
        Lock(part="P3", zone=2),
    )
    assert [str(lock.place).split("/")[-1] for lock in profile.locks] == [f"plant.yaml:{k}:5" for k in (14, 15, 16)]
    assert [(rule.id, rule.strength, rule.weight) for rule in profile.own_rules] == [
        ("own:heavy last", "hard", None),
        ("own:apart", "soft", 1000.0),
    ]


def test_sha256_is_that_of_the_file(tmp_path: Path) -> None:
    path = write(tmp_path, PLANT)
    assert load_profile(path).sha256 == hashlib.sha256(path.read_bytes()).hexdigest()


def test_empty_file_is_all_defaults(tmp_path: Path) -> None:
    loaded = load_profile(write(tmp_path, "", "bare.yaml"))
    assert all(loaded.rules[name].strength == "off" for name in loaded.further_rules), "packages' rules are off"
    of_the_catalogue = {name: setting for name, setting in loaded.rules.items() if name in RULES}
    assert replace(loaded, rules=of_the_catalogue, further_rules={}) == Profile("bare")


@pytest.mark.slow
@pytest.mark.parametrize("given", [*shipped_profiles(), "own"])
def test_what_show_prints_loads_as_the_same_profile(given: str, tmp_path: Path) -> None:
    profile = load_profile(write(tmp_path, PLANT) if given == "own" else given)
    again = load_profile(write(tmp_path, profile_yaml(profile), "shown.yaml"))
    assert again == profile
    assert profile_yaml(again) == profile_yaml(profile)


def test_comparison_of_profiles_can_fail(tmp_path: Path) -> None:
    profile = load_profile(write(tmp_path, PLANT))
    other = load_profile(
        write(tmp_path, profile_yaml(profile).replace("zone_contours: 6", "zone_contours: 7"), "other.yaml")
    )
    assert other != profile


def test_show_has_every_key_with_a_comment() -> None:
    lines = profile_yaml(Profile("plant")).splitlines()
    values = [line for line in lines if re.match(r"\s+[a-z_]+: ", line)]
    assert all("  # " in line for line in values)
    for rule in RULES.values():
        at = lines.index(f"  {rule.id}:")
        assert lines[at - 1] == f"  # {rule.sentence}"
        first = at + (3 if rule.default == "soft" else 2)
        keys = [line.split(":")[0].strip() for line in lines[first : first + len(options_of(rule.Options))]]
        assert keys == [option.key for option in options_of(rule.Options)]


def test_show_of_a_lock_and_a_weight(tmp_path: Path) -> None:
    shown = profile_yaml(load_profile(write(tmp_path, PLANT)))
    assert "  - {contour: P2.hole1, position: 7, entry: [3.0, 4.0], direction: ccw}\n" in shown
    assert "    weight: 250 mm                            # cost of breaking it once, in idle travel\n" in shown


def test_based_on_a_shipped_profile(tmp_path: Path) -> None:
    text = "based_on: water-jet\nmaterial: {kerf: 0.8}\nrules: {zone-order: hard}\n"
    profile = load_profile(write(tmp_path, text))
    base = load_profile("water-jet")
    assert profile.name == "plant"
    assert profile.machine == base.machine
    assert profile.material == replace(base.material, kerf_mm=0.8)
    assert {k for k, s in profile.rules.items() if s != base.rules[k]} == {"zone-order"}


def test_based_on_a_file_beside_it(tmp_path: Path) -> None:
    (tmp_path / "lines").mkdir()
    write(tmp_path, PLANT, "lines/base.yaml")
    profile = load_profile(write(tmp_path, "based_on: base.yaml\nlocks: []\n", "lines/child.yaml"))
    assert (profile.name, profile.machine.home, profile.locks) == ("child", (10.0, -5.0), ())


def test_soft_base_made_hard_loses_its_weight(tmp_path: Path) -> None:
    write(tmp_path, PLANT, "base.yaml")
    profile = load_profile(write(tmp_path, "based_on: base.yaml\nrules: {level-ahead: hard}\n"))
    assert profile.rules["level-ahead"].weight is None


def test_default_is_the_plasma_profile() -> None:
    assert load_profile().name == DEFAULT == "plasma-carbon-steel"


@pytest.mark.parametrize("name", shipped_profiles())
def test_shipped_profile_leaves_room_for_small_gaps_and_holes(name: str) -> None:
    """A gap of 6 mm and a hole of 9 mm have room for a pierce and the shortest lead to it."""
    profile = load_profile(name)
    leads = profile.lead_options()
    assert profile.name == name
    for room_mm in (6.0 / 2, 9.0 / 2):
        farthest_mm = min(6.0 - leads.pierce_clearance_mm, room_mm) - leads.kerf_mm / 2
        assert leads.pierce_clearance_mm <= room_mm
        assert leads.lead_in_min_mm <= farthest_mm


def test_shipped_profiles_by_name() -> None:
    assert list(shipped_profiles()) == [
        "laser-amg3m-1mm",
        "laser-st10kp-2mm",
        "laser-wood",
        "oxyfuel-thick-plate",
        "plasma-carbon-steel",
        "water-jet",
    ]


def test_bare_profile_gives_the_defaults_of_the_encoder() -> None:
    """The defaults are declared twice, there for the library and here for a plant: they must not drift apart."""
    profile = Profile("plant")
    assert profile.lead_options() == replace(
        LeadOptions(), pierce_clearance_mm=1.5, holes=HoleLimits(least_mm=6.0, room_mm=3.0)
    )
    assert replace(profile.fact_options(), columns=()) == FactOptions(), "rules declare columns of their own"
    assert profile.read_options() == ReadOptions(kerf_mm=profile.material.kerf_mm)


def test_options_of_the_encoder_follow_the_rules(tmp_path: Path) -> None:
    more = "  hull-before: off\n  cut-direction: {outer: cw}\n  start-side: {side: top}\n"
    profile = load_profile(write(tmp_path, PLANT.replace("  hull-before: off\n", more)))
    leads, facts = profile.lead_options(), profile.fact_options()
    both = dict.fromkeys(("hole", "mark", "slit", "scrap"), ("cw", "ccw"))
    assert leads.directions == {"outer": ("cw",), **both}
    assert leads.entry_points == {"P2.hole1": (3.0, 4.0)}
    assert (leads.pierce_clearance_mm, leads.kerf_mm) == (0.5, 0.2)
    assert facts.zone_respects == {"contains"}
    assert facts.zone_pairs == (("P1.outer", "P2.outer"),)
    assert facts.zone_fixed == (("P3", 2),)
    assert (facts.start_side, facts.zone_contours, facts.zone_heat_kj) == ("top", 6, None)


@pytest.mark.parametrize(("given", "budget_kj"), [("300 kJ", 300.0), ("300", 300.0), ("1.5e2kJ", 150.0), ("off", None)])
def test_a_zones_budget_of_heat(tmp_path: Path, given: str, budget_kj: float | None) -> None:
    profile = load_profile(
        write(tmp_path, f"heat: {{absorbed_power_w: 900}}\nrules: {{zone-order: {{zone_heat: {given}}}}}")
    )
    assert profile.fact_options().zone_heat_kj == budget_kj
    options = profile.settings()["zone-order"].options
    assert (options.zone_heat_kj, options.absorbed_power_w) == (budget_kj, 900.0)
    assert load_profile(write(tmp_path, profile_yaml(profile), "again.yaml")) == profile


def test_soft_directions_and_rules_that_are_off_leave_it_free(tmp_path: Path) -> None:
    rules = "{cut-direction: {strength: soft, outer: cw}, pierce: off, start-side: {strength: off, side: top}}"
    profile = load_profile(write(tmp_path, f"rules: {rules}"))
    assert profile.lead_options().directions["outer"] == ("cw", "ccw")
    assert profile.lead_options().pierce_clearance_mm == 0.0
    assert profile.fact_options().start_side == "auto"
    assert "pierce" not in profile.settings()


def test_rigidity_and_the_facts_share_their_thresholds(tmp_path: Path) -> None:
    rules = "{part-rigidity: {web: 30, tail_share: 0.3, head_share: 0.2}, start-side: {edge_band: 15}}"
    profile = load_profile(write(tmp_path, f"rules: {rules}"))
    facts = profile.fact_options()
    assert (facts.web_mm, facts.edge_band_mm, facts.head_share, facts.tail_share) == (30.0, 15.0, 0.2, 0.3)
    for rule in ("part-rigidity", "no-islands"):
        options = profile.settings()[rule].options
        assert (options.web_mm, options.edge_band_mm) == (30.0, 15.0)


def test_strips_know_the_web_and_the_sheet(tmp_path: Path) -> None:
    text = "material: {thickness: 25}\nrules: {no-narrow-strips: soft, part-rigidity: {web: 30}}"
    options = load_profile(write(tmp_path, text)).settings()["no-narrow-strips"].options
    assert (options.web_mm, options.thickness_mm, options.narrow_mm) == (30.0, 25.0, 75.0)


@pytest.mark.parametrize(("head", "strength"), [("up", "soft"), ("down", "hard")])
def test_a_head_that_stays_down_must_not_travel_over_tips(head: str, strength: str, tmp_path: Path) -> None:
    profile = load_profile(write(tmp_path, f"machine: {{head: {head}}}\nrules: {{no-tip-travel: soft}}"))
    setting = profile.settings()["no-tip-travel"]
    assert (setting.strength, setting.weight) == (strength, None if strength == "hard" else 50.0)
    off = load_profile(write(tmp_path, f"machine: {{head: {head}}}\nrules: {{no-tip-travel: off}}", "off.yaml"))
    assert "no-tip-travel" not in off.settings()


def test_locks_reach_their_rule(tmp_path: Path) -> None:
    profile = load_profile(write(tmp_path, PLANT))
    assert profile.settings()["locks"].options.locks == profile.locks
