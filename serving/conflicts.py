"""Why there is no plan, as the page shows it: each statement of a contradiction, and what may undo it."""

from __future__ import annotations

from typing import Any

from kerfwise.encoder.shown import shown, shown_lines
from kerfwise.jobs.nest_job.job import Job
from kerfwise.jobs.no_plan import NoPlan
from kerfwise.rules.profile.lock_text import lines_of
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import About

MOST = 40
"""Statements that are listed; a contradiction of more is shown in part, and says so."""


def conflict_told(no_plan: NoPlan, job: Job | None) -> dict[str, Any]:
    """The conflict as JSON.

    `clash` is what was found, `minimal` if nothing of it can be left out, or `alone` where no plan can keep any of it.
    Each statement has `undo`, the lines of the job file that make it, and `soften`, the change of the job file that
    makes its rule soft; either is empty where there is none. `relax` is the cheapest way out of all contradictions,
    which `kerfwise solve --relax` takes, or one that relaxes as few statements where not all were `compared`; None
    where nothing helps.
    """
    conflict = no_plan.conflict
    if conflict is None:
        return {"text": shown_lines(str(no_plan)), "clash": [], "relax": None, "notes": [], "minimal": False}
    return {
        "text": shown_lines(str(conflict)),
        "minimal": conflict.minimal,
        "alone": conflict.alone,
        "more": max(0, len(conflict.clash) - MOST),
        "clash": [_statement(about, no_plan.profile, job) for about in conflict.clash[:MOST]],
        "compared": conflict.compared,
        "relax": None if conflict.relax is None else [_said(about) for about in conflict.relax],
        "stuck": shown(conflict.stuck),
        "notes": [shown(note) for note in conflict.notes],
    }


def first_told(no_plan: NoPlan, job: Job | None) -> str:
    """The first sentence of the contradiction, or all there is to say where none was shown."""
    conflict = conflict_told(no_plan, job)
    text: str = conflict["clash"][0]["text"] if conflict["clash"] else conflict["text"]
    return text


def _said(about: About) -> dict[str, Any]:
    return {"rule": about.rule, "contours": list(about.contours), "text": shown(about.sentence)}


def _statement(about: About, profile: Profile, job: Job | None) -> dict[str, Any]:
    locks = () if job is None else job.locks
    undo = [line for lock in locks if about.sentence.endswith(lock.because) for line in lines_of(lock)]
    rule = profile.known_rules().get(about.rule)
    soften: list[dict[str, str]] = []
    if rule is not None and "soft" in rule.strengths and about.rule in profile.rules:
        soften = [{"set": f"rules.{about.rule}.strength", "to": "soft"}]
    return {**_said(about), "undo": [{"unlock": line} for line in undo], "soften": soften}
