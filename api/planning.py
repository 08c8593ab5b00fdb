"""Planning a nest, and what can be asked before there is a plan."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from kerfwise.app_modules import app_module
from kerfwise.encoder.already_cut import AlreadyCut
from kerfwise.encoder.errors import InputError, KerfwiseError
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nearest_name import unknown
from kerfwise.jobs.by_engine import Method, OrdersOf
from kerfwise.jobs.inputs import Inputs, NestLike, ProfileLike
from kerfwise.jobs.nest_job.request import JobLike, inputs_for
from kerfwise.jobs.progress import Listener, OnProgress
from kerfwise.jobs.request import NOT_SHOWN, NoPlan, facts_of, options_for
from kerfwise.jobs.result import Result
from kerfwise.jobs.resume import already_cut
from kerfwise.models.engines import OLD_NAMES, STRATEGIES, Engine, Strategy
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.tuning import MEMORY_GB
from kerfwise.models.engines.tuning import REQUEST_WORK as WORK
from kerfwise.models.plan.conflict import Conflict, NotAnswered, find_conflict
from kerfwise.models.plan.plan import Plan
from kerfwise.pipeline import Watchers, plan_nest

from .reading import LockLike, Settings, nest_request, plan_of, plan_or_path


def solve(
    nest: NestLike,
    profile: ProfileLike | None = None,
    *,
    locks: Iterable[LockLike] | LockLike = (),
    job: JobLike = None,
    settings: Settings = (),
    answers: Mapping[str, str] | None = None,
    time_s: float | None = None,
    work: float = WORK,
    seed: int = 1,
    gap: float | None = None,
    no_improvement_s: float | None = None,
    memory_gb: float = MEMORY_GB,
    engine: Engine = "portfolio",
    solver: str = "gecode",
    strategy: Strategy = "ours",
    relax: bool = False,
    resume_from: Plan | Result | str | Path | None = None,
    upto: int | None = None,
    redo_last: bool = False,
    start: Plan | Result | str | Path | None = None,
    first: bool = False,
    date: str = "",
    on_progress: OnProgress | None = None,
) -> Result:
    """Plan a nest: an order, pierces and directions that keep every hard rule, the NC program, and the verdict on both.

    Without `time_s` the same nest, profile, locks, seed and work give the same plan and program to the byte.
    Ctrl-C keeps the best plan so far (`Result.interrupted`).

    Parameters
    ----------
    nest
        A nest, or the path of its file.
    profile
        A profile, its name or its path; None for that of the job file, or "plasma-carbon-steel".
    locks
        Your own decisions, always hard: lines such as "P1.outer before P2.outer", "P1 first", "#7 last",
        "P1.outer entry (10, 20)", "P1.outer cw", "no link P1", "P1 in zone 2"; or `Lock` objects, or mappings as in a
        profile. They go before those of the job file, and these before those of the profile.
    job
        A job file's path, or what `read_job` makes of it; None for the one beside the nest's file, `NEST.job.yaml`, if
        there is one; False to go without.
    settings
        Values of the profile for this nest only: {"leads.lead_in": "4 mm"}, or lines such as "leads.lead_in=4 mm".
    answers
        Answers to questions that the drawing raises: {"frame": "sheet"}. They go before those of the job file.
    time_s
        Wall-clock limit of the planning, s, instead of `work`.
    work
        Limit that does not depend on the machine's speed; one is about a second.
    seed
        Seed of the search.
    gap
        Stop at a plan that is proven this close to the best; 0.01 is 1 %.
    no_improvement_s
        Stop when so many seconds have brought no better plan.
    memory_gb
        What the process may hold: tables of engines that run at the same time fill what libraries, and moves over parts
        that are out, leave of it. CP-SAT and linear programs have their own.
    engine, solver
        Which engine plans (`kerfwise engines` lists them), and which solver the engine minizinc uses.
    strategy
        All but "ours" are there to compare with: "shortest", "random", "realtime".
    relax
        Where hard rules clash, let the cheapest statements give way; the plan marks them.
    resume_from, upto, redo_last
        Go on after a stop: the plan (or its file, or that of the NC program) that was stopped, how many of its cuts
        are made, and whether the last of them broke off and is to be cut again.
    start
        A plan at hand (or its file), as of the nest before an edit: its order, entries and directions stay as far as
        the rules allow, and the new plan costs no more than that.
    first
        Give the first lawful plan, which a moment's search finds, and stop: each cut says which orders it keeps, and
        not what would be without them. Moves over parts that are out cost nothing then. From a `start` it is that plan,
        with all the entries and ways round that are lawful still.
    date
        Day that the program says at its top, as "2026-12-24"; "" for that of the job file.
    on_progress
        Called now and then with what the engines have reached, perhaps from a thread of theirs. Return False to stop
        with the best plan so far. An exception that it raises ends the planning and is raised by `solve`.

    Returns
    -------
    Result
        Plan, program, verdict; what is proven; `explain`, `picture`, `to_frame`, `save`.

    Raises
    ------
    Questions
        If the drawing raises questions that nobody has answered.
    InputError
        If something given cannot be used.
    NoPlan
        If the hard rules cannot all hold, or no plan was found in time. Its `conflict` has the statements that
        contradict each other and the cheapest way out. Its text says the same in sentences. To find them takes at
        most as long as the limits again. It is a `RulesConflict`.
    RulesConflict
        If contours cannot be cut at all, and hard rules cannot hold in any order.
    KeyboardInterrupt
        If Ctrl-C was pressed before there was a plan.

    Examples
    --------
    >>> import kerfwise
    >>> result = kerfwise.solve("examples/nests/e1x_6.json", locks="part#4.outer position last", work=2)
    >>> result.ok, result.status, result.plan.cuts[-1].cut.contour
    (True, 'optimal', 'part#4.outer')
    >>> result.program.splitlines()[0]
    '(KERFWISE FOR LINUXCNC, QTPLASMAC)'
    """
    notes: list[str] = []
    inputs = inputs_for(nest, nest_request(profile, job, settings, locks, resume_from, answers, date), notes.append)
    engine = OLD_NAMES.get(engine, engine)
    limits = options_for(
        inputs.nest, inputs.profile,
        work=work, seed=seed, time_s=time_s, gap=gap, no_improvement_s=no_improvement_s, engine=engine,
        memory_gb=memory_gb,
    )  # fmt: skip
    if strategy not in STRATEGIES:
        raise InputError(unknown("strategy", str(strategy), STRATEGIES))
    listener = Listener(on_progress)
    orders: OrdersOf | None = None
    at_hand = None if start is None else plan_of(start)
    if inputs.profile.objective.distortion:
        orders = app_module("distortion.straighter").straighter_for(inputs.profile, at_hand)
    try:
        done = plan_nest(
            inputs,
            limits,
            Method(engine, solver, strategy, at_hand, first, orders),
            Watchers(listener, notes.append),
            already=already_cut_by(inputs, resume_from, upto, redo_last, notes),
            relax=relax,
        )
    except NoPlan:
        if listener.interrupted:
            raise KeyboardInterrupt from None
        raise
    verified, cut = done.made, done.given
    all_notes = (*notes, *verified.notes)
    return Result(
        cut.nest,
        cut.profile,
        verified.plan,
        verified.program,
        verified.verdict,
        done.facts,
        all_notes,
        listener.stopped,
    )


def conflict(
    nest: NestLike,
    profile: ProfileLike | None = None,
    *,
    locks: Iterable[LockLike] | LockLike = (),
    job: JobLike = None,
    settings: Settings = (),
    time_s: float | None = None,
    work: float = WORK,
) -> Conflict | None:
    """Find out whether the hard rules contradict each other, without planning.

    Parameters
    ----------
    nest, profile, locks, job, settings
        As for `solve`.
    time_s, work
        How long to look, as for `solve`.

    Returns
    -------
    Conflict or None
        Statements that cannot all hold, none to be left out, and the cheapest way out; None where no contradiction was
        shown. Print it to read it; `contours` can be drawn with `draw(nest, contours=…)`.

    Raises
    ------
    InputError
        If something given cannot be used.
    RulesConflict
        If contours cannot be cut at all, and hard rules cannot hold in any order.
    KerfwiseError
        If the limits were too short to show either.

    Examples
    --------
    >>> import kerfwise
    >>> nest = kerfwise.read_nest("examples/nests/e1x_6.json")
    >>> found = kerfwise.conflict(nest, locks=["part#1.outer position first", "part#3.outer before part#1.outer"])
    >>> sorted(found.contours)
    ['part#1.outer', 'part#3.outer']
    >>> kerfwise.conflict(nest) is None
    True
    """
    inputs = inputs_for(nest, nest_request(profile, job, settings, locks))
    limits = options_for(inputs.nest, inputs.profile, work=work, time_s=time_s)
    known = facts_of(inputs.nest, inputs.profile)
    try:
        return find_conflict(known, inputs.profile, Deadline.of(limits))
    except NotAnswered:
        raise KerfwiseError(f"{NOT_SHOWN}: give more time_s or work") from None


def facts(nest: NestLike, profile: ProfileLike | None = None, *, job: JobLike = None) -> Facts:
    """What the rules are told of a nest: containment, what lies ahead, hulls, neighbours, zones, candidates.

    Parameters
    ----------
    nest, profile, job
        As for `solve`.

    Raises
    ------
    InputError
        If something given cannot be used, or a contour cannot be cut as the profile asks.
    RulesConflict
        If contours cannot be cut at all, and hard rules cannot hold in any order.

    Examples
    --------
    >>> import kerfwise
    >>> found = kerfwise.facts("examples/nests/e1x_6.json")
    >>> found.n, len(found.candidates) > found.n
    (16, True)
    """
    inputs = inputs_for(nest, nest_request(profile, job))
    return facts_of(inputs.nest, inputs.profile)


def already_cut_by(
    inputs: Inputs,
    resume_from: Plan | Result | str | Path | None,
    upto: int | None,
    redo_last: bool,
    notes: list[str],
) -> AlreadyCut:
    """What is cut already; what a user should know of the old plan goes to `notes`."""
    old = None if resume_from is None else plan_or_path(resume_from)
    return already_cut(inputs, old, upto, redo_last, notes.append)
