"""The powers of a laser come from the profile or its chart, and the check reads them in the program."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.dialects import dialect_text, expect_words, fitting_dialect, load_dialect
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.tests.postproc.plans import good_cuts, plan_of, plate, profile


def plant(**material: object) -> Profile:
    of = profile()
    machine = dataclasses.replace(of.machine, process="laser", dialect="grbl", pierce_dwell=None)
    return dataclasses.replace(of, machine=machine, material=dataclasses.replace(of.material, **material))


def program(of: Profile) -> str:
    return write_program(plan_of(plate(), good_cuts(plate()), of), plate(), of)


def powers(text: str) -> set[str]:
    return set(re.findall(r"M[34] S\d+", text))


def told(text: str, of: Profile) -> list[str]:
    return [v.text for v in check_program(plate(), text, of).rule("program-state").violations]


def test_without_a_power_the_dialects_own_hold() -> None:
    assert powers(program(plant())) == {"M3 S1000", "M4 S1000", "M3 S200", "M4 S200"}
    assert told(program(plant()), plant()) == []


def test_the_profiles_powers() -> None:
    of = plant(power=60.0, pierce_power=80.0, mark_power=5.0)
    assert powers(program(of)) == {"M3 S800", "M4 S600", "M3 S50", "M4 S50"}
    assert "(SET POWER 60 PERCENT, PIERCE POWER 80 PERCENT, MARK POWER 5 PERCENT)" in program(of)
    assert "(ASSUMES A BEAM OF S50 MARKS AND DOES NOT CUT)" in program(of)
    assert check_program(plate(), program(of), of).ok


def test_little_power_cuts_where_the_profile_says_so() -> None:
    of = plant(power=20.0, mark_power=2.5)
    assert powers(program(of)) == {"M3 S200", "M4 S200", "M3 S25", "M4 S25"}
    assert check_program(plate(), program(of), of).ok


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("M4 S600", "M4 S700", "it cuts with S700, the profile says 60 %, S600"),
        ("M3 S800", "M3 S600", "it pierces with S600, the profile says 80 %, S800"),
        ("M4 S50\n", "M4 S60\n", "it marks with S60, the profile says 5 %, S50"),
    ],
)
def test_another_power_is_found(old: str, new: str, said: str) -> None:
    of = plant(power=60.0, pierce_power=80.0, mark_power=5.0)
    text = program(of)
    assert old in text
    assert any(said in one for one in told(text.replace(old, new), of))


def test_a_mark_that_might_cut_is_refused() -> None:
    of = plant(power=30.0)
    with pytest.raises(InputError, match=r"material\.mark_power: S200 is more than half of S300, which cuts"):
        expect_words(plate(), of, load_dialect("grbl"))


def test_a_dialect_with_s_words_of_its_own_is_not_given_a_power(tmp_path: Path) -> None:
    text = dialect_text("grbl").replace("{power}", "1000").replace("{pierce_power}", "1000")
    text = text.replace("{mark_power}", "200").replace("powers: {cut: 1000, pierce: 1000, mark: 200, full: 1000}\n", "")
    (tmp_path / "old.yaml").write_text(text)
    shop = tmp_path / "shop.yaml"
    shop.write_text(f"based_on: laser-wood\nmachine: {{dialect: {tmp_path}/old.yaml}}\nmaterial:\n  power: 60 %\n")
    with pytest.raises(InputError, match=r"shop\.yaml:4:10: material\.power: the dialect 'grbl' has S words"):
        fitting_dialect(load_profile(shop))
    shop.write_text(f"based_on: laser-wood\nmachine: {{dialect: {tmp_path}/old.yaml}}\n")
    assert fitting_dialect(load_profile(shop)).powers is None


def test_holes_for_powers_need_the_powers(tmp_path: Path) -> None:
    text = dialect_text("grbl").replace("powers: {cut: 1000, pierce: 1000, mark: 200, full: 1000}\n", "")
    (tmp_path / "old.yaml").write_text(text)
    with pytest.raises(InputError, match=r"old\.yaml:\d+:3: torch_on: \{\w*power\} needs the key powers"):
        load_dialect(str(tmp_path / "old.yaml"))
