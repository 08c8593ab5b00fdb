"""From nests to programs: every sheet planned, judged, and its files made."""

from __future__ import annotations

import hashlib
from dataclasses import replace

from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.encoder.validate import validated
from kerfwise.jobs.batch.figures import clock, metres
from kerfwise.jobs.given import Given
from kerfwise.jobs.listening import Listener
from kerfwise.jobs.main_job import Finished, plan_nest
from kerfwise.jobs.solve_options import options_for
from kerfwise.jobs.times import time_made
from kerfwise.postproc.nc.remnant import remnant_files
from kerfwise.postproc.report import draw
from kerfwise.rules.profile.profile import Profile


def _as_read(name: str, text: str) -> Nest:
    """The nest in a text that is to be written under a name."""
    data = text.encode()
    nest = validated(read_json(data, ReadOptions()))
    return replace(nest, file=f"{name}.json", sha256=hashlib.sha256(data).hexdigest())


def plan_sheet(
    name: str, text: str, profile: Profile, work: float, *, relax: bool = False, listener: Listener
) -> Finished:
    """Plan the nest in a text, as `kerfwise solve` would plan its file.

    Raises
    ------
    InputError, RulesConflict
        As `plan_nest` does; also if the check refuses the plan.
    """
    given = Given(profile.as_cut(_as_read(name, text)), profile)
    done = plan_nest(given, options_for(given.nest, profile, work=work), relax=relax, listener=listener)
    if not done.made.verdict.ok:
        raise RulesConflict(f"the check refuses the plan: {', '.join(done.made.verdict.broken())}")
    return done


def program_files(name: str, done: Finished) -> dict[str, str | bytes]:
    """Program, plan and picture of a sheet, and what of it can be used again, by the names that they have."""
    nest, profile, plan = done.given.nest, done.given.profile, done.made.plan
    files: dict[str, str | bytes] = {
        f"{name}.nc": done.made.program,
        f"{name}.plan.json": plan.to_json(),
        f"{name}.svg": draw(nest, plan, ".svg", profile.home_on(nest)),
    }
    return files | {path.name: text for path, text in remnant_files(f"{name}.nc", nest, profile).items()}


def plan_text(name: str, done: Finished) -> str:
    """What the program of a sheet takes, in a line."""
    plan, times = done.made.plan, time_made(done.given, done.made.plan)
    cost = "" if times.cost is None else f", {times.cost.total:.2f} {times.cost.currency}"
    totals = plan.totals
    return (
        f"{name}.nc: {len(plan.cuts)} contours, {totals.pierces} pierces, idle {metres(totals.idle_mm)}, "
        f"{clock(times.total_s)}{cost}"
    )
