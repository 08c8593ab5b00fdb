"""`profile check` refuses what `solve` would refuse without a nest, and tells of what has no effect."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.apps.authoring.profile_check import WITHOUT_EFFECT, checked, notes
from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.option import Members, options_of
from kerfwise.rules.profile.load import load_profile, shipped_profiles
from kerfwise.rules.profile.sections import SECTIONS
from kerfwise.tests.commands.run_cli import kerfwise


def plant(folder: Path, text: str) -> str:
    path = folder / "plant.yaml"
    path.write_text(text, encoding="utf-8")
    return str(path)


TWO = "machine: {dialect: eia, torches: {count: 2, spacing: 300 mm}}\n"
REFUSED = {
    TWO + "cuts: {links: {longest: 20 mm}}": "links are not planned together with several torches",
    TWO + "cuts: {links: {}}": "links are not planned together with several torches",
    TWO.replace("eia", "eia, pierce_dwell: program")
    + "cuts: {pierce_pass: zone}": "a pierce pass is not planned together with several torches",
    TWO + "objective: {heat: 1}": "the price of heat is simulated for one torch",
    "cuts: {common: {}}": "machine.kerf_start: a control that holds the pierce delay itself",
    "based_on: plasma-carbon-steel\nmachine: {kerf_start: false}\ncuts: {common: {}}": "gets the bad side of the kerf",
    "machine: {dialect: grbl}": "'grbl' is for laser, the machine's process is plasma",
}


@pytest.mark.parametrize("text", REFUSED)
def test_what_no_nest_could_be_planned_with_is_refused(text: str, tmp_path: Path) -> None:
    name = plant(tmp_path, text)
    with pytest.raises(InputError, match=REFUSED[text]) as caught:
        checked(name)
    assert caught.value.file == name
    ended = kerfwise("profile", "check", name)
    assert (ended.code, ended.out) == (2, "")


@pytest.mark.minizinc
@pytest.mark.slow
def test_model_files_are_compiled(tmp_path: Path) -> None:
    file = tmp_path / "late.mzn"
    file.write_text("% late.\narray[int] of var bool: late_holds = [position[i] > nothing | i in CONTOUR];\n")
    name = plant(tmp_path, "models: [late.mzn]\nrules: {late: hard}")
    with pytest.raises(InputError) as caught:
        checked(name)
    assert caught.value.file is not None
    assert Path(caught.value.file).name == "late.mzn"
    assert "nothing" in str(caught.value)
    file.write_text("% late.\narray[int] of var bool: late_holds = [position[i] > 0 | i in CONTOUR];\n")
    assert checked(name).name == "plant"


DEAD = {
    "machine: {torches: {spacing: 500}}": "machine.torches.spacing has no effect: there is one torch",
    "machine: {edge_preheat: 3 s}": "machine.edge_preheat has no effect: no cut begins at an edge",
    "leads: {lead_out_length: 3}": "leads.lead_out_length has no effect: there is no lead-out",
    "corners: {corner_angle: 60}": "corners.corner_angle has no effect: corners are cut at the full feed",
    "cuts: {common: {shortest: off, gap_tolerance: 0.04}}": "cuts.common.gap_tolerance has no effect: no edges are cut",
    "cuts: {links: {longest: 20}}\nrules: {t-max: {strength: hard, dwells: true}}": "cuts.links.longest has no effect",
    "small_holes: {spot_size: 3 mm}": "small_holes.spot_size has no effect: no hole is spotted",
    "time: {acceleration: 2}": "time.acceleration has no effect: it is for time.model: acceleration",
    "heat: {logical_step: 2}": "heat.logical_step has no effect: it is for heat.model: logical",
    "prices: {machine_hour: 80, torch_kw: 9}": "prices.torch_kw has no effect: power has no price",
    "prices: {machine_hour: 80, consumables: {pierces: 900}}": "prices.consumables.pierces has no effect",
    "prices: {machine_hour: 80, remnant_share: 0.5}": "prices.remnant_share has no effect: the sheet has no price",
    "rules: {pierce: {strength: off, clearance: 2 mm}}": "rules.pierce is off, and without it its options (clearance)",
    "rules: {hold-small-parts: {width: 0.5}}": "rules.hold-small-parts is off, and without it its options (width)",
    "cuts: {links: {}}": "cuts.links is on by its defaults (longest: 30 mm)",
    "cuts: {scrap: {}}": "cuts.scrap is on by its defaults (grid: 500 mm, remnant: off)",
}


@pytest.mark.parametrize("text", DEAD)
def test_what_has_no_effect_is_told_with_its_place(text: str, tmp_path: Path) -> None:
    name = plant(tmp_path, text)
    found = list(notes(checked(name)))
    assert [DEAD[text] in note for note in found] == [True]
    assert found[0].startswith(f"{name}:")


@pytest.mark.parametrize("name", shipped_profiles())
def test_nothing_of_shipped_profiles_is_told(name: str) -> None:
    assert list(notes(load_profile(name))) == []


def test_options_without_effect_are_keys_of_profiles() -> None:
    def keys(owner: object, before: str) -> set[str]:
        inner = {f"{before}.{o.key}": o.kind for o in options_of(owner)}
        groups = [keys(kind.owner, key) for key, kind in inner.items() if isinstance(kind, Members)]
        return set(inner).union(*groups)

    assert set(WITHOUT_EFFECT) <= set().union(*(keys(owner, name) for name, owner in SECTIONS.items()))
