"""The Python interface: everything that `import kerfwise` gives.

A nest is planned in three lines:

>>> import kerfwise
>>> result = kerfwise.solve("examples/nests/e1x_6.json", "plasma-carbon-steel", work=2)  # doctest: +SKIP
>>> paths = result.save("out")  # doctest: +SKIP

Nests and profiles are objects, or what they are read from: the path of a nest, the name of a shipped profile, the path
of a plant's own. Lengths are mm, times s, temperatures °C, speeds mm/s.

Threads: functions and what they return keep no state of their own and may be used by several threads at once. `solve`
takes Ctrl-C in the main thread only; in another, stop it by a False from `on_progress`. The engines use two threads of
their own, so that processes serve better than threads where many nests are planned.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kerfwise.encoder.errors import InputError, KerfwiseError, RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.ask import facts_of
from kerfwise.jobs.checking import check_made
from kerfwise.jobs.explaining import Explainer
from kerfwise.jobs.given import NestLike, ProfileLike, drawn_nest, given_of, plant_of
from kerfwise.jobs.listening import Listener, OnProgress, Reached
from kerfwise.jobs.main_job import plan_nest
from kerfwise.jobs.no_plan import NOT_SHOWN, NoPlan
from kerfwise.jobs.picture import Picture, PictureKind
from kerfwise.jobs.prices import PRICES_MM
from kerfwise.jobs.result import Result
from kerfwise.jobs.simulation import Simulation, simulate_made
from kerfwise.jobs.solve_options import WORK, options_for
from kerfwise.jobs.stopped import already_cut
from kerfwise.jobs.times import Times, time_made
from kerfwise.jobs.trade_off import Offer
from kerfwise.jobs.trade_off import trade_off as made_trade_off
from kerfwise.models.engines.baselines import STRATEGIES, Strategy
from kerfwise.models.engines.names import OLD_NAMES, Engine
from kerfwise.models.plan.conflict import Conflict, NotAnswered, Purse, find_conflict
from kerfwise.models.plan.explain import Explanation
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.reader import read_plan as read_plan_file
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.report import draw as drawn
from kerfwise.postproc.report.picture import Spot
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.profile.lock_text import read_lock
from kerfwise.rules.profile.profile import DEFAULT, Profile

if TYPE_CHECKING:
    from kerfwise.encoder.readers.options import Frame
    from kerfwise.rules.profile.heat_section import HeatModel

__all__ = [
    "CheckResult",
    "Conflict",
    "Explanation",
    "InputError",
    "KerfwiseError",
    "Lock",
    "Nest",
    "NoPlan",
    "Offer",
    "Picture",
    "Plan",
    "Profile",
    "Reached",
    "Result",
    "RulesConflict",
    "Simulation",
    "Times",
    "check",
    "conflict",
    "draw",
    "explain",
    "facts",
    "load_profile",
    "read_nest",
    "read_plan",
    "simulate",
    "solve",
    "times",
    "trade_off",
]

LockLike = Lock | str | Mapping[str, Any]
"""A lock, a line such as `P1.outer before P2.outer`, or a mapping as in a profile."""
Made = Result | Plan | str | Path
"""A result, a plan, or the path of a plan (.json) or of an NC program."""


def read_nest(
    path: str | Path,
    profile: ProfileLike = DEFAULT,
    *,
    units: str | None = None,
    sheet_mm: tuple[float, float] | None = None,
    frame: Frame | None = None,
    repair: bool = False,
) -> Nest:
    """Read a nest from a DXF, SVG or JSON file, by the layers and units that the profile's section `drawing` names.

    Parameters
    ----------
    path
        The file; its ending says which kind it is.
    profile
        Name, path or object.
    units
        Of the drawing, instead of its own: mm, cm, m, in or ft.
    sheet_mm
        Width and height of the sheet, where the drawing has no outline for it.
    frame
        What one rectangle around everything is, "sheet" or "part", where no layer is the sheet's.
    repair
        Mend what can be mended.

    Returns
    -------
    Nest
        In mm, y up, as it is drawn; `notes` say what was doubtful and what was mended, `contours` lists what is cut.

    Raises
    ------
    InputError
        If the file cannot be read, or what it holds cannot be cut; the one error lists all that is wrong.

    Examples
    --------
    >>> import kerfwise
    >>> nest = kerfwise.read_nest("examples/nests/e1x_6.json")
    >>> len(nest.parts), len(nest.contours), nest.contours[0].id
    (8, 16, 'part#1.hole1')
    """
    return drawn_nest(path, plant_of(profile), units=units, sheet_mm=sheet_mm, frame=frame, repair=repair)


def load_profile(profile: str | Path = DEFAULT, *, locks: Iterable[LockLike] | LockLike = ()) -> Profile:
    """Load a plant's profile: the shipped one of that name, or the one in that file.

    Parameters
    ----------
    profile
        Name or path.
    locks
        Locks beside those of the profile: see `solve`.

    Raises
    ------
    InputError
        If there is none (with the nearest name), or it is wrong anywhere: with file, line and column.

    Examples
    --------
    >>> import kerfwise
    >>> profile = kerfwise.load_profile("laser-wood")
    >>> profile.material.kerf_mm, profile.rules["level-ahead"].strength
    (0.7, 'hard')
    >>> kerfwise.load_profile("lasr-wood")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    kerfwise.encoder.errors.InputError: unknown profile 'lasr-wood': did you mean 'laser-wood'? ...
    """
    return _locked(plant_of(profile), locks)


def read_plan(path: str | Path) -> Plan:
    """Read a plan that `Result.save` or `kerfwise solve` has written.

    Raises
    ------
    InputError
        If the file cannot be read or is no plan, with line and column.
    """
    return read_plan_file(path)


def solve(
    nest: NestLike,
    profile: ProfileLike = DEFAULT,
    *,
    locks: Iterable[LockLike] | LockLike = (),
    time_s: float | None = None,
    work: float = WORK,
    seed: int = 1,
    gap: float | None = None,
    no_improvement_s: float | None = None,
    engine: Engine = "portfolio",
    solver: str = "gecode",
    strategy: Strategy = "ours",
    relax: bool = False,
    resume_from: Plan | Result | str | Path | None = None,
    upto: int | None = None,
    redo_last: bool = False,
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
        A profile, its name or its path.
    locks
        Decisions of yours, always hard, beside those of the profile: lines such as "P1.outer before P2.outer",
        "P1.outer position first", "P1.outer entry [10, 20]", "P1.outer direction cw", "P1 zone 2"; or `Lock` objects,
        or mappings as in a profile.
    time_s
        Wall-clock limit, s, instead of `work`.
    work
        Deterministic limit: about the seconds that it takes.
    seed
        Of the search.
    gap
        Stop at a plan that is proven this close to the best; 0.01 is 1 %.
    no_improvement_s
        Stop when so many seconds have brought no better plan.
    engine, solver
        Who plans: `kerfwise engines` lists them; `solver` is that of the engine minizinc.
    strategy
        Others than "ours" are to compare with: "shortest", "random", "realtime".
    relax
        Where hard rules clash, let the cheapest statements give way; the plan marks them.
    resume_from, upto, redo_last
        Go on after a stop: the plan (or its file, or that of the NC program) that was stopped, how many of its cuts
        are made, and whether the last of them broke off and is to be cut again.
    on_progress
        Called now and then with what the engines have reached, by a thread of theirs maybe; answer False to stop with
        the best plan so far. What it raises ends the planning and comes out here.

    Returns
    -------
    Result
        Plan, program, verdict; what is proven; `explain`, `picture`, `to_frame`, `save`.

    Raises
    ------
    InputError
        If something given cannot be used.
    NoPlan
        If the hard rules cannot all hold, or no plan was found in time. Its `conflict` has the statements that
        contradict each other and the cheapest way out, its text all of it in sentences. The look for them takes no
        longer than the limits once more. It is a `RulesConflict`.
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
    given = given_of(nest, _locked(plant_of(profile), locks))
    engine = OLD_NAMES.get(engine, engine)
    limits = options_for(
        given.nest, given.profile,
        work=work, seed=seed, time_s=time_s, gap=gap, no_improvement_s=no_improvement_s, engine=engine,
    )  # fmt: skip
    if strategy not in STRATEGIES:
        raise InputError(unknown("strategy", str(strategy), STRATEGIES))
    if (resume_from is None) != (upto is None) or (redo_last and upto is None):
        raise InputError("resume_from and upto go together: which plan was stopped, and how many of its cuts are made")
    old = None if resume_from is None else _plan_or_path(resume_from)
    notes: list[str] = []
    listener = Listener(on_progress)
    try:
        done = plan_nest(
            given, limits,
            already=already_cut(given, old, upto, redo_last, notes.append),
            relax=relax, engine=engine, solver=solver, strategy=strategy, listener=listener, tell=notes.append,
        )  # fmt: skip
    except NoPlan:
        if listener.interrupted:
            raise KeyboardInterrupt from None
        raise
    made, cut = done.made, done.given
    told = (*notes, *made.notes)
    return Result(cut.nest, cut.profile, made.plan, made.program, made.verdict, done.facts, told, listener.stopped)


def check(nest: NestLike, made: Made, profile: ProfileLike = DEFAULT) -> CheckResult:
    """Judge a plan or an NC program by every rule, independently of whatever made it: from geometry and profile alone.

    Parameters
    ----------
    nest
        A nest, or the path of its file.
    made
        A plan, a result, or the path of a plan (.json) or of an NC program.
    profile
        A profile, its name or its path.

    Returns
    -------
    CheckResult
        `ok`, `broken()`, a judgement on each rule in `rules`; print it to read it.

    Raises
    ------
    InputError
        If something given cannot be read or understood, with the line.

    Examples
    --------
    >>> import kerfwise
    >>> nest = kerfwise.read_nest("examples/nests/e1x_6.json")
    >>> result = kerfwise.solve(nest, work=2)
    >>> verdict = kerfwise.check(nest, result.plan)
    >>> verdict.ok, verdict.rule("inner-before-outer").verdict
    (True, 'holds')
    """
    return check_made(given_of(nest, profile), _plan_or_path(made))


def explain(
    nest: NestLike, made: Plan | Result | str | Path, contour: str, profile: ProfileLike = DEFAULT
) -> Explanation:
    """Say why a contour is cut where it is, then, and so, and what moving it would cost.

    `Result.explain` does the same, and is faster where several contours are asked about.

    Parameters
    ----------
    nest, profile
        As for `check`.
    made
        A plan, a result, or the path of a plan.
    contour
        Its id, such as "P1.outer".

    Raises
    ------
    InputError
        If the plan does not cut such a contour (with the nearest id), or something given cannot be used.

    Examples
    --------
    >>> import kerfwise
    >>> nest = kerfwise.read_nest("examples/nests/e1x_6.json")
    >>> told = kerfwise.explain(nest, kerfwise.solve(nest, work=2), "part#1.outer")
    >>> str(told).splitlines()[0]  # doctest: +ELLIPSIS
    'part#1.outer is cut ...'
    """
    return Explainer(given_of(nest, profile), _plan(made)).explain(contour)


def conflict(
    nest: NestLike,
    profile: ProfileLike = DEFAULT,
    *,
    locks: Iterable[LockLike] | LockLike = (),
    time_s: float | None = None,
    work: float = WORK,
) -> Conflict | None:
    """Find out whether the hard rules contradict each other, without planning.

    Parameters
    ----------
    nest, profile, locks
        As for `solve`.
    time_s, work
        Limits of the look.

    Returns
    -------
    Conflict or None
        A smallest set of statements that cannot all hold, and the cheapest way out; None where no contradiction was
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
    given = given_of(nest, _locked(plant_of(profile), locks))
    limits = options_for(given.nest, given.profile, work=work, time_s=time_s)
    known = facts_of(given.nest, given.profile)
    try:
        return find_conflict(known, given.profile, Purse.of(limits))
    except NotAnswered:
        raise KerfwiseError(f"{NOT_SHOWN}: give more time_s or work") from None


def facts(nest: NestLike, profile: ProfileLike = DEFAULT) -> Facts:
    """What the rules are told of a nest: containment, what lies ahead, hulls, neighbours, zones, candidates.

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
    given = given_of(nest, profile)
    return facts_of(given.nest, given.profile)


def times(nest: NestLike, made: Made, profile: ProfileLike = DEFAULT) -> Times:
    """Say how long a plan or an NC program takes by the profile's time model, and what it costs.

    Parameters
    ----------
    nest, made, profile
        As for `check`.

    Returns
    -------
    Times
        `total_s`, `report` with what the seconds are spent on, `cost`; print it to read it.

    Raises
    ------
    InputError
        If something given cannot be read or is of another nest.

    Examples
    --------
    >>> import kerfwise
    >>> nest = kerfwise.read_nest("examples/nests/e1x_6.json")
    >>> took = kerfwise.times(nest, kerfwise.solve(nest, work=2))
    >>> took.total_s > took.report.cut_s > 0
    True
    """
    return time_made(given_of(nest, profile), _plan_or_path(made))


def simulate(
    nest: NestLike, made: Made, profile: ProfileLike = DEFAULT, *, model: HeatModel | None = None
) -> Simulation:
    """Simulate how hot a plan or an NC program makes the sheet.

    Parameters
    ----------
    nest, made, profile
        As for `check`; the profile's section `heat` says how fine the grid is and how hot is too hot.
    model
        "physical" or "logical", instead of the profile's.

    Returns
    -------
    Simulation
        `overheats`, `peak_c`, `parts`; `found.run.peak_c` is the map (nx, ny), °C; `picture()` draws it.

    Raises
    ------
    InputError
        If something given cannot be read or is of another nest, or the grid does not fit the sheet.

    Examples
    --------
    >>> import kerfwise
    >>> nest = kerfwise.read_nest("examples/nests/e1x_6.json")
    >>> heat = kerfwise.simulate(nest, kerfwise.solve(nest, work=2))
    >>> heat.peak_c > 20, len(heat.parts)
    (True, 8)
    """
    return simulate_made(given_of(nest, profile), _plan_or_path(made), model)


def trade_off(
    nest: NestLike,
    profile: ProfileLike = DEFAULT,
    *,
    prices_mm: Iterable[float] = PRICES_MM,
    work: float = 10.0,
    seed: int = 1,
    on_progress: OnProgress | None = None,
) -> Offer:
    """Plan a nest at several prices of an overheat, and simulate every plan: idle travel against overheats.

    Parameters
    ----------
    nest, profile
        As for `solve`.
    prices_mm
        Of an overheat, mm of idle travel.
    work, seed
        Of each plan, as for `solve`.
    on_progress
        As for `solve`.

    Returns
    -------
    Offer
        `trades`, and `front`: those of them that no other beats; `picture()`, `to_frame()`, `save(folder)`.

    Raises
    ------
    InputError
        If something given cannot be used.
    RulesConflict
        If the rules leave no plan at all.

    Examples
    --------
    >>> import kerfwise
    >>> offer = kerfwise.trade_off("examples/nests/e1x_6.json", prices_mm=[0], work=1)
    >>> len(offer.front)
    1
    """
    given = given_of(nest, profile)
    prices = tuple(prices_mm)
    for price in prices:
        if not isinstance(price, int | float) or not 0 <= price < float("inf"):
            raise InputError(f"prices_mm: expected numbers from 0, got {price!r}")
    limits = options_for(given.nest, given.profile, work=work, seed=seed)
    return made_trade_off(given, prices, limits, lambda: Listener(on_progress), given.nest.file)


def draw(
    nest: NestLike,
    made: Plan | Result | str | Path | None = None,
    profile: ProfileLike = DEFAULT,
    *,
    kind: PictureKind = "svg",
    contours: Iterable[str] = (),
    caption: str = "",
) -> Picture:
    """Draw a nest, or a plan of it, or some contours of it, large.

    Parameters
    ----------
    nest, profile
        As for `check`.
    made
        A plan, a result, or the path of a plan; without one the parts have their names.
    kind
        "svg", "png", or "html" for a page that plays the cuts in order.
    contours
        Ids of those to draw large, in red, with what is around them.
    caption
        A sentence on why.

    Returns
    -------
    Picture
        A notebook shows it; `save(path)` writes it.

    Raises
    ------
    InputError
        If something given cannot be used, or the plan or the contours are not of this nest.

    Examples
    --------
    >>> import kerfwise
    >>> kerfwise.draw("examples/nests/e1x_6.json").content[:4]
    b'<svg'
    """
    given = given_of(nest, profile)
    plan = None if made is None else _plan(made)
    plant = given.profile if plan is None else given.profile.at_origin(plan.origin)
    named = frozenset([contours] if isinstance(contours, str) else contours)
    spot = Spot(named, caption) if named else None
    return Picture(drawn(given.nest, plan, f".{kind}", plant.home_on(given.nest), spot), kind)


def _plan_or_path(made: Made) -> Plan | str | Path:
    if isinstance(made, Plan | str | Path):
        return made
    if isinstance(made, Result):
        return made.plan
    raise InputError(f"expected a plan, a result or a path, got {type(made).__name__}")


def _plan(made: Made) -> Plan:
    found = _plan_or_path(made)
    return found if isinstance(found, Plan) else read_plan(found)


def _locked(profile: Profile, locks: Iterable[LockLike] | LockLike) -> Profile:
    """The profile with further locks."""
    listed = [locks] if isinstance(locks, Lock | str | Mapping) else list(locks)
    return replace(profile, locks=(*profile.locks, *map(_lock, listed))) if listed else profile


def _lock(given: LockLike) -> Lock:
    if isinstance(given, str):
        return read_lock(given)
    if isinstance(given, Mapping):
        import json

        return read_lock(json.dumps(dict(given), ensure_ascii=False))
    if not isinstance(given, Lock):
        raise InputError(f"locks: expected a Lock, a line of text or a mapping, got {type(given).__name__}")
    if wrong := given.wrong():
        raise InputError(wrong)
    return given
