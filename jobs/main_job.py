"""The main job: a nest and a profile become a plan, its program and the verdict on both."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from kerfwise.encoder.already_cut import NOTHING_CUT, AlreadyCut
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.models.engines.baselines import Strategy
from kerfwise.models.engines.names import Engine
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.dialects import expect_words
from kerfwise.postproc.verdict.dialect_read_back import trusted_dialect

from .ask import ask, facts_of
from .given import Given, Tell, silent
from .job_limit import CommandLimit, JobLimit, PlanningLimit
from .listening import Listener
from .no_plan import NoPlan
from .one_torch import expect_one_torch
from .produce import Produced, produce
from .stopped import again_first
from .whole_limit import Took, WholeLimit


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
    planned_as: Callable[[Plan], None] | None = None,
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
    planned_as
        Told the plan before it is judged.

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
    limit: JobLimit = PlanningLimit(limits, tell) if whole is None else CommandLimit(whole, limits, tell)
    listener, took = listener or Listener(), Took()
    facts = facts_of(nest, profile, already, took)
    try:
        asked = ask(facts, profile, relax, limit.facts_made(took))
        left = limit.stated(took)
        with listener:
            made = produce(
                asked,
                profile,
                left,
                limit.watched(listener),
                engine,
                solver,
                strategy,
                and_zones=True,
                planned_as=planned_as,
            )
    except RulesConflict as error:
        from kerfwise.models.engines.budget import Budget
        from kerfwise.models.plan.conflict import NotAnswered, find_conflict

        try:
            conflict = None if listener.interrupted else find_conflict(facts, profile, Budget.of(limit.without_plan()))
        except NotAnswered:
            raise NoPlan(error, facts, profile, within_limit=False) from error
        raise NoPlan(error, facts, profile, conflict) from error
    limit.ended(made.judging_s)
    return Finished(Given(nest, profile), made.facts, made)
