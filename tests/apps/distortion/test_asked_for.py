"""Where nest and profile ask for it: what solve prints and refuses, plans chosen by simulation, mm in other verbs."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kerfwise as package
from kerfwise import InputError, load_profile
from kerfwise.apps.distortion import predict, straighter
from kerfwise.apps.distortion.part_errors import PartError
from kerfwise.apps.distortion.straighter import StraighterOrders, straighter_for
from kerfwise.apps.distortion.tolerances import beyond, kept_or_not, tolerances_of
from kerfwise.jobs.inputs import drawn_nest
from kerfwise.jobs.request import make_request, options_for
from kerfwise.pipeline import VerifiedPlan, solve_and_verify
from kerfwise.rule_kit import Point
from kerfwise.tests.commands.run_cli import kerfwise

NEST = Path(package.__file__).parent / "examples" / "nests" / "e1x_6.json"
OXYFUEL = "based_on: oxyfuel-thick-plate\nsmall_holes: {under: skip}\n"


@pytest.fixture(autouse=True)
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cells of some 30 mm: what is told of an error is looked at, not the error."""
    monkeypatch.setattr(predict, "CELLS", 300)


def small(folder: Path, **keys: Any) -> Path:
    """A nest of two strips and a square; the keys are the first strip's."""
    parts = [
        {"id": "A", "outer": [[30, 30], [570, 30], [570, 90], [30, 90]], **keys},
        {"id": "B", "outer": [[30, 140], [570, 140], [570, 200], [30, 200]]},
        {"id": "C", "outer": [[30, 250], [250, 250], [250, 370], [30, 370]]},
    ]
    sheet = {"width": 600, "height": 400}
    nest = folder / "small.json"
    nest.write_text(json.dumps({"format": "kerfwise-nest/1", "units": "mm", "sheet": sheet, "parts": parts}))
    return nest


def plant(folder: Path, more: str = "") -> Path:
    path = folder / "plant.yaml"
    path.write_text(OXYFUEL + more, encoding="utf-8")
    return path


def solved(folder: Path, nest: Path, more: str = "") -> Any:
    return kerfwise(
        "solve", nest, "-p", plant(folder, more), "--work", 0.5, "-o", folder / "o.nc", "--plan", folder / "o.json"
    )


def test_solve_says_nothing_of_it_unless_it_is_asked(tmp_path: Path) -> None:
    done = solved(tmp_path, small(tmp_path))
    assert done.code == 0, done.err
    assert "off when cold" not in done.out


@pytest.mark.slow
def test_solve_tells_a_tolerance_that_is_not_kept_before_anyone_cuts(tmp_path: Path) -> None:
    done = solved(tmp_path, small(tmp_path, tolerance="0.001 mm"), "distortion: {tolerance: 50 mm}\n")
    assert done.code == 0, done.err
    (line,) = (line for line in done.out.splitlines() if "off when cold" in line)
    assert "1 of 3 parts with a tolerance will not keep it: A 0." in line
    assert line.endswith("0.001 mm allowed")
    table = kerfwise("distort", tmp_path / "small.json", tmp_path / "o.json", "-p", tmp_path / "plant.yaml")
    assert "1 of 3 parts with a tolerance will not keep it" in table.out
    found = kerfwise("distort", tmp_path / "small.json", tmp_path / "o.json", "-p", tmp_path / "plant.yaml", "--json")
    rows = {row["part"]: row for row in json.loads(found.out)["parts"]}
    assert (rows["A"]["tolerance_mm"], rows["A"]["kept"]) == (0.001, False)
    assert (rows["B"]["tolerance_mm"], rows["B"]["kept"]) == (50, True)


@pytest.mark.slow
def test_a_hard_tolerance_refuses_the_plan_and_writes_nothing(tmp_path: Path) -> None:
    keep = "distortion: {tolerance: 0.001 mm, keep_tolerance: true}\n"
    done = solved(tmp_path, small(tmp_path), keep)
    assert done.code == 1
    assert "3 of 3 parts with a tolerance will not keep it" in done.err
    assert "nothing was written" in done.err
    assert not (tmp_path / "o.nc").exists()


@pytest.mark.parametrize("said", ["wide", -1, 0, True, [1], "2 kg"])
def test_a_tolerance_that_is_no_length_is_refused_with_its_part(said: object, tmp_path: Path) -> None:
    done = solved(tmp_path, small(tmp_path, tolerance=said))
    assert done.code == 2
    assert "A: tolerance" in done.err
    assert not (tmp_path / "o.nc").exists()


def test_a_price_on_distortion_needs_one_simulation(tmp_path: Path) -> None:
    done = solved(tmp_path, small(tmp_path), "objective: {heat: 1, distortion: 1}\n")
    assert (done.code, "not for both" in done.err) == (2, True)
    profile = load_profile("laser-wood")
    priced = replace(profile, objective=replace(profile.objective, distortion=1.0))
    with pytest.raises(InputError, match="plywood"):
        straighter_for(priced)


def few_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    """A search of some twenty simulations on a mesh of a few hundred cells."""
    for name, value in {"SWEEPS": 1, "WAYS": 6, "STEPS_EACH": 0, "FEWEST": 12, "CELLS": 150}.items():
        monkeypatch.setattr(straighter, name, value)


def ways(made: VerifiedPlan) -> list[tuple[str, Point, str]]:
    """The order of the cuts, where each begins, and which way round it goes."""
    return [(cut.contour, cut.entry, cut.direction) for cut in made.plan.sequence().cuts]


@pytest.mark.slow
def test_the_plan_that_is_chosen_is_the_best_that_was_simulated(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    few_steps(monkeypatch)
    profile = load_profile(plant(tmp_path, "objective: {distortion: 1000000}\n"))
    nest = profile.as_cut(drawn_nest(small(tmp_path), profile))
    facts, limits = package.facts(nest, profile), options_for(nest, profile, work=0.5)
    asked = make_request(facts, profile, limits=limits)
    plain = solve_and_verify(asked, profile, limits)
    orders = StraighterOrders(facts, profile, asked.stated)
    chosen = solve_and_verify(asked, profile, limits, simulated=orders)
    assert chosen.verdict.ok
    assert len(chosen.plan.sequence().cuts) == 3
    price_mm = orders.price_mm(profile)
    found = [tried.total_mm(price_mm) for tried in orders.tried.values()]
    assert len(found) >= 8
    assert chosen.plan.solve.objective == pytest.approx(min(found), rel=1e-6)
    first = next(iter(orders.tried.values()))
    assert chosen.plan.solve.objective < first.total_mm(price_mm) - 1.0
    again = solve_and_verify(asked, profile, limits, simulated=StraighterOrders(facts, profile, asked.stated))
    assert ways(again) == ways(chosen) != ways(plain)
    assert orders.like(chosen.plan) in orders.tried
    assert orders.tried[orders.like(chosen.plan) or ()].total_mm(price_mm) == pytest.approx(min(found))
    assert not any("overheat" in sentence for cut in chosen.plan.cuts for sentence in cut.because)


@pytest.mark.full
def test_compare_has_mm_beside_travel_and_time(tmp_path: Path) -> None:
    nest = small(tmp_path)
    assert solved(tmp_path, nest).code == 0
    made = (tmp_path / "o.json", tmp_path / "o.nc")
    done = kerfwise("compare", nest, *made, "-p", tmp_path / "plant.yaml", "--distortion", "--json")
    assert done.code == 0, done.err
    figures = json.loads(done.out)["figures"]
    assert figures["off_mean_mm"]["a"] == pytest.approx(figures["off_mean_mm"]["b"], rel=0.05)
    assert figures["off_max_mm"]["a"] >= figures["off_mean_mm"]["a"] > 0


@pytest.mark.full
def test_pareto_has_mm_as_an_axis_beside_travel_and_overheats(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    few_steps(monkeypatch)
    nest, profile = small(tmp_path), plant(tmp_path)
    done = kerfwise(
        "pareto", nest, "-p", profile, "--price", 0, "--off-price", 1e6, "--work", 0.5, "--distortion", "--json",
        "-o", tmp_path / "front.png", "--plans", tmp_path / "plans",
    )  # fmt: skip
    assert done.code == 0, done.err
    plain, straight = json.loads(done.out)
    assert (plain["off_price_mm"], straight["off_price_mm"]) == (0, 1e6)
    assert 0 < straight["off_mm"] < plain["off_mm"]
    assert straight["idle_mm"] > plain["idle_mm"]
    assert plain["front"]
    assert straight["front"]
    assert kerfwise("check", nest, tmp_path / "plans" / "off-price-1000000.nc", "-p", profile).code == 0


def test_a_price_on_mm_needs_their_simulation(tmp_path: Path) -> None:
    done = kerfwise("pareto", small(tmp_path), "-p", plant(tmp_path), "--off-price", 1)
    assert (done.code, "--distortion" in done.err) == (2, True)


def test_kept_and_not_kept_in_words() -> None:
    nothing = np.zeros(0, int), np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0)
    parts = tuple(
        PartError(name, off, off, (0.0, 0.0), *nothing) for name, off in (("A", 1.0), ("B", 0.5), ("C", None))
    )
    assert kept_or_not((), 0) == ""
    assert kept_or_not(beyond(parts, {"A": 1.0, "C": 0.1}), 2) == "all 2 parts with a tolerance keep it"
    assert kept_or_not(beyond(parts, {"A": 0.9}), 1).endswith("will not keep it: A 1.00 mm, 0.9 mm allowed")


def test_a_part_s_own_tolerance_goes_before_the_profile_s(tmp_path: Path) -> None:
    profile = load_profile(plant(tmp_path, "distortion: {tolerance: 2 mm}\n"))
    nest = profile.as_cut(drawn_nest(small(tmp_path, tolerance=0.5), profile))
    assert tolerances_of(nest, profile) == {"A": 0.5, "B": 2.0, "C": 2.0}
