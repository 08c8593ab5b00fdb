"""The two sides that are compared: a plan or program from a file, or a plan that is made for it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Literal

from kerfwise.apps.heat.simulation import Simulation, simulate_made
from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.jobs.display import proof_of
from kerfwise.jobs.inputs import Inputs, Tell, is_plan_file, read_program_of, silent
from kerfwise.jobs.programs import Times, check_made, time_made
from kerfwise.jobs.progress import Listener
from kerfwise.jobs.request import options_for
from kerfwise.models.engines.solution import Limits
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.read_plan import read_plan
from kerfwise.pipeline import Watchers, plan_nest
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.check.bevels import upright
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
    limits: Limits | None = None
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
        text = proof_of(self.plan)
        if self.made == "solved" or self.plan.profile.get("sha256") == self.profile.sha256:
            return text
        return f"{text}, by the profile that it was made with"


def side_of(request: SideAsked, heat: bool = False, listener: Listener | None = None, tell: Tell = silent) -> Side:
    """Read or plan one side, time it and have it judged.

    Raises InputError if its file cannot be read or is one of another nest; NoPlan if it is to be planned, and no plan
    keeps the hard rules.
    """
    if request.file is None:
        return _planned(request, heat, listener or Listener(), tell)
    if isinstance(request.file, Plan):
        return _of_plan(request, request.file, request.given, check_made, "plan", heat, tell)
    try:
        if is_plan_file(request.file):
            return _of_plan(request, read_plan(request.file), request.given, check_made, "plan", heat, tell)
        return _of_program(request, str(request.file), heat, tell)
    except InputError as error:
        if error.file is not None:
            raise
        raise InputError(error.message, file=request.file, details=error.details) from error


def _planned(request: SideAsked, heat: bool, listener: Listener, tell: Tell) -> Side:
    limits = options_for(request.given.nest, request.given.profile, **(request.limits or Limits()))
    done = plan_nest(request.given, limits, watchers=Watchers(listener, tell), relax=request.relax)
    verdict = done.made.verdict
    return _of_plan(request, done.made.plan, done.given, lambda *_: verdict, "solved", heat, tell, listener.stopped)


def _of_plan(
    request: SideAsked, plan: Plan, inputs: Inputs, judge: Any, kind: Kind, heat: bool, tell: Tell, broken: bool = False
) -> Side:
    profile = inputs.profile.at_origin(plan.origin)
    profile = profile.at_spacing(plan.sequence().spacing_mm(profile.machine.torches.axis))
    paths = toolpaths(plan, inputs.nest, profile)  # refuses the plan of another nest
    shift = profile.machine.torches.shift
    burns = tuple(
        Burn(
            1 if path.marks else 0, 0, path.path.moved(*shift(cut.torch)), cut.start_s, cut.end_s, cut.contour,
            torch=cut.torch,
        )
        for path in paths
        for cut in (path.planned.cut, *(planned.cut for planned in path.together))
    )  # fmt: skip
    home = profile.home_on(inputs.nest)
    found = simulate_made(inputs, plan, tell=tell) if heat else None
    return Side(
        request.name, kind, inputs, plan.sequence(home), time_made(inputs, plan, tell), judge(inputs, plan, tell),
        found, plan, burns, home, home, broken,
    )  # fmt: skip


def _of_program(request: SideAsked, file: str, heat: bool, tell: Tell) -> Side:
    inputs = request.given
    program = read_program_of(file, inputs, tell)
    torches = inputs.profile.machine.torches
    torches = inputs.profile.at_spacing(stated_spacing(program, None, torches)).machine.torches
    program = expand_torches(program, torches.shift)
    profile = inputs.profile.at_origin(program.origin or inputs.profile.machine.origin)
    home = profile.home_on(inputs.nest)
    built = rebuild(
        inputs.nest,
        upright(inputs.nest, program, inputs.profile),
        profile.material.kerf_mm,
        home,
        tabs_asked=profile.tabs(),
    )
    found = simulate_made(inputs, file, tell=tell) if heat else None
    return Side(
        request.name, "program", inputs, built.cuts, time_made(inputs, file, tell), check_made(inputs, file, tell),
        found, None, program.burns, home, program.end,
    )  # fmt: skip


# The two sides that are asked for: files or plans, profiles, rules on and off, and what is planned now.

_HOW = (
    "give two plans or programs, or two profiles (-p A -p B, in Python profile and profile_b), or --without RULE, or "
    "--with RULE; one plan or program alone is compared with a new plan"
)
_STRENGTHS: Mapping[str, Literal["hard", "soft"] | None] = {"": None, "hard": "hard", "soft": "soft"}


def expect_two(a: Made | None, b: Made | None, profiles: int, with_: Collection[str], without: Collection[str]) -> None:
    """Refuse what does not say two sides; `profiles` is how many are given.

    Raises InputError with what may be given.
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
    inputs: tuple[Inputs, Inputs],
    a: Made | None,
    b: Made | None,
    with_: Sequence[str],
    without: Sequence[str],
    limits: Limits,
    relax: bool,
) -> tuple[SideAsked, SideAsked]:
    """Both sides as they are asked for.

    Parameters
    ----------
    inputs
        The nest by the profile of A and by that of B; the same object where there is one profile.
    a, b
        Plans or programs; what is None is planned within `limits`, see `SideAsked`.
    with_, without
        Rules, such as `t-max` or `hull-before=soft`, that B is planned with and without.

    Raises InputError for a rule that there is not, with the nearest name, or a strength that it cannot have.
    """
    changed, changes = _changed(inputs[1], with_, without)
    by_profile = tuple(f"by profile {one.profile.name}" for one in inputs)
    new = "a new plan" if a is not None and inputs[0] is inputs[1] else by_profile[1]
    return (
        SideAsked(_named(a, by_profile[0]), inputs[0], a, limits, relax),
        SideAsked(_named(b, changes or new), changed, b, limits, relax),
    )


def _named(kind: Made | None, planned: str) -> str:
    """What the user knows a side by; `planned` is that of one that is planned."""
    if kind is None:
        return planned
    return "the plan that is given" if isinstance(kind, Plan) else str(kind)


def _changed(inputs: Inputs, with_: Sequence[str], without: Sequence[str]) -> tuple[Inputs, str]:
    """Nest and profile of B, with rules on and off, and what was changed."""
    profile = inputs.profile
    for text in with_:
        name, _, strength = text.partition("=")
        if strength not in _STRENGTHS:
            raise InputError(f"--with {text}: a rule is on as hard or soft, such as --with {name}=soft")
        profile = _switched(f"--with {text}", partial(with_rule, profile, name, _STRENGTHS[strength]))
    for name in without:
        profile = _switched(f"--without {name}", partial(without_rule, profile, name))
    words = [*(f"with {text}" for text in with_), *(f"without {name}" for name in without)]
    return replace(inputs, profile=profile), ", ".join(words)


def _switched(option: str, switch: Callable[[], Profile]) -> Profile:
    try:
        return switch()
    except InputError as error:
        raise InputError(f"{option}: {error.message}") from error
