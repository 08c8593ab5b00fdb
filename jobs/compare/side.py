"""One of the two that are compared: a plan or program from a file, or a plan that is made for it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.jobs.checking import check_made
from kerfwise.jobs.given import Given, Tell, is_plan_file, read_program_of, silent
from kerfwise.jobs.listening import Listener
from kerfwise.jobs.main_job import plan_nest
from kerfwise.jobs.simulation import Simulation, simulate_made
from kerfwise.jobs.solve_options import options_for
from kerfwise.jobs.summary import proof_of
from kerfwise.jobs.times import Times, time_made
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.reader import read_plan
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.check.reader.program import Burn, of_all_torches
from kerfwise.postproc.check.rebuild import rebuild
from kerfwise.postproc.check.torches import stated_spacing
from kerfwise.postproc.nc.plan_paths import toolpaths
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
    given: Given
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
    given: Given
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
    asked: SideAsked, plan: Plan, given: Given, judge: Any, made: Kind, heat: bool, tell: Tell, broken: bool = False
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
    program = of_all_torches(program, torches.shift)
    profile = given.profile.at_origin(program.origin or given.profile.machine.origin)
    home = profile.home_on(given.nest)
    built = rebuild(given.nest, program, profile.material.kerf_mm, home, tabs_asked=profile.tabs())
    found = simulate_made(given, file, tell=tell) if heat else None
    return Side(
        asked.name, "program", given, built.cuts, time_made(given, file, tell), check_made(given, file, tell), found,
        None, program.burns, home, program.end,
    )  # fmt: skip
