"""A wish costs no excuse from a hard rule: neither how soon the limit comes nor what is wished for changes that."""

from __future__ import annotations

import json
import random
from pathlib import Path

import pytest

from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import read_nest
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.models.engines.tuning import WITHOUT_WISHES
from kerfwise.pipeline import solve_and_verify
from kerfwise.rules.profile.load import load_profile

RULES = "rules: {zone-order: off, part-rigidity: {strength: hard, rigid_min: 0.9, tail_share: 0.4}}"
KIT = "{name: kit, why: one pallet, select: {part: [PARTS]}, together: true, strength: soft, weight: 50}"
RUSH = "{name: rush, why: the truck leaves, select: {part: [PARTS]}, first: true, strength: soft, weight: 50}"
COOL = "{name: cool, why: heat, select: {part: [PARTS]}, apart: {cuts: 3}, strength: soft, weight: 50}"
SOON = "{name: soon, why: the truck leaves, select: {part: [PARTS]}, within_time: 30 %, strength: soft, weight: 50}"


def excuses(nest: Nest, wishes: list[str], work: float, folder: Path) -> int:
    """How many hard statements the plan could not keep, with these wishes and so much work."""
    path = folder / "plant.yaml"
    own = "".join(f"  - {wish}\n" for wish in wishes)
    path.write_text(f"based_on: plasma-carbon-steel\n{RULES}\nown_rules:\n{own or '  []'}", encoding="utf-8")
    profile = load_profile(path)
    asked = make_request(facts_of(nest, profile), profile)
    return solve_and_verify(asked, profile, options_for(nest, profile, work=work), move_zones=True).plan.solve.excuses


@pytest.mark.full  # tests/models/engines/test_portfolio.py shows the same of problems that are made
@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3, 5, 6, 7, 8, 9])
def test_a_wish_costs_no_excuse(seed: int, tmp_path: Path) -> None:
    """The plan without wishes has the work that the plan with them gives to one without."""
    rng = random.Random(seed)
    path = tmp_path / "nest.json"
    contours, work = rng.choice([30, 45, 60]), rng.choice([0.1, 0.5])
    path.write_text(json.dumps(make_sheet(seed, contours, (2500.0, 1000.0), 6.0)), encoding="utf-8")
    nest = read_nest(path)
    fewest = excuses(nest, [], WITHOUT_WISHES * work, tmp_path)
    parts = rng.sample(sorted({contour.part for contour in nest.contours}), 4)
    for wishes in ([KIT], rng.sample([KIT, RUSH, COOL, SOON], 2)):
        asked = [wish.replace("PARTS", ", ".join(parts)) for wish in wishes]
        assert excuses(nest, asked, work, tmp_path) <= fewest, wishes
