"""What the engine answers: plans, conflicts, limits, and errors that name the file of the plant's that is wrong."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import minizinc
import pytest

from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.facts.facts import Facts
from kerfwise.models.engines import minizinc_engine, minizinc_model
from kerfwise.models.engines.minizinc_engine import solve_minizinc
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.minizinc.installation import driver, installed_solvers, solver_named
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import About, NoGood, Statement
from kerfwise.rules.stating.state_rules import state_rules
from kerfwise.tests.models.engines.cases import case

pytestmark = pytest.mark.minizinc

THREE = nest(400, 60, *(part(name, rect(x, 10, 40, 40)) for name, x in (("A", 10), ("B", 160), ("C", 310))))
NOTHING = "array[int] of var bool: mine_holds = [];"
NEVER_ENDS = "constraint sum(k in 1..3000000)(k mod 7) > 0;"
PLAIN = "based_on: laser-wood\nrules: {level-ahead: off, zone-order: off, part-rigidity: off, no-islands: off}\n"


def plant(folder: Path, own: str = "", files: dict[str, str] | None = None) -> Profile:
    """A profile without order rules between parts, with these own rules and the files they name."""
    for name, text in (files or {}).items():
        (folder / name).write_text(text, encoding="utf-8")
    path = folder / "plant.yaml"
    path.write_text(f"name: plant\n{PLAIN}{own}", encoding="utf-8")
    return load_profile(path)


def facts_of(profile: Profile) -> Facts:
    return compute_facts(THREE, profile.fact_options(THREE), build_candidates(THREE, profile.lead_options()))


def order(profile: Profile, solver: str = "gecode", work: float = 20.0) -> str:
    """The parts in the order that the engine cuts them."""
    facts = facts_of(profile)
    stated = state_rules(facts, profile)
    found = solve_minizinc(facts, profile, stated, SolveOptions(work=work), solver)
    return "".join(THREE.contours[facts.candidates[c].contour].part for c in found.route)


def test_an_own_file_is_kept(tmp_path: Path) -> None:
    assert order(plant(tmp_path)) in ("ABC", "CBA")
    rule = 'constraint forall(i in CONTOUR where contour_id[i] = "B.outer", j in CONTOUR where j != i)(before(i, j));'
    profile = plant(tmp_path, "own_rules: [{file: b_first.mzn}]\n", {"b_first.mzn": rule})
    assert order(profile).startswith("B")


def test_a_mistake_in_an_own_file_is_named_with_its_place(tmp_path: Path) -> None:
    own, wrong = "own_rules: [{file: mine.mzn}]\n", "% mine\nconstraint before(1 2);\n"
    with pytest.raises(InputError) as syntax:
        order(plant(tmp_path, own, {"mine.mzn": wrong}))
    assert (Path(str(syntax.value.file)), syntax.value.line) == (tmp_path / "mine.mzn", 2)
    with pytest.raises(InputError, match=r"mine\.mzn:1:\d+: MiniZinc: .*levelahead"):
        order(plant(tmp_path, own, {"mine.mzn": "constraint forall(i, j in CONTOUR where levelahead[i, j])(true);"}))
    with pytest.raises(InputError, match=r"mine\.mzn:1:\d+: MiniZinc: .*no contour is long"):
        order(plant(tmp_path, own, {"mine.mzn": f'constraint assert(exists(long), "no contour is long"); {NOTHING}'}))


def test_an_own_file_that_leaves_no_plan_is_a_conflict(tmp_path: Path) -> None:
    profile = plant(tmp_path, "own_rules: [{file: no.mzn}]\n", {"no.mzn": "constraint before(1, 2) /\\ before(2, 1);"})
    with pytest.raises(RulesConflict, match="these hard rules cannot hold in any order"):
        order(profile)


def test_without_time_there_is_no_plan_and_no_claim(tmp_path: Path) -> None:
    with pytest.raises(RulesConflict, match="within the limit"):
        order(plant(tmp_path), work=0.0)


def stopped_once(heard: list[object], profile: Profile) -> Solution:
    """A solve whose listener has had enough as soon as something was heard."""
    facts = facts_of(profile)
    stated = state_rules(facts, profile)
    return solve_minizinc(facts, profile, stated, SolveOptions(), progress=lambda engine, cost_um, bound_um: not heard)


def test_the_best_so_far_is_kept_when_it_is_interrupted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    heard: list[object] = []
    solutions = minizinc.Instance.solutions

    async def endless(instance: minizinc.Instance, **options: Any) -> AsyncIterator[minizinc.Result]:
        for result in [result async for result in solutions(instance, **options)]:
            yield result
            if result.solution is not None:
                heard.append(result)
                await asyncio.sleep(60)

    monkeypatch.setattr(minizinc.Instance, "solutions", endless)
    found = stopped_once(heard, plant(tmp_path))
    assert (len(found.route), found.status, found.bound) == (3, "feasible", None)


@pytest.mark.slow
def test_interrupted_before_there_is_a_plan(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        stopped_once(["Ctrl-C"], plant(tmp_path, "own_rules: [{file: hard.mzn}]\n", {"hard.mzn": NEVER_ENDS}))


def test_a_nest_that_is_too_large_is_refused_before_anything_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(minizinc_engine, "MOST_MOVES", 1000)
    with pytest.raises(InputError, match=r"moves from one to another; the engine minizinc takes 1,000 at the most"):
        order(plant(tmp_path))


def test_an_unknown_solver_is_answered_with_those_there_are(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="unknown solver 'gecod': did you mean 'gecode'"):
        order(plant(tmp_path), "gecod")


def test_a_solver_whose_library_is_missing_is_not_offered() -> None:
    names = {s.name for s in installed_solvers()}
    assert "gecode" in names
    assert "gist" not in names
    assert solver_named("org.gecode.gecode").id == "org.gecode.gecode"


def test_without_minizinc_the_message_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(minizinc, "default_driver", None)
    with pytest.raises(InputError, match="apt-get install minizinc"):
        driver()


def test_what_geometry_adds_afterwards_is_kept(tmp_path: Path) -> None:
    profile = plant(tmp_path)
    facts = facts_of(profile)

    def never_a_before_both(route: tuple[int, ...]) -> tuple[Statement, ...]:
        out, left = frozenset({route[0]}), frozenset(route[1:])
        return () if THREE.contours[route[0]].part == "B" else (NoGood(out, left, About("strip", (), "")),)

    found = solve_minizinc(facts, profile, state_rules(facts, profile), SolveOptions(), refine=never_a_before_both)
    assert THREE.contours[facts.candidates[found.route[0]].contour].part == "B"


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2, 5, 18, 30])
def test_rules_stated_in_words_give_the_same_optimum(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = case(seed)
    off = replace(drawn.profile.rules["no-tip-travel"], strength="off", weight=None)
    profile = replace(drawn.profile, rules=drawn.profile.rules | {"no-tip-travel": off})
    stated = state_rules(drawn.facts, profile)
    by_files = solve_minizinc(drawn.facts, profile, stated, drawn.options)
    for module in (minizinc_model, minizinc_model):
        monkeypatch.setattr(module, "rules_in_files", lambda profile, stated: {})
    in_words = solve_minizinc(drawn.facts, profile, stated, drawn.options)
    assert in_words.objective == by_files.objective
