"""What the main job gives back: the plan, its program, the verdict, and all that can be asked of them."""

from __future__ import annotations

import html
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from kerfwise.app_modules import app_module
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nest import Nest
from kerfwise.models.engines.solution import Status
from kerfwise.models.plan.explain.explain import Explanation
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.output_files import expect_outputs, make_folder, remnant_files, write_files
from kerfwise.postproc.report import draw
from kerfwise.rules.plan_state import PlanState
from kerfwise.rules.profile.profile import Profile

from .display import CUT_COLUMNS, Picture, PictureKind, cut_rows, data_frame, proof_of, summary
from .explainer import Explainer
from .inputs import Inputs

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True, eq=False, repr=False)
class Result:
    """A planned nest.

    `print(result)` says what `kerfwise solve` prints; as the last line of a notebook's cell it shows the picture.

    Attributes
    ----------
    nest, profile
        The nest as the profile has it cut, and the profile with the locks that were given.
    plan
        Which contour when, where and which way round, with a reason for every position.
    program
        The NC program, as text.
    verdict
        What the independent check says of plan and program, rule by rule.
    facts
        What the rules were told of the nest.
    notes
        What took long, which engines ran, which did not, and why.
    interrupted
        Whether Ctrl-C, or the progress callback, ended the planning: the plan is the best so far.
    """

    nest: Nest
    profile: Profile
    plan: Plan
    program: str
    verdict: CheckResult
    facts: Facts
    notes: tuple[str, ...] = ()
    interrupted: bool = False

    @property
    def ok(self) -> bool:
        """Whether the check passes the plan: every hard rule holds, but for the places that `state` names."""
        return self.verdict.ok

    @property
    def state(self) -> PlanState:
        """Whether every hard rule holds without exception, but for some places, or not: `kind`, `places`, `words()`."""
        return self.verdict.state

    @property
    def status(self) -> Status:
        """ "optimal" where no plan is better, else "feasible"."""
        return self.plan.solve.status

    @property
    def objective(self) -> float:
        """What the plan costs, mm of idle travel; soft rules that it breaks weigh in."""
        return self.plan.solve.objective

    @property
    def bound(self) -> float | None:
        """No plan costs less than this, mm of idle travel; None where nothing is proven."""
        return self.plan.solve.bound

    @property
    def gap(self) -> float | None:
        """(objective - bound) / objective; None where nothing is proven."""
        return self.plan.solve.gap

    def explain(self, contour: str) -> Explanation:
        """Why a contour is cut where it is, then, and so, and what moving it would cost; print it to read it.

        Raises InputError if the plan does not cut such a contour; the nearest id is named.
        """
        return self._explainer.explain(contour)

    @property
    def _explainer(self) -> Explainer:
        explainer = self.__dict__.get("_made_explainer")
        if explainer is None:
            explainer = self.__dict__["_made_explainer"] = Explainer(
                Inputs(self.nest, self.profile), self.plan, self.facts
            )
        return explainer

    def picture(self, kind: PictureKind = "svg") -> Picture:
        """Order numbers, zones, pierces, leads, directions and idle travel; html is a page with all that is known.

        Raises InputError for another kind of picture.
        """
        if kind == "html":
            page = app_module("viewer.page.page_data")
            data = page.page_data(Inputs(self.nest, self.profile), self.plan, self.verdict, self.program)
            return Picture(page.page_bytes(data), kind)
        return Picture(draw(self.nest, self.plan, f".{kind}", self.profile.home_on(self.nest)), kind)

    def to_frame(self) -> pandas.DataFrame:
        """The cuts as a table, a row each: lengths in mm, times in s from the program's start.

        Raises InputError if pandas is not installed.
        """
        return data_frame(list(cut_rows(self.plan)), CUT_COLUMNS)

    def save(self, folder: str | Path, name: str | None = None) -> tuple[Path, Path, Path]:
        """Write NAME.nc, NAME.plan.json and NAME.svg to a folder, all of them or none; the name is the nest's.

        Where the profile asks for a remnant, its two files are written beside the program.

        Raises
        ------
        RulesConflict
            If the check refuses the plan: nothing that breaks a hard rule is written.
        InputError
            If the files cannot be written.
        """
        if not self.ok:
            broken = [self.verdict.rule(rule) for rule in self.verdict.broken()]
            verdicts = [(j.id, [v.text for v in j.violations] or [j.unjudged or ""]) for j in broken]
            reasons = tuple(f"{name}: {text}" for name, texts in verdicts for text in texts)
            raise RulesConflict("the check refuses this plan; nothing was written", reasons)
        folder, name = Path(folder), name or Path(self.nest.file or "nest").stem
        contents: dict[str, str | bytes] = {
            ".nc": self.program,
            ".plan.json": self.plan.to_json(),
            ".svg": self.picture().content,
        }
        paths = {suffix: folder / f"{name}{suffix}" for suffix in contents}
        files = {paths[suffix]: content for suffix, content in contents.items()}
        files |= remnant_files(paths[".nc"], self.nest, self.profile)
        make_folder(folder)
        expect_outputs(files, ())
        write_files(files)
        return paths[".nc"], paths[".plan.json"], paths[".svg"]

    def __repr__(self) -> str:
        idle_m = self.plan.totals.idle_mm / 1000
        return f"<Result: {len(self.plan.cuts)} contours, idle {idle_m:.3f} m, {self.status}>"

    def __str__(self) -> str:
        return summary(self.plan, self.verdict)

    def _repr_html_(self) -> str:
        totals = self.plan.totals
        rows = {
            "contours": str(len(self.plan.cuts)),
            "cut": f"{totals.cut_mm / 1000:.3f} m",
            "idle": f"{totals.idle_mm / 1000:.3f} m",
            "time": f"{totals.time_s:.0f} s",
            "plan": proof_of(self.plan),
            "check": self.state.words(),
        }
        cells = "".join(f"<tr><th>{head}</th><td>{html.escape(text)}</td></tr>" for head, text in rows.items())
        return f"{self.picture().html()}<table>{cells}</table>"
