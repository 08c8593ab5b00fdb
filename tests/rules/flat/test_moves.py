"""Rules in model files about what directly follows what become prices of moves, and are proven at once."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.encoder.readers import read_nest
from kerfwise.jobs.request import Request, facts_of, make_request
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.pipeline import solve_and_verify
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import by_kind

pytestmark = pytest.mark.minizinc

NEST = """{"format": "kerfwise-nest/1", "units": "mm", "sheet": {"width": 600, "height": 400}, "parts": [
 {"id": "A", "outer": [[30, 30], [150, 30], [150, 150], [30, 150]],
  "holes": [[[70, 70], [110, 70], [110, 110], [70, 110]]], "order": 17},
 {"id": "B", "outer": [[180, 30], [300, 30], [300, 150], [180, 150]], "order": 17},
 {"id": "C", "outer": [[330, 30], [530, 30], [530, 70], [330, 70]], "order": 18},
 {"id": "D", "outer": [[330, 100], [530, 100], [530, 140], [330, 140]], "order": 18},
 {"id": "S1", "outer": [[30, 200], [48, 200], [48, 218], [30, 218]], "order": 19},
 {"id": "E", "outer": [[80, 200], [220, 200], [220, 340], [80, 340]], "order": 19},
 {"id": "S2", "outer": [[250, 200], [265, 200], [265, 215], [250, 215]], "order": 17},
 {"id": "G", "outer": [[300, 200], [530, 200], [530, 340], [300, 340]], "order": 18}]}"""
OFF = (
    *("level-ahead", "hull-before", "zone-order", "heat-lag", "no-islands", "no-narrow-strips", "no-tip-travel"),
    *("part-rigidity", "part-contiguous"),
)
PAIRS = "i, j in CONTOUR where i != j /\\ "
FILES = {
    "noneigh": f"[not directly_before(i, j) | {PAIRS} attribute_order[i] = attribute_order[j]]",
    "orderchange": f"[not directly_before(i, j) | {PAIRS} attribute_order[i] != attribute_order[j]]",
    "turns": f"[directly_before(i, j) -> cand_ccw[pick[i]] != cand_ccw[pick[j]] | {PAIRS} true]",
}


def asked(folder: Path, name: str, strength: str) -> tuple[Profile, Request]:
    file = folder / f"{name}.mzn"
    file.write_text(f"% {name}: asked by a test\narray[int] of var bool: {name}_holds = {FILES[name]};\n")
    nest = folder / "n.json"
    nest.write_text(NEST)
    rules = ", ".join([*(f"{rule}: off" for rule in OFF), f"{name}: {strength}"])
    plant = folder / "plant.yaml"
    plant.write_text(f"models: [{name}.mzn]\nleads: {{entries: 2}}\nrules: {{{rules}}}\n")
    profile = load_profile(plant)
    return profile, make_request(facts_of(read_nest(nest), profile), profile)


SOFT = "{strength: soft, weight: 60 mm}"
CASES = [("noneigh", "hard"), ("orderchange", SOFT), ("turns", SOFT)]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "strength"), CASES)
def test_it_is_proven_at_once(name: str, strength: str, tmp_path: Path) -> None:
    profile, request = asked(tmp_path, name, strength)
    kinds = by_kind(s for s in request.stated.statements if s.about.rule == name)
    assert kinds.move
    assert not kinds.at_least
    made = solve_and_verify(request, profile, SolveOptions(work=1.0))
    assert made.plan.solve.status == "optimal"
    assert made.verdict.ok
