"""The two sides that are compared: a plan or program from a file, or a plan that is made for it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Literal

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.jobs.display import proof_of
from kerfwise.jobs.inputs import Inputs, Tell, is_plan_file, read_program_of, silent
from kerfwise.jobs.plan_nest import plan_nest
from kerfwise.jobs.programs import Times, check_made, time_made
from kerfwise.jobs.progress import Listener
from kerfwise.jobs.request import options_for
from kerfwise.jobs.simulation import Simulation, simulate_made
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.read_plan import read_plan
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.check.cuts_from_program import rebuild
from kerfwise.postproc.check.machine_limits import stated_spacing
from kerfwise.postproc.check.reader.program import Burn, expand_torches
from kerfwise.postproc.nc.toolpaths import toolpaths
from kerfwise.rules.profile.overrides import with_rule, without_rule
from kerfwise.rules.profile.profile import Profile

Kind = Literal["plan", "program", "solved"]
Made = Plan | str | Path
"""A plan, or the path of a plan (.json) or of an NC program."""


@dataclass(frozen=True, eq=False, slots=True)
class SideAsked:
    """What one side is to be: the name that the user knows it by, nest and profile, its plan or file, if it has one.

    Without one the nest is planned, within `limits` as `options_for` takes them; `relax` as `plan_nest` does.
    """

    name: str
    given: Inputs
    file: Made | None = None
    limits: dict[str, Any] | None = None
    relax: bool = False


@dataclass(frozen=True, eq=False, slots=True)
class Side:
    """One of two ways to cut a nest.

    Attributes
    ----------
    name
        As the user knows it.
    made
        Whether it is from the file of a plan or of a program, or planned just now.
    given
        The nest and the profile that it is judged by.
    cuts
        Its cuts, as geometry; those made before a stop come first.
    times, verdict, heat
        What it takes, what the check says, and how hot it gets, where that was asked for.
    plan
        None for a program.
    burns, home, end
        What the torch does, and where it starts and ends, in the coordinates of the drawing.
    interrupted
        Whether Ctrl-C, or the progress callback, ended the planning.
    """

    name: str
    made: Kind
    given: Inputs
    cuts: CutSequence
    times: Times
    verdict: CheckResult
    heat: Simulation | None
    plan: Plan | None
    burns: tuple[Burn, ...]
    home: Point
    end: Point
    interrupted: bool = False

    @property
    def profile(self) -> Profile:
        """The profile that it is judged by."""
        return self.given.profile

    @property
    def optimal(self) -> bool:
        """Whether its plan is said to be proven the best, within its own zones and entries."""
        return self.plan is not None and self.plan.solve.status == "optimal"

    @property
    def proof(self) -> str:
        """What is proven of it."""
        if self.plan is None:
            return "a program states no proof"
        said = proof_of(self.plan)
        if self.made == "solved" or self.plan.profile.get("sha256") == self.profile.sha256:
            return said
        return f"{said}, by the profile that it was made with"


def side_of(asked: SideAsked, heat: bool = False, listener: Listener | None = None, tell: Tell = silent) -> Side:
    """Read or plan one side, time it and have it judged.

    Raises
    ------
    InputError
        If its file cannot be read or is one of another nest.
    NoPlan
        If it is to be planned, and no plan keeps the hard rules.
    """
    if asked.file is None:
        return _planned(asked, heat, listener or Listener(), tell)
    if isinstance(asked.file, Plan):
        return _of_plan(asked, asked.file, asked.given, check_made, "plan", heat, tell)
    try:
        if is_plan_file(asked.file):
            return _of_plan(asked, read_plan(asked.file), asked.given, check_made, "plan", heat, tell)
        return _of_program(asked, str(asked.file), heat, tell)
    except InputError as error:
        if error.file is not None:
            raise
        raise InputError(error.message, file=asked.file, details=error.details) from error


def _planned(asked: SideAsked, heat: bool, listener: Listener, tell: Tell) -> Side:
    limits = options_for(asked.given.nest, asked.given.profile, **(asked.limits or {}))
    done = plan_nest(asked.given, limits, relax=asked.relax, listener=listener, tell=tell)
    verdict = done.made.verdict
    return _of_plan(asked, done.made.plan, done.given, lambda *_: verdict, "solved", heat, tell, listener.stopped)


def _of_plan(
    asked: SideAsked, plan: Plan, given: Inputs, judge: Any, made: Kind, heat: bool, tell: Tell, broken: bool = False
) -> Side:
    profile = given.profile.at_origin(plan.origin)
    profile = profile.at_spacing(plan.sequence().spacing_mm(profile.machine.torches.axis))
    paths = toolpaths(plan, given.nest, profile)  # refuses the plan of another nest
    shift = profile.machine.torches.shift
    burns = tuple(
        Burn(
            1 if path.marks else 0, 0, path.path.moved(*shift(cut.torch)), cut.start_s, cut.end_s, cut.contour,
            torch=cut.torch,
        )
        for path in paths
        for cut in (path.planned.cut, *(planned.cut for planned in path.together))
    )  # fmt: skip
    home = profile.home_on(given.nest)
    found = simulate_made(given, plan, tell=tell) if heat else None
    return Side(
        asked.name, made, given, plan.sequence(home), time_made(given, plan, tell), judge(given, plan, tell), found,
        plan, burns, home, home, broken,
    )  # fmt: skip


def _of_program(asked: SideAsked, file: str, heat: bool, tell: Tell) -> Side:
    given = asked.given
    program = read_program_of(file, given, tell)
    torches = given.profile.machine.torches
    torches = given.profile.at_spacing(stated_spacing(program, None, torches)).machine.torches
    program = expand_torches(program, torches.shift)
    profile = given.profile.at_origin(program.origin or given.profile.machine.origin)
    home = profile.home_on(given.nest)
    built = rebuild(given.nest, program, profile.material.kerf_mm, home, tabs_asked=profile.tabs())
    found = simulate_made(given, file, tell=tell) if heat else None
    return Side(
        asked.name, "program", given, built.cuts, time_made(given, file, tell), check_made(given, file, tell), found,
        None, program.burns, home, program.end,
    )  # fmt: skip


# The two sides that are asked for: files or plans, profiles, rules on and off, and what is planned now.

_HOW = (
    "give two plans or programs, or two profiles (-p A -p B, in Python profile and profile_b), or --without RULE, or "
    "--with RULE; one plan or program alone is compared with a new plan"
)
_STRENGTHS: Mapping[str, Literal["hard", "soft"] | None] = {"": None, "hard": "hard", "soft": "soft"}


def expect_two(a: Made | None, b: Made | None, profiles: int, with_: Collection[str], without: Collection[str]) -> None:
    """Refuse what does not say two sides; `profiles` is how many are given.

    Raises
    ------
    InputError
        With what may be given.
    """
    if b is not None and (with_ or without):
        raise InputError("--with and --without (in Python with_ and without) plan B anew: leave B out")
    if a is None and b is not None:
        raise InputError("B is given without A: one plan or program alone is A, compared with a new plan")
    if a is None and profiles < 2 and not (with_ or without):
        raise InputError(f"nothing to compare: {_HOW}")
    if both := [name for name in without if name in {one.partition("=")[0] for one in with_}]:
        raise InputError(f"rule {both[0]} is to be on and off: leave one out")


def pair_of(
    given: tuple[Inputs, Inputs],
    a: Made | None,
    b: Made | None,
    with_: Sequence[str],
    without: Sequence[str],
    limits: dict[str, Any],
    relax: bool,
) -> tuple[SideAsked, SideAsked]:
    """Both sides as they are asked for.

    Parameters
    ----------
    given
        The nest by the profile of A and by that of B; the same object where there is one profile.
    a, b
        Plans or programs; what is None is planned within `limits`, see `SideAsked`.
    with_, without
        Rules, such as `t-max` or `hull-before=soft`, that B is planned with and without.

    Raises
    ------
    InputError
        For a rule that there is not, with the nearest name, or a strength that it cannot have.
    """
    changed, changes = _changed(given[1], with_, without)
    by_profile = tuple(f"by profile {one.profile.name}" for one in given)
    new = "a new plan" if a is not None and given[0] is given[1] else by_profile[1]
    return (
        SideAsked(_named(a, by_profile[0]), given[0], a, limits, relax),
        SideAsked(_named(b, changes or new), changed, b, limits, relax),
    )


def _named(made: Made | None, planned: str) -> str:
    """What the user knows a side by; `planned` is that of one that is planned."""
    if made is None:
        return planned
    return "the plan that is given" if isinstance(made, Plan) else str(made)


def _changed(given: Inputs, with_: Sequence[str], without: Sequence[str]) -> tuple[Inputs, str]:
    """Nest and profile of B, with rules on and off, and what was changed."""
    profile = given.profile
    for text in with_:
        name, _, strength = text.partition("=")
        if strength not in _STRENGTHS:
            raise InputError(f"--with {text}: a rule is on as hard or soft, such as --with {name}=soft")
        profile = _switched(f"--with {text}", partial(with_rule, profile, name, _STRENGTHS[strength]))
    for name in without:
        profile = _switched(f"--without {name}", partial(without_rule, profile, name))
    told = [*(f"with {text}" for text in with_), *(f"without {name}" for name in without)]
    return replace(given, profile=profile), ", ".join(told)


def _switched(option: str, switch: Callable[[], Profile]) -> Profile:
    try:
        return switch()
    except InputError as error:
        raise InputError(f"{option}: {error.message}") from error
