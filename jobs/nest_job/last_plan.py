"""The last plan of a nest, in which a planner has seen that cut 7 is P3.outer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from kerfwise.encoder.contents import is_file
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.given import is_plan_file, program_text
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.reader import read_plan
from kerfwise.postproc.check.reader.on_machine import read_on_machine
from kerfwise.postproc.check.rebuild import rebuild
from kerfwise.rules.profile.for_one_nest import ForOneNest
from kerfwise.rules.profile.profile import Profile


@dataclass(frozen=True, slots=True)
class LastPlan:
    """A plan's or program's name, its contours by number, and what it was made with beside nest and profile."""

    name: str
    cuts: Mapping[int, str]
    made_with: ForOneNest | None = field(default=None)

    def contour(self, name: str, made_with: ForOneNest) -> str:
        """The contour that a number such as #7 stands for.

        A lock on #7 changes the plan, so that #7 is another cut of it. Where the plan was made with the same job file
        and the same locks as now, #7 stays what it was then.

        Raises
        ------
        InputError
            If there are fewer cuts.
        """
        old = self.made_with
        if old is not None and (old.sha256, old.locks) == (made_with.sha256, made_with.locks) and name in old.numbered:
            return old.numbered[name]
        number = int(name.removeprefix("#"))
        if number not in self.cuts:
            raise InputError(f"{name}: {self.name} has {len(self.cuts)} cuts only")
        return self.cuts[number]


def last_plan(given: Plan | str | Path | None, nest: Nest, nest_file: str | Path | None, profile: Profile) -> LastPlan:
    """The plan or program that is given, or else the plan beside the nest, or in the folder that kerfwise is run in.

    Raises
    ------
    InputError
        If there is none, or it cannot be read.
    """
    if isinstance(given, Plan):
        return of_plan(given, "the plan")
    if given is None:
        stem = Path(nest_file).stem if nest_file else ""
        places = [Path(nest_file or "").with_name(f"{stem}.plan.json"), Path(f"{stem}.plan.json")] if stem else []
        given = next((place for place in places if is_file(place)), None)
        if given is None:
            looked = f" ({places[0]})" if places else ""
            raise InputError(
                f"#N is cut N of the last plan, and there is none beside the nest{looked}: plan it first, or name the "
                "plan with --lock-from (in Python: resume_from)"
            )
    if is_plan_file(given):
        return of_plan(read_plan(given), str(given))
    program = read_on_machine(program_text(given), nest, profile, str(given))
    cuts = rebuild(nest, program, profile.material.kerf_mm, profile.home_on(nest)).cuts
    return LastPlan(str(given), {k: cut.contour for k, cut in enumerate(cuts, 1)})


def of_plan(plan: Plan, name: str) -> LastPlan:
    """The same of a plan."""
    cuts = (*plan.already_cut, *plan.cuts)
    return LastPlan(name, {k: made.cut.contour for k, made in enumerate(cuts, 1)}, plan.made_with)
