"""The process that plans: it tells what is reached as it goes, and keeps what it has loaded for the next plan."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from kerfwise.apps.viewer.page.page_data import page_data
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.escape import escape_lines, escape_text
from kerfwise.jobs.by_engine import PORTFOLIO
from kerfwise.jobs.display import summary_lines
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.nest_job.job import Job
from kerfwise.jobs.programs import check_made
from kerfwise.jobs.progress import Listener, OnProgress, Reached
from kerfwise.jobs.request import NoPlan, options_for
from kerfwise.models.engines.tuning import MEMORY_GB
from kerfwise.models.engines.tuning import REQUEST_WORK as WORK
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.read_plan import plan_in
from kerfwise.pipeline import VerifiedPlan, Watchers, plan_nest
from kerfwise.postproc.output_files import output_names, remnant_files
from kerfwise.rules.profile.overrides import lines_of
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import About

from .job_edits import edited
from .plan_request import (
    Answers,
    PlanRequest,
    Questions,
    Superseded,
    already_of,
    earlier_plan_name,
    request_inputs,
    start_plan_name,
)
from .plans_shown import MOST_PLANS, PlansShown, RecentFacts, ShownGap, phase_of, told_while_compiling
from .session import Packed

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

    def __init__(self, asking: Questions) -> None:
        self._asking = asking
        self._effects = Effects(self._reached)
        self._facts = RecentFacts()
        self._plans: dict[str, Plan] = {}

    def ready(self) -> bool:
        """Load what planning needs, so that the first plan does not wait for it."""
        import kerfwise.models.engines.solve  # noqa: F401

        return True

    def solve(
        self,
        wanted: PlanRequest,
        work: float = WORK,
        relax: bool = False,
        memory_gb: float = MEMORY_GB,
        start: str | None = None,
    ) -> dict[str, Any]:
        """The plan with its program, or the conflict; better and better plans are told meanwhile, and the phase.

        Where less than the usual work finds neither a plan nor a contradiction, more is taken: `work` says how much.
        `start` is the plan at hand, as JSON: the first plan keeps to it as far as what is wanted lets it, and the
        engines go on from the best plan that is shown so.
        """
        self._asking.begin()
        with told_while_compiling(self._asking):
            try:
                return self._solved(wanted, work, relax, memory_gb, start)
            except Superseded:
                return {"superseded": True}

    def _solved(
        self, wanted: PlanRequest, work: float, relax: bool, memory_gb: float, start: str | None
    ) -> dict[str, Any]:
        self._asking.tell(phase="reading")
        notes: list[str] = []
        inputs = request_inputs(wanted)
        already = already_of(wanted, inputs)
        limits = options_for(inputs.nest, inputs.profile, work=work, memory_gb=memory_gb)

        def kept(verified: VerifiedPlan) -> dict[str, Any]:
            return self._planned(wanted, inputs, verified, False) | {"notes": [], "work": work, "memory_gb": memory_gb}

        shown = PlansShown(self._asking, inputs, already, limits, kept)
        listener = Listener(self._reached(shown.gap))
        if not relax:  # there the engines' first plan is the first: what gives way takes most of the time
            shown.first(None if start is None else self._known(start, wanted), self._facts)
        found, on = None if shown.judged_slowly else shown.found, ""
        if start is not None and shown.best is not None and not shown.unpriced:
            on = shown.best.to_json()  # read again, as the command line reads it
        method = PORTFOLIO._replace(start=plan_in(on)) if on else PORTFOLIO
        while True:
            limits = options_for(inputs.nest, inputs.profile, work=work, memory_gb=memory_gb)
            try:
                done = plan_nest(
                    inputs,
                    limits,
                    method,
                    Watchers(listener, notes.append, found, self._finishing),
                    already=already,
                    relax=relax,
                    facts=shown.facts,
                )
            except NoPlan as no_plan:
                if no_plan.conflict is None and work < WORK and not listener.stopped:
                    work = min(WORK, max(SECOND_WORK, MORE_WORK * work))
                    continue
                return {"conflict": conflict_data(no_plan, inputs.job)}
            except RulesConflict as error:
                return {"conflict": {"text": str(error), "clash": [], "relax": None, "notes": []}}
            planned = self._planned(wanted, inputs, done.made, listener.stopped)
            if on:
                planned["files"][start_plan_name(wanted.nest)] = Packed.of(on)
            return planned | {"notes": [*map(escape_text, notes)], "work": work, "memory_gb": memory_gb}

    def _known(self, text: str, wanted: PlanRequest) -> Plan:
        """A plan by its text: one that was just made is not read."""
        return self._plans.get(text) or plan_in(text, earlier_plan_name(wanted.nest))

    def _finishing(self, plan: Plan) -> None:
        self._asking.go_on()
        self._asking.tell(phase="finishing")

    def tried(
        self, wanted: PlanRequest, changes: list[dict[str, Any]], relax: bool = False, memory_gb: float = MEMORY_GB
    ) -> dict[str, Any]:
        """What a way out of a conflict would bring: a first plan's cost, or the sentence that is left in the way."""
        self._asking.begin()
        inputs = request_inputs(wanted)
        text, undone = edited(wanted, inputs, changes)
        inputs = request_inputs(replace(wanted, job_text=text))
        limits = options_for(inputs.nest, inputs.profile, work=REMEDY_WORK, memory_gb=memory_gb)
        try:
            watchers = Watchers(Listener(self._reached()))
            done = plan_nest(inputs, limits, watchers=watchers, already=already_of(wanted, inputs), relax=relax)
        except NoPlan as no_plan:
            left = first_sentence(no_plan, inputs.job)
            return {"works": False, "text": f"another contradiction is left: {left}", "undone": undone}
        except RulesConflict as error:
            return {"works": False, "text": str(error), "undone": undone}
        plan = done.made.plan
        relaxed = sum(dropped.relaxed for dropped in plan.dropped)
        idle_mm = plan.totals.idle_mm
        sentence = f"a plan with {idle_mm / 1000:.3f} m of idle travel" + (f", {relaxed} relaxed" if relaxed else "")
        return {"works": done.made.verdict.ok, "text": sentence, "idle_mm": float(idle_mm), "undone": undone}

    def effect(
        self, wanted: PlanRequest, values: list[tuple[str, str, str]], memory_gb: float = MEMORY_GB
    ) -> dict[str, Any]:
        """What other values of rules would bring: figures with them and without."""
        self._asking.begin()
        return self._effects.effect(wanted, values, memory_gb)

    def _planned(self, wanted: PlanRequest, inputs: Inputs, made: VerifiedPlan, stopped: bool) -> dict[str, Any]:
        """All that is kept of a plan: its files but for the picture, and what a list of plans says of it."""
        plan, text = made.plan, made.plan.to_json()
        self._plans = {**dict(list(self._plans.items())[1 - MOST_PLANS :]), text: plan}
        program, plan_file, _ = output_names(Path(wanted.nest))
        remnant = {str(path): text for path, text in remnant_files(program, inputs.nest, inputs.profile).items()}
        data = page_data(inputs, plan, made.verdict, made.program, heat=False, detail="none")
        files = {**({program: made.program} if made.program else {}), plan_file: text, **remnant}
        return {
            "sha256": inputs.nest.sha256,
            "files": {name: Packed.of(text) for name, text in files.items()},
            "plan_file": plan_file,
            "program_file": program,
            "ok": made.verdict.ok,
            "checked": bool(made.program),
            "broken": [*made.verdict.broken()],
            "stopped": stopped,
            "page": Packed.of(json.dumps(data, ensure_ascii=False)),
            "summary": "\n".join(summary_lines(plan)),
            "figures": figures_of(plan),
        }

    def _reached(self, gap: ShownGap | None = None) -> OnProgress:
        told_s = 0.0
        last: tuple[str, float | None] | None = None

        def heard(reached: Reached) -> bool:
            nonlocal told_s, last
            known = None if gap is None else gap.hear(reached.objective_mm, reached.bound_mm)
            now_s, new = time.monotonic(), (phase_of(reached.engine), known)
            if new != last and now_s - told_s >= TOLD_EACH_S:
                told_s, last = now_s, new
                self._asking.tell(phase=new[0], gap=known)
            return self._asking.go_on()

        return heard


def planner(asking: Questions) -> Answers:
    """The questions that the planner answers."""
    answers = Planner(asking)
    return {name: getattr(answers, name) for name in ("ready", "solve", "tried", "effect")}


# Why there is no plan, as the page shows it: each statement of a contradiction, and what may undo it.

MOST = 40
"""Statements that are listed; a contradiction of more is shown in part, and says so."""


def conflict_data(no_plan: NoPlan, job: Job | None) -> dict[str, Any]:
    """The conflict as JSON.

    `clash` is what was found, `minimal` if nothing of it can be left out, or `alone` where no plan can keep any of it.
    Each statement has `undo`, the lines of the job file that make it, and `soften`, the change of the job file that
    makes its rule soft; either is empty where there is none. `relax` is the cheapest way out of all contradictions,
    which `kerfwise solve --relax` takes, or one that relaxes as few statements where not all were `compared`; None
    where nothing helps.
    """
    conflict = no_plan.conflict
    if conflict is None:
        return {"text": escape_lines(str(no_plan)), "clash": [], "relax": None, "notes": [], "minimal": False}
    return {
        "text": escape_lines(str(conflict)),
        "minimal": conflict.minimal,
        "alone": conflict.alone,
        "more": max(0, len(conflict.clash) - MOST),
        "clash": [_statement(about, no_plan.profile, job) for about in conflict.clash[:MOST]],
        "compared": conflict.compared,
        "relax": None if conflict.relax is None else [_said(about) for about in conflict.relax],
        "stuck": escape_text(conflict.stuck),
        "notes": [escape_text(note) for note in conflict.notes],
    }


def first_sentence(no_plan: NoPlan, job: Job | None) -> str:
    """The first sentence of the contradiction, or all there is to say where none was shown."""
    conflict = conflict_data(no_plan, job)
    text: str = conflict["clash"][0]["text"] if conflict["clash"] else conflict["text"]
    return text


def _said(about: About) -> dict[str, Any]:
    return {"rule": about.rule, "contours": list(about.contours), "text": escape_text(about.sentence)}


def _statement(about: About, profile: Profile, job: Job | None) -> dict[str, Any]:
    locks = () if job is None else job.locks
    undo = [line for lock in locks if about.sentence.endswith(lock.because) for line in lines_of(lock)]
    rule = profile.known_rules().get(about.rule)
    soften: list[dict[str, str]] = []
    if rule is not None and "soft" in rule.strengths and about.rule in profile.rules:
        soften = [{"set": f"rules.{about.rule}.strength", "to": "soft"}]
    return {**_said(about), "undo": [{"unlock": line} for line in undo], "soften": soften}


# What a list of plans says of one: its cost, what is proven of it, its travel and time.


def figures_of(plan: Plan) -> dict[str, Any]:
    """The figures of a plan, as JSON can hold them: lengths in mm, times in s."""
    solve = plan.solve
    return {
        "objective_mm": float(solve.objective),
        "light_mm": float(solve.objective - plan.heavy_mm),
        "bound_mm": None if solve.bound is None else float(solve.bound),
        "gap": None if solve.gap is None or plan.told_gap is None else float(solve.gap),
        "light_gap": None if plan.light_gap is None else float(plan.light_gap),
        "status": solve.status,
        "state": plan.stated.kind,
        "idle_mm": float(plan.totals.idle_mm),
        "time_s": float(plan.totals.time_s),
        "cuts": len(plan.cuts),
        "excuses": solve.excuses,
        "unkept": plan.stated.count,
        "dropped": len(plan.dropped),
    }


# What other values of rules would bring on a nest: it is planned with them and without, with the same work.

EFFECT_WORK = 1.0
"""Work for each of the two plans: a first look, that is proven only for small nests."""


@dataclass(frozen=True)
class _Planned:
    """A plan with the nest and profile it is of, or why there is none; `whole` where nobody has ended it early."""

    given: Inputs
    plan: Plan | None
    text: str = ""
    whole: bool = True


@dataclass
class Effects:
    """Plans with other values and without; the last one without is kept, for the next question is mostly of it."""

    heard: Callable[[], OnProgress]
    _before: tuple[str, _Planned] | None = field(default=None)

    def effect(
        self, wanted: PlanRequest, values: Sequence[tuple[str, str, str]], memory_gb: float = MEMORY_GB
    ) -> dict[str, Any]:
        """Figures `before` and `after` side by side, None where there is no plan, and then why, as `text`.

        Both have `breaches` by rule, as the profile before judges them: so it is seen what a rule that is switched off
        no longer forbids. `values` are rules, keys and values, as `with_rule_values` takes them.
        """
        before = self._planned_before(wanted, memory_gb)
        changes = [{"set": f"rules.{rule}.{key}", "to": value} for rule, key, value in values]
        text, _ = edited(wanted, before.given, changes)
        after = self._planned(replace(wanted, job_text=text), memory_gb)
        result = {"before": _figures(before.plan, before.given), "after": _figures(after.plan, before.given)}
        return result | {"text": "; ".join(one.text for one in (before, after) if one.text)}

    def _planned_before(self, wanted: PlanRequest, memory_gb: float) -> _Planned:
        if self._before is None or self._before[0] != wanted.key or not self._before[1].whole:
            self._before = wanted.key, self._planned(wanted, memory_gb)
        return self._before[1]

    def _planned(self, wanted: PlanRequest, memory_gb: float) -> _Planned:
        inputs = request_inputs(wanted)
        limits = options_for(inputs.nest, inputs.profile, work=EFFECT_WORK, memory_gb=memory_gb)
        listener = Listener(self.heard())
        try:
            done = plan_nest(inputs, limits, watchers=Watchers(listener), already=already_of(wanted, inputs))
        except NoPlan as no_plan:
            return _Planned(inputs, None, first_sentence(no_plan, inputs.job), whole=not listener.stopped)
        except RulesConflict as error:
            return _Planned(inputs, None, str(error))
        return _Planned(inputs, done.made.plan, whole=not listener.stopped)


def _figures(plan: Plan | None, judged_by: Inputs) -> dict[str, Any] | None:
    if plan is None:
        return None
    broken = {judged.id: len(judged.violations) for judged in check_made(judged_by, plan).rules if judged.violations}
    return {**figures_of(plan), "breaches": broken}
