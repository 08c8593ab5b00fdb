"""The process that plans: it tells what is reached as it goes, and keeps what it has loaded for the next plan."""

from __future__ import annotations

import json
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.shown import shown
from kerfwise.jobs.default_names import named_after
from kerfwise.jobs.given import Given
from kerfwise.jobs.listening import Listener, Reached
from kerfwise.jobs.main_job import Finished, plan_nest
from kerfwise.jobs.no_plan import NoPlan
from kerfwise.jobs.page.page import page_data
from kerfwise.jobs.solve_options import WORK, options_for
from kerfwise.jobs.summary import summary_lines
from kerfwise.models.engines.solution import MEMORY_GB
from kerfwise.postproc.nc.remnant import remnant_files
from kerfwise.postproc.report import draw

from .asking import Answers, Asking
from .conflicts import conflict_told, first_told
from .edits import edited
from .effect import Effects
from .figures import figures_of
from .packed import Packed
from .wanted import Wanted, already_of, given_of

TOLD_EACH_S = 0.1
"""What the engines reach is told no more often than this."""
REMEDY_WORK = 0.5
"""Work for a first look at what a way out of a conflict would bring."""
MORE_WORK = 4.0
"""How many times as much goes into the next try, where little work has found no plan and no contradiction."""
SECOND_WORK = 0.2
"""Work for the second of such tries at the least."""


class Planner:
    """Plans what is wanted, exactly as `kerfwise solve` does in the nest's folder."""

    def __init__(self, asking: Asking) -> None:
        self._asking = asking
        self._effects = Effects(self._reached)

    def ready(self) -> bool:
        """Load what planning needs, so that the first plan does not wait for it."""
        import kerfwise.models.engines.rounds  # noqa: F401

        return True

    def solve(
        self, wanted: Wanted, work: float = WORK, relax: bool = False, memory_gb: float = MEMORY_GB
    ) -> dict[str, Any]:
        """The plan with its program, or the conflict; what the engines reach is told meanwhile.

        Where less than the usual work finds neither a plan nor a contradiction, more is taken: `work` says how much.
        """
        self._asking.begin()
        notes: list[str] = []
        given = given_of(wanted)
        listener = Listener(self._reached())
        while True:
            limits = options_for(given.nest, given.profile, work=work, memory_gb=memory_gb)
            try:
                done = plan_nest(
                    given, limits, already=already_of(wanted, given), relax=relax, listener=listener, tell=notes.append
                )
            except NoPlan as no_plan:
                if no_plan.conflict is None and work < WORK and not listener.stopped:
                    work = min(WORK, max(SECOND_WORK, MORE_WORK * work))
                    continue
                return {"conflict": conflict_told(no_plan, given.job)}
            except RulesConflict as error:
                return {"conflict": {"text": str(error), "clash": [], "relax": None, "notes": []}}
            said = {"notes": [*map(shown, notes)], "work": work, "memory_gb": memory_gb}
            return self._planned(wanted, given, done, listener.stopped) | said

    def tried(
        self, wanted: Wanted, changes: list[dict[str, Any]], relax: bool = False, memory_gb: float = MEMORY_GB
    ) -> dict[str, Any]:
        """What a way out of a conflict would bring: a first plan's cost, or the sentence that is left in the way."""
        self._asking.begin()
        given = given_of(wanted)
        text, undone = edited(wanted, given, changes)
        given = given_of(replace(wanted, job_text=text))
        limits = options_for(given.nest, given.profile, work=REMEDY_WORK, memory_gb=memory_gb)
        try:
            done = plan_nest(
                given, limits, already=already_of(wanted, given), relax=relax, listener=Listener(self._reached())
            )
        except NoPlan as no_plan:
            left = first_told(no_plan, given.job)
            return {"works": False, "text": f"another contradiction is left: {left}", "undone": undone}
        except RulesConflict as error:
            return {"works": False, "text": str(error), "undone": undone}
        plan = done.made.plan
        relaxed = sum(dropped.relaxed for dropped in plan.dropped)
        idle_mm = plan.totals.idle_mm
        told = f"a plan with {idle_mm / 1000:.3f} m of idle travel" + (f", {relaxed} relaxed" if relaxed else "")
        return {"works": done.made.verdict.ok, "text": told, "idle_mm": float(idle_mm), "undone": undone}

    def effect(
        self, wanted: Wanted, values: list[tuple[str, str, str]], memory_gb: float = MEMORY_GB
    ) -> dict[str, Any]:
        """What other values of rules would bring: figures with them and without."""
        self._asking.begin()
        return self._effects.effect(wanted, values, memory_gb)

    def _planned(self, wanted: Wanted, given: Given, done: Finished, stopped: bool) -> dict[str, Any]:
        """All that is kept of a plan: its files, and what a list of plans says of it."""
        made, plan = done.made, done.made.plan
        program, plan_file, picture = named_after(Path(wanted.nest))
        drawn = draw(given.nest, plan, ".svg", given.profile.home_on(given.nest))
        remnant = {str(path): text for path, text in remnant_files(program, given.nest, given.profile).items()}
        data = page_data(given, plan, made.verdict, made.program, heat=False, detail="none")
        files = {program: made.program, plan_file: plan.to_json(), picture: drawn.decode("utf-8"), **remnant}
        return {
            "sha256": given.nest.sha256,
            "files": {name: Packed.of(text) for name, text in files.items()},
            "plan_file": plan_file,
            "program_file": program,
            "ok": made.verdict.ok,
            "broken": [*made.verdict.broken()],
            "stopped": stopped,
            "page": Packed.of(json.dumps(data, ensure_ascii=False)),
            "summary": "\n".join(summary_lines(plan)),
            "figures": figures_of(plan),
        }

    def _reached(self) -> Any:
        told_s = 0.0
        last: tuple[float | None, float | None] | None = None

        def heard(reached: Reached) -> bool:
            nonlocal told_s, last
            now_s, new = time.monotonic(), (reached.objective_mm, reached.bound_mm)
            if new != last and now_s - told_s >= TOLD_EACH_S:
                told_s, last = now_s, new
                best, bound = (None if v is None else float(v) for v in new)
                self._asking.tell(
                    engine=reached.engine, objective_mm=best, bound_mm=bound, seconds=float(reached.seconds)
                )
            return not self._asking.stopped

        return heard


def planner(asking: Asking) -> Answers:
    """The questions that the planner answers."""
    made = Planner(asking)
    return {name: getattr(made, name) for name in ("ready", "solve", "tried", "effect")}
