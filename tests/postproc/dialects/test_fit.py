"""A profile and its dialect belong together: a laser is not given a plasma program."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.dialects import dialect_names, fitting_dialect, load_dialect
from kerfwise.postproc.dialects.load import new_dialect_text
from kerfwise.postproc.nc.program import write_program
from kerfwise.rules.profile.load import load_profile, shipped_profiles
from kerfwise.rules.profile.plant_sections import PROCESSES
from kerfwise.tests.postproc.plans import good_cuts, plan_of, plate, profile


def test_every_shipped_profile_has_a_dialect_that_fits() -> None:
    fits = {name: fitting_dialect(load_profile(name)).name for name in shipped_profiles()}
    assert fits["plasma-carbon-steel"] == "linuxcnc-qtplasmac"
    assert {name for name, dialect in fits.items() if dialect == "linuxcnc-qtplasmac"} == {"plasma-carbon-steel"}
    assert {load_profile(name).machine.process for name in fits} == set(PROCESSES)


@pytest.mark.parametrize("name", dialect_names())
def test_every_dialect_says_what_it_assumes_of_each_of_its_processes_or_is_for_one_alone(name: str) -> None:
    dialect = load_dialect(name)
    assert len(dialect.processes) == 1 or set(dialect.processes) <= set(dialect.assumes)


def test_a_mismatch_is_refused_with_its_place(tmp_path: Path) -> None:
    shop = tmp_path / "shop.yaml"
    shop.write_text("based_on: laser-wood\nmachine:\n  cut_feed: 500 mm/min\n  dialect: linuxcnc-qtplasmac\n")
    with pytest.raises(InputError) as caught:
        fitting_dialect(load_profile(shop))
    assert str(caught.value) == (
        f"{shop}:4:12: machine.dialect: 'linuxcnc-qtplasmac' is for plasma, the machine's process is laser: its "
        "programs would not run, or would run wrong. Say dialect: fanuc or grbl or hpgl or linuxcnc or "
        "marlin, correct machine.process, or say accept_dialect: true to have it all the same"
    )
    shop.write_text("machine: {process: water-jet}\n")
    with pytest.raises(InputError, match=r":1:20: machine.dialect: 'linuxcnc-qtplasmac' is for plasma"):
        fitting_dialect(load_profile(shop))
    shop.write_text("machine: {process: water-jet, accept_dialect: true}\n")
    assert fitting_dialect(load_profile(shop)).name == "linuxcnc-qtplasmac"


def test_no_program_is_written_for_another_process() -> None:
    plant = profile(machine=replace(profile().machine, process="laser"))
    sheet = plate()
    with pytest.raises(InputError, match="is for plasma, the machine's process is laser"):
        write_program(plan_of(sheet, good_cuts(sheet), plant), sheet, plant)


def test_a_control_that_waits_at_every_start_has_no_edge_starts(tmp_path: Path) -> None:
    shop = tmp_path / "shop.yaml"
    shop.write_text("leads: {edge_start: true}\n")
    with pytest.raises(InputError, match=r"shop.yaml:1:21: leads.edge_start: a control that holds the pierce delay"):
        fitting_dialect(load_profile(shop))
    shop.write_text("leads: {edge_start: true}\nmachine: {pierce_dwell: program}\n")
    assert fitting_dialect(load_profile(shop)).name == "linuxcnc-qtplasmac"


def test_a_mismatch_that_a_base_brings_is_placed_there(tmp_path: Path) -> None:
    (tmp_path / "plant.yaml").write_text("machine:\n  process: laser\n")
    (tmp_path / "near.yaml").write_text("based_on: plant.yaml\nname: near\n")
    with pytest.raises(InputError, match=r"plant\.yaml:2:12: machine\.dialect: 'linuxcnc-qtplasmac' is for plasma"):
        fitting_dialect(load_profile(tmp_path / "near.yaml"))


@pytest.mark.parametrize(
    ("name", "more", "words"),
    [
        ("fanuc", "", "torch_on: M3; torch_off: M5"),
        ("sinumerik", "", "torch_on: M3; torch_off: M5"),
        ("hpgl", "pierce_dwell: program, ", "dwell: !DW{milliseconds};"),
    ],
)
def test_what_a_builder_chooses_is_stated_by_the_plant(name: str, more: str, words: str, tmp_path: Path) -> None:
    base = "plasma-carbon-steel" if name == "sinumerik" else "laser-st10kp-2mm"
    plant, own = tmp_path / "plant.yaml", tmp_path / "mine.yaml"
    text = f"based_on: {base}\nmachine: {{{more}dialect: NAME}}\n"
    plant.write_text(text.replace("NAME", name), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        fitting_dialect(load_profile(plant))
    assert f"can only guess ({words}): write a copy" in str(caught.value)
    assert str(caught.value).startswith(f"{plant}:2:")
    plant.write_text(text.replace("NAME", f"{name}, accept_dialect: true"), encoding="utf-8")
    assert fitting_dialect(load_profile(plant)).name == name
    own.write_text(re.sub(r"builders_choice: .*\n", "", new_dialect_text("mine", name)), encoding="utf-8")
    plant.write_text(text.replace("NAME", "mine.yaml"), encoding="utf-8")
    assert fitting_dialect(load_profile(plant)).name == "mine"
