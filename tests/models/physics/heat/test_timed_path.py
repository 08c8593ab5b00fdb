"""What would take days or all memory is refused before it begins, with what to change."""

from __future__ import annotations

import importlib
from dataclasses import replace

import numpy as np
import pytest

from kerfwise import InputError
from kerfwise.jobs.heat_path import path_of_program
from kerfwise.models.physics.heat import simulate
from kerfwise.models.physics.heat.pacing import hot_spots
from kerfwise.models.physics.heat.timed_path import TimedPath, in_order, torch_on
from kerfwise.postproc.clock import read_program
from kerfwise.rule_kit import nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.plant_sections import Heat

PLATE = nest(400, 200, part("A", rect(20, 20, 160, 160)), part("B", rect(220, 20, 160, 160)))
LINE = np.array([[200.0, 10.0], [200.0, 190.0]])


def cuts(wait_s: float, cut_s: float) -> TimedPath:
    begin_s = 5.0 + wait_s
    return in_order(
        [
            torch_on("A.outer", LINE, 0.0, 5.0),
            torch_on("B.outer", LINE + np.array([5.0, 0.0]), begin_s, begin_s + cut_s),
        ],
        0.0,
    )


@pytest.mark.parametrize("model", ["physical", "logical"])
@pytest.mark.parametrize(
    ("path", "said"),
    [(cuts(1e8, 5.0), "B.outer, whose way and wait before it"), (cuts(5.0, 1e9), "B.outer, whose cut")],
)
def test_a_program_of_years_names_what_takes_them(model: str, path: TimedPath, said: str) -> None:
    heat = replace(Heat(), model=model)
    with pytest.raises(InputError, match=f"heat is simulated for up to 168 h; the longest is {said} takes"):
        simulate(PLATE, path, heat, 6.0)
    with pytest.raises(InputError, match=said):
        hot_spots(PLATE, path, heat, 6.0, 115.0)


def test_too_many_steps_name_the_profiles_key(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match=r"heat\.logical_step: 1e-09 s makes .* give about 1\.6e-06 s or more"):
        simulate(PLATE, cuts(1e4, 5.0), replace(Heat(), model="logical", logical_step_s=1e-9), 6.0)
    module = importlib.import_module("kerfwise.models.physics.heat.simulate")  # the package has a function of that name
    monkeypatch.setattr(module, "MOST_POINT_STEPS", 2e6)
    with pytest.raises(InputError, match=r"heat\.grid: 5 mm makes .* give about [\d.]+ mm or more"):
        simulate(PLATE, cuts(1e4, 5.0), Heat(), 6.0)


PROGRAM = """G21 G90 G17
G0 X300 Y110
M3 $0 S1
{held}F2500
G1 X300 Y290
M5 $0
{waits}G0 X305 Y110
M3 $0 S1
G1 F{feed} X305 Y290
M5 $0
M2
"""
LONG = "G4 P3600\n" * 200


@pytest.mark.parametrize(
    ("held", "waits", "feed", "said"),
    [
        (LONG, "", "2500", r"slow\.nc:3: the cut that begins here takes 200 h with the wait before it"),
        ("", LONG, "2500", r"slow\.nc:208: the cut that begins here takes 200 h with the wait before it"),
        ("", "", "0.001", r"slow\.nc:9:4: a feed of 0\.001 mm/min is not supported here"),
        ("", "G4 P99999999\n", "2500", r"slow\.nc:7:4: P99999999 is not supported here"),
    ],
)
def test_a_program_names_the_line(held: str, waits: str, feed: str, said: str) -> None:
    text, plant = PROGRAM.format(held=held, waits=waits, feed=feed), load_profile()
    with pytest.raises(InputError, match=said):
        path_of_program(read_program(text, PLATE, plant, "slow.nc"), "slow.nc")
