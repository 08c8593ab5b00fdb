"""The main job: a nest and a profile become a plan, its program and the verdict on both."""

from __future__ import annotations

from dataclasses import dataclass, replace

from kerfwise.encoder.already_cut import NOTHING_CUT, AlreadyCut
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.models.engines.baselines import Strategy
from kerfwise.models.engines.names import Engine
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.kernels import compiled_s, made_s, running_s
from kerfwise.postproc.dialects import expect_words
from kerfwise.postproc.verdict.dialect_read_back import trusted_dialect

from .ask import ask, facts_of
from .given import Given, Tell, silent
from .listening import Listener
from .no_plan import NoPlan
from .one_torch import expect_one_torch
from .produce import Produced, produce
from .stopped import again_first
from .whole_limit import LEAST_SHARE, Took, WholeLimit

SAID_S = 5.0
"""What takes longer beside a limit in seconds is told."""


@dataclass(frozen=True, eq=False, slots=True)
class Finished:
    """What the main job has made: of which nest and profile, of which facts, and what came of them.

    The profile has a lock on a cut that broke off, where the program goes on after a stop.
    """

    given: Given
    facts: Facts
    made: Produced


def plan_nest(
    given: Given,
    limits: SolveOptions,
    *,
    already: AlreadyCut = NOTHING_CUT,
    relax: bool = False,
    engine: Engine = "portfolio",
    solver: str = "gecode",
    strategy: Strategy = "ours",
    listener: Listener | None = None,
    tell: Tell = silent,
    whole: WholeLimit | None = None,
) -> Finished:
    """Plan a nest, or what is left of it, write the program, and judge both.

    Parameters
    ----------
    given
        Nest and profile.
    limits
        Of the plan, as `options_for` makes them.
    already
        What a stopped program has cut.
    relax
        Where hard rules clash, the cheapest statements give way, marked in the plan.
    engine, solver, strategy
        Who plans; `solver` is that of the engine minizinc.
    listener
        Listens while the plan is made.
    tell
        Told what took long beside a limit in seconds.
    whole
        A limit of the command that this is part of, in place of one in seconds for the planning alone.

    Raises
    ------
    InputError
        If a lock names what the nest does not have, the dialect does not fit, or a contour cannot be cut.
    RulesConflict
        If contours cannot be cut and hard rules cannot hold in any order.
    NoPlan
        If the hard rules cannot all hold, or no plan was found. What contradicts what is looked for within `limits`
        once more, or in what is left of `whole`, unless the user has interrupted.
    """
    nest, profile = given.nest, again_first(given.profile, already)
    dialect = trusted_dialect(profile)  # a file of the plant's own may be wrong: better said now than at the end
    expect_words(nest, profile, dialect, resumes=bool(already))
    if engine == "minizinc":
        expect_one_torch(profile, "the engine minizinc")
        from kerfwise.models.engines.minizinc.installation import solver_named

        solver_named(solver)  # the same goes for a MiniZinc that is missing or broken
    limit_s, listener = limits.time_s if whole is None else None, listener or Listener()
    not_counted = made_s if whole is None else compiled_s  # a limit of the command counts what loads
    began_s, before_s, took = running_s(), not_counted(), Took()
    facts = facts_of(nest, profile, already, took)
    _not_counted("the facts of the nest", running_s() - began_s, limit_s, tell)
    try:
        began_s = running_s()
        limits = limits if whole is None else whole.begin(limits, took)
        asked = ask(facts, profile, relax, limits)
        left = limits
        if limit_s:  # stating the rules is inside the limit; a plan gets its share all the same
            spent_s = running_s() - began_s
            left = replace(limits, time_s=max(limit_s - spent_s, LEAST_SHARE * limit_s))
        if whole is not None:
            left = whole.begin(limits, took)
            if told := whole.too_short(took):
                tell(told)
        began_s = running_s()
        with listener:
            going = listener if whole is None else whole.watched(listener)
            made = produce(asked, profile, left, going, engine, solver, strategy, and_zones=True)
    except RulesConflict as error:
        from kerfwise.models.engines.budget import Budget
        from kerfwise.models.plan.conflict import NotAnswered, find_conflict

        limits = limits if whole is None else replace(limits, time_s=whole.left_s())
        try:
            conflict = None if listener.interrupted else find_conflict(facts, profile, Budget.of(limits))
        except NotAnswered:
            raise NoPlan(error, facts, profile, within_limit=False) from error
        raise NoPlan(error, facts, profile, conflict) from error
    if whole is not None:
        whole.end(made.judging_s)
    over_s = running_s() - began_s - made.judging_s - (left.time_s or 0.0)
    if (left.time_s or limits.no_improvement_s) and (took_s := not_counted() - before_s) > SAID_S:
        tell(f"kernels were compiled, which is done once: {took_s:.0f} s, not counted by the limit")
    _not_counted("ending the planning", over_s, limit_s, tell)
    _not_counted("writing and checking the program", made.judging_s, limit_s, tell)
    return Finished(Given(nest, profile), made.facts, made)


def _not_counted(what: str, took_s: float, limit_s: float | None, tell: Tell) -> None:
    """Say what took long beside a limit in seconds."""
    if limit_s and took_s > SAID_S:
        tell(f"{what} took {took_s:.0f} s, which the limit does not count")
