"""kerfwise solve: the main job, a nest becomes a checked program."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .given import Given, given_options, read_given

if TYPE_CHECKING:
    from ..models.solution import SolveOptions


@click.command()
@given_options
@click.option(
    "-o", "--output", metavar="OUT.nc", help="The program. Without any output named: NEST.nc, .plan.json, .svg."
)
@click.option("--plan", "plan_path", metavar="PLAN.json", help="The plan.")
@click.option("--picture", metavar="OUT.svg|.png|.html", help="A picture of the plan.")
@click.option("--time-limit", type=click.FloatRange(min=0, min_open=True), metavar="S", help="Wall-clock seconds.")
@click.option("--work", type=click.FloatRange(min=0, min_open=True), default=30.0, show_default=True,
              help="Deterministic limit, used without --time-limit: the same work gives the same bytes.")  # fmt: skip
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True, help="Seed of the search.")
@click.option("--engine", type=click.Choice(["cp-sat", "minizinc"]), default="cp-sat", show_default=True)
def command(
    output: str | None,
    plan_path: str | None,
    picture: str | None,
    time_limit: float | None,
    work: float,
    seed: int,
    engine: str,
    **options: Any,
) -> int:
    """Turn NEST into a cutting program that keeps every hard rule of the profile, checked before it is written."""
    from ..models.make_plan import feeds_of
    from ..models.solution import SolveOptions

    given = read_given(**options)
    if output is plan_path is picture is None:
        stem = Path(options["nest"]).stem
        output, plan_path, picture = f"{stem}.nc", f"{stem}.plan.json", f"{stem}.svg"
    limits = SolveOptions(seed, work, time_limit, given.profile.machine.home, feeds_of(given.profile))
    return _solve(given, limits, output, plan_path, picture)


def _solve(given: Given, limits: SolveOptions, output: str | None, plan_path: str | None, picture: str | None) -> int:
    from ..models.make_plan import make_plan
    from ..models.solve import solve
    from ..postproc.checking import judge, report_of
    from ..postproc.files import write_files
    from ..postproc.program import write_program
    from ..postproc.report import draw
    from ..rules.afterthoughts import afterthoughts
    from ..rules.state import state_rules
    from .facts_of import facts_of
    from .progress import listening
    from .summary import summary

    facts = facts_of(given)
    stated = state_rules(facts, given.profile)
    with listening() as ear:
        solution = solve(facts, stated.statements, limits, ear, afterthoughts(facts, given.profile))
    plan = make_plan(facts, given.profile, stated, solution, "cp-sat", limits.seed)
    program = write_program(plan, given.nest, given.profile)
    verdict = judge(given.nest, plan, program, given.profile)
    plan = replace(plan, rules=report_of(verdict))
    click.echo(summary(plan, verdict))
    if not verdict.ok:
        click.echo("kerfwise: the check refuses this plan; nothing was written", err=True)
        return 1
    files: dict[Path, str | bytes] = {}
    if output:
        files[Path(output)] = program
    if plan_path:
        files[Path(plan_path)] = plan.to_json()
    if picture:
        files[Path(picture)] = draw(given.nest, plan, Path(picture).suffix, limits.home_mm)
    write_files(files)
    click.echo("written: " + ", ".join(map(str, files)))
    return 130 if ear.interrupted else 0
