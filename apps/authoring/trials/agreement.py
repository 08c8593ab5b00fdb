"""Whether a rule's statements, violations, MiniZinc text and options agree, and engines with trying every plan."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from kerfwise.encoder.candidates import LeadOptions
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts import FactOptions
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.jobs.request import make_request, options_for
from kerfwise.models.engines import BUILT_IN, Engine
from kerfwise.models.engines.minizinc_engine import clear_errors, solve_minizinc
from kerfwise.models.engines.minizinc_model import ConditionArray, arrays_of, condition_arrays, data_text, model_text
from kerfwise.models.engines.solution import Solution
from kerfwise.models.engines.solve import solve
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.rules.case import Case
from kerfwise.rules.flat.model_rule import ModelRule
from kerfwise.rules.minizinc.installation import driver, solver_named
from kerfwise.rules.minizinc.twin import rule_file
from kerfwise.rules.options.kind import Choice, Flag, Number, OptionKind, Unfit
from kerfwise.rules.options.option import Option, options_of
from kerfwise.rules.options.quantities import OrWord, Quantity
from kerfwise.rules.options.yaml_positions import compose
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule
from kerfwise.rules.statements import EXEMPTION_MM, About, IdleTravel, Statement
from kerfwise.rules.stating.lazy_statements import lazy_statements
from kerfwise.rules.stating.state_rules import Stated

from .trial import PlanOf, Trial, lawful, profile_with_rule_alone, route

STATED, JUDGED, WRITTEN = "its statements", "its violations", "its text in MiniZinc"


def compare_with_violations(trials: Sequence[Trial]) -> Iterator[str]:
    """The first plan of each trial that the statements admit and the violations blame, or the other way round."""
    for trial in trials:
        stated = trial.admitted_by_statements()
        ends = trial.rule.allowances(trial.options) or (trial.options,)
        judged = [trial.admitted_by_violations(options) for options in ends]
        yield from differing(trial, STATED, stated, JUDGED, frozenset.intersection(*judged), frozenset.union(*judged))


def compare_with_text(trials: Sequence[Trial]) -> Iterator[str]:
    """The first plan of each trial that the text in MiniZinc admits and the statements do not, or the other way round.

    Raises InputError if MiniZinc is not installed, or finds a mistake in the text.
    """
    for trial in trials:
        stated = trial.admitted_by_statements()
        yield from differing(trial, WRITTEN, admitted_by_text(trial), STATED, stated, stated)


def differing(
    trial: Trial, one: str, admitted: frozenset[PlanOf], other: str, least: frozenset[PlanOf], most: frozenset[PlanOf]
) -> Iterator[str]:
    """A line for each of the two ways to differ: with the first plan of it, and how many there are."""
    for who, not_who, plans in ((one, other, admitted - most), (other, one, least - admitted)):
        if plans:
            verb = "admits" if who == WRITTEN else "admit"
            says_not = "does" if not_who == WRITTEN else "do"
            yield f"{who} {verb} {trial.said(min(plans))}; {not_who} {says_not} not ({_like_it(len(plans))})"


def _like_it(count: int) -> str:
    return "the only such plan" if count == 1 else f"one of {count} such plans"


# Which plans of a trial a rule's text in MiniZinc admits: its solver lists all plans and judges each.


def text_of(rule: Rule[Any]) -> Path | None:
    """The file that states the rule in MiniZinc; None where there is none."""
    if isinstance(rule, ModelRule):
        return rule.file.path
    file = rule_file(rule.id)
    return file if rule.id in RULES and not rule.brought and file.exists() else None


def admitted_by_text(trial: Trial) -> frozenset[PlanOf]:
    """The plans in which every element of the rule's arrays is true.

    Raises InputError if MiniZinc is not installed, or finds a mistake in the file: with its line.
    """
    from minizinc import Instance
    from minizinc.error import MiniZincWarning

    own = arrays_of(trial.rule, trial.profile.settings()[trial.rule.id])
    arrays = [array for array in own if array.weight_mm in (None, EXEMPTION_MM)]  # others have a price of their own
    stated = Stated((IdleTravel(About("trial", (), "")),), ())
    limits = options_for(trial.nest, trial.profile)
    goal = [
        f"array[1..{len(arrays)}] of var bool: verdict :: add_to_output;",
        *(f"constraint verdict[{k}] = {_holds(array)};" for k, array in enumerate(arrays, 1)),
        "solve satisfy;",
    ]
    # None is asked, all are judged; the data is that of every rule that is on.
    every = [replace(array, weight_mm=0.0) for array in condition_arrays(trial.profile, stated)]
    clock = any(array.most_ms for array in every)
    with clear_errors(), warnings.catch_warnings():
        warnings.simplefilter("ignore", MiniZincWarning)
        instance = Instance(solver_named("gecode"), driver=driver())
        instance.add_string(
            model_text(every, "\n".join(goal)) + data_text(trial.facts, trial.profile, stated, limits, clock=clock)
        )
        solutions = instance.solve(all_solutions=True).solution
    return frozenset(tuple(c - 1 for c in one.stop if c > 0) for one in solutions if all(one.verdict))


def _holds(array: ConditionArray) -> str:
    return f"forall(ms in {array.name})(ms = 0)" if array.most_ms else f"forall({array.name})"


# Whether engines find what trying every plan finds.

WORK, SEARCH_WORK = 3.0, 0.05
"""Deterministic limits; a search that proves nothing takes all of its own."""
NEAR_MM = 1e-6


def compare_engines(trials: Sequence[Trial], engines: Sequence[Engine]) -> Iterator[str]:
    """A line for each engine that claims more, or less, than trying every plan of a trial finds."""
    for trial in trials:
        try:
            stated = make_request(trial.facts, trial.profile).stated
        except RulesConflict:
            continue  # as in a profile: where a rule asks for what cannot be, no engine is asked
        best_mm = cheapest_mm(trial, stated)
        for engine in engines:
            try:
                found = solved(trial, stated, engine)
            except RulesConflict:
                if best_mm is not None:
                    yield f"{engine} finds no plan of {trial.name}; there is one of {best_mm:.3f} mm"
                continue
            yield from _wrong(engine, trial, found, best_mm)


def _wrong(engine: Engine, trial: Trial, found: Solution, best_mm: float | None) -> Iterator[str]:
    if best_mm is None:
        yield f"{engine} has a plan of {trial.name}; each of them breaks the rule"
    elif found.objective < best_mm - NEAR_MM:
        yield f"{engine} says {found.objective:.3f} mm of {trial.name}; no lawful plan is under {best_mm:.3f}"
    elif found.objective > best_mm + NEAR_MM and (found.status == "optimal" or engine == "portfolio"):
        yield f"{engine} calls {found.objective:.3f} mm the best of {trial.name}; there is a plan of {best_mm:.3f}"


def solved(trial: Trial, stated: Stated, engine: Engine) -> Solution:
    """What an engine finds; RulesConflict where it finds no plan."""
    limits = options_for(trial.nest, trial.profile, work=SEARCH_WORK if engine == "search" else WORK, engine=engine)
    refine = lazy_statements(trial.facts, trial.profile)
    if engine == "minizinc":
        return solve_minizinc(trial.facts, trial.profile, stated, limits, refine=refine)
    return solve(trial.facts, stated.statements, limits, refine=refine)


def cheapest_mm(trial: Trial, stated: Stated) -> float | None:
    """What the cheapest plan costs, mm of idle travel, by trying all; None where each breaks something."""
    try:
        problem = trial.problem(stated.statements)
    except RulesConflict:
        return None
    costs = (route_cost(problem, route(problem, plan)) for plan in trial.plans if lawful(problem, plan))
    best = min(costs, default=None)
    return None if best is None else best / UM_PER_MM


def engines_here(minizinc: bool) -> tuple[Engine, ...]:
    """The engines to ask: those that are built in, and MiniZinc's where it is installed."""
    return (*BUILT_IN, "minizinc") if minizinc else BUILT_IN


# Whether each option of a rule does something, and the same to what is stated as to what is judged.

DRAWS = 8
PLANS = 12
"""Plans of a trial in which it is looked whether an option changes what is blamed."""

Trials = Callable[[Profile], Sequence[Trial]]
"""Makes the same trials under a profile."""


def idle_options(rule: Rule[Any], profile: Profile, trials: Trials, cases: Sequence[Case]) -> Iterator[str]:
    """A line for each option that changes nothing, whatever its value: neither what is stated nor what is blamed."""
    for option in options_of(rule.Options):
        if option.name in rule.shares:
            continue
        values, seen = list(drawn_values(rule, option, profile)), set()
        for value in values:
            seen.add(_effect(rule, _with(profile, rule, option, value), trials, cases, option, value))
            if len(seen) > 1:
                break
        if len(values) > 1 and len(seen) == 1:
            tried = ", ".join(option.kind.write(value) for value in values)
            yield f"option {option.key} does nothing: the rule states and blames the same under {tried}"


def drawn_values(rule: Rule[Any], option: Option, profile: Profile) -> Iterator[Any]:
    """Different values of an option that do not contradict the rest of the profile, the default first."""
    rng = np.random.default_rng(sum(map(ord, option.key)))
    seen: list[Any] = []
    for k in range(DRAWS):
        try:
            value = option.default if k == 0 else drawn_value(option, rng)
        except Undrawn:
            return
        if value not in seen and not contradicts(rule, _with(profile, rule, option, value)):
            seen.append(value)
            yield value


def contradicts(rule: Rule[Any], profile: Profile) -> bool:
    """Whether the options of the rule contradict the rest of the profile."""
    return bool(list(rule.check_with(profile.settings()[rule.id].options, profile.plant, profile.rules)))


def with_option(rule: Rule[Any], profile: Profile, option: Option, value: Any) -> Profile:
    """The profile of a trial with an option set."""
    return _with(profile, rule, option, value)


def _with(profile: Profile, rule: Rule[Any], option: Option, value: Any) -> Profile:
    return profile_with_rule_alone(profile, rule.id, **{option.name: value})


def _effect(
    rule: Rule[Any], profile: Profile, trials: Trials, cases: Sequence[Case], option: Option, value: Any
) -> str:
    """All that the rule says under a profile, but for its sentences."""
    options = profile.settings()[rule.id].options
    effects: list[object] = [
        rule.fact_options(FactOptions(), options, "hard"),
        rule.lead_options(LeadOptions(), options, "hard"),
        rule.temperature_limit(options),
    ]
    for case in cases:
        changed = replace(case.options or options, **{option.name: value})
        effects.append([(v.contours, v.cuts) for v in rule.violations(case.nest, case.cuts, changed)])
    for trial in trials(profile):
        try:
            effects.append([_bare(s) for s in rule.statements(trial.facts, options)])
        except RulesConflict as conflict:
            effects.append(str(conflict))
        names = [contour.id for contour in trial.nest.contours]
        effects.append(rule.no_goods(trial.nest, names, options) != [])
        some = trial.plans[:: max(1, len(trial.plans) // PLANS)]
        effects += [[(v.contours, v.cuts) for v in broken] for broken in trial.violations(some, options)]
    return repr(effects)


def _bare(statement: Statement) -> tuple[object, ...]:
    values = (getattr(statement, f.name) for f in fields(statement) if f.name != "about")
    return type(statement).__name__, *values


# Values drawn at random from what an option declares: kind, bounds and default. A new option is drawn by itself.

USUAL = {"mm": 25.0, "s": 8.0, "kJ": 30.0, "°C": 115.0}
"""A value of each unit, for options whose default is nothing."""
FACTORS = (0.2, 0.5, 1.0, 1.7, 3.0)
TRIES = 100


class Undrawn(Exception):
    """Nobody has said how a value of this kind is drawn, or nothing valid was drawn."""


def drawn_value(option: Option, rng: np.random.Generator) -> Any:
    """A valid value of an option, the same for the same state of `rng`.

    Raises Undrawn if its kind is none of kerfwise's own, or nothing valid was drawn.
    """
    for _ in range(TRIES):
        value = _of_kind(option.kind, option.default, rng)
        try:
            return _read(option.kind, value)
        except Unfit:
            continue
    raise Undrawn(f"nothing valid was drawn for {option.name}: {option.kind.expected()}")


def _read(kind: OptionKind, value: Any) -> Any:
    node = compose(kind.write(value), "drawn")
    assert node is not None
    return kind.read(node)


def _of_kind(kind: OptionKind, default: Any, rng: np.random.Generator) -> Any:
    match kind:
        case Flag():
            return bool(rng.random() < 0.5)
        case Choice(words=words, none=none):
            word = str(rng.choice(words))
            return None if word == none else word
        case OrWord(quantity=quantity):
            return None if rng.random() < 0.3 else _of_kind(quantity, default, rng)
        case Quantity():
            usual = default if isinstance(default, float) and default else USUAL[kind.bare]
            return 0.0 if rng.random() < 0.1 else round(usual * float(rng.choice(FACTORS)), 3)
        case Number(at_least=low, at_most=high, whole=whole):
            low = 0.0 if low is None else low
            if whole and high is None:  # small counts tell most, on small nests
                return int(low) + int(rng.choice([0, 1, 2, 3, 7]))
            high = low + 4 * max(1.0, abs(float(default or 1))) if high is None else high
            return int(rng.integers(int(low), int(high) + 1)) if whole else round(float(rng.uniform(low, high)), 2)
        case _:
            raise Undrawn(
                f"say in apps/authoring/trials/agreement.py how an option of kind {type(kind).__name__} is drawn"
            )
