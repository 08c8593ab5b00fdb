"""kerfwise time: how long a plan or a program takes, on what, and what that costs."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import click

from .given import given_options, note_if_others, read_given, read_program_of

if TYPE_CHECKING:
    from kerfwise.models.physics.timing.cost import Cost
    from kerfwise.models.physics.timing.run import Job
    from kerfwise.postproc.clock.timed import Timed
    from kerfwise.rules.profile.profile import Profile

_FEEDS_DIFFER = 0.01
"""Share by which the program's own feeds may differ from the profile's before that is said."""


@click.command()
@given_options
@click.option("--json", "as_json", is_flag=True, help="Print cut_s, idle_s, pierce_s, total_s, idle_share, nc_blocks.")
@click.argument("made", metavar="PLAN.json|OUT.nc")
def command(made: str, as_json: bool, **given: Any) -> None:
    """Say how long a plan or an NC program of NEST takes by the profile's time model, and what it costs."""
    from kerfwise.models.physics.timing.cost import cost_of
    from kerfwise.models.plan.reader import read_plan
    from kerfwise.postproc.clock.timed import job_of_plan, job_of_program, time_job

    asked = read_given(**given)
    nest, profile = asked.nest, asked.profile
    if made.endswith(".json"):
        plan = read_plan(made)
        job = job_of_plan(plan, nest, profile)
        note_if_others(plan, asked)
    else:
        program = read_program_of(made, asked)
        by_itself = profile.time.model == "constant"
        own, job = job_of_program(program, nest, profile), job_of_program(program, nest)
        _note_if_its_times_differ(own, job, profile, "its own" if by_itself else "the profile's model")
        job = own if by_itself else job
    timed = time_job(job, profile)
    cost = cost_of(timed.times, profile.prices)
    click.echo(json.dumps(_data(timed, cost)) if as_json else _table(timed, cost))


def _note_if_its_times_differ(own: Job, job: Job, profile: Profile, taken: str) -> None:
    """Say on standard error where a program moves or stands for other times than the profile's feeds make."""
    from kerfwise.models.physics.timing.choose import machine_feeds
    from kerfwise.models.physics.timing.clock import times_of
    from kerfwise.models.physics.timing.constant import ConstantFeed

    feeds = machine_feeds(profile)
    said, asked = (times_of(made, ConstantFeed(feeds), feeds) for made in (own, job))
    for does, own_s, set_s in (("cuts", said.cut_s, asked.cut_s), ("pierces", said.pierce_s, asked.pierce_s)):
        if abs(own_s - set_s) > _FEEDS_DIFFER * set_s:
            note = f"by its own words the program {does} for {own_s:.1f} s, at the profile's feeds for {set_s:.1f} s"
            click.echo(f"note: {note}; the times below are by {taken}", err=True)


def _data(timed: Timed, cost: Cost | None) -> dict[str, Any]:
    data = timed.report.as_json()
    if cost is not None:
        rounded = {name: round(getattr(cost, name), 4) for name in ("machine", "gas", "total")}
        data["cost"] = rounded | {"currency": cost.currency}
    return data


def _table(timed: Timed, cost: Cost | None) -> str:
    job, said = timed.job, timed.report
    rows = [
        ("cut", said.cut_s, f"{job.on_mm / 1000:.3f} m"),
        ("idle", said.idle_s, f"{job.idle_mm / 1000:.3f} m, {said.idle_share:.1%} of the time"),
        ("pierce", said.pierce_s, f"{job.pierces} pierces"),
        *([("wait", said.dwell_s, "for metal to cool, the torch off")] if said.dwell_s else []),
        ("total", said.total_s, f"{said.nc_blocks} NC blocks, {said.model}"),
    ]
    lines = [f"{name:7} {seconds:9.1f} s   {text}" for name, seconds, text in rows]
    if cost is not None:
        parts = f"machine {cost.machine:.2f}, gas {cost.gas:.2f}"
        lines.append(f"{'cost':7} {cost.total:9.2f} {cost.currency}, a sheet: {parts}")
    return "\n".join(lines)
