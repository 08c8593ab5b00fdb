"""kerfwise solve: the main job, a nest becomes a checked program."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from kerfwise.encoder.errors import RulesConflict
from kerfwise.models.engines.baselines import STRATEGIES
from kerfwise.models.engines.names import member_of

from .engine_choice import EngineChoice
from .given import given_options, note_placing, read_given
from .numbers import AMOUNT_OVER_ZERO, Amount

SAID_S = 5.0
LEAST_SHARE = 0.2
"""Share of a limit in seconds that is left for the plan where --relax has used all of it."""


@click.command()
@given_options
@click.option("-o", "--output", metavar="OUT.nc", help="The program. If no output is named: NEST.nc, .plan.json, .svg.")
@click.option("--plan", "plan_path", metavar="PLAN.json", help="The plan.")
@click.option("--picture", metavar="OUT.svg|.png|.html", help="A picture of the plan.")
@click.option("--time-limit", type=AMOUNT_OVER_ZERO, metavar="S", help="Wall-clock seconds.")
@click.option("--work", type=AMOUNT_OVER_ZERO, default=30.0, show_default=True, metavar="W",
              help="Deterministic limit, used without --time-limit: the same work gives the same bytes.")  # fmt: skip
@click.option(
    "--seed", type=click.IntRange(min=0), default=1, show_default=True, metavar="N", help="Seed of the search."
)
@click.option("--gap", type=Amount(min=0, max=1), metavar="G",
              help="Stop at a plan proven this close to the best; 0.01 is 1 %.")  # fmt: skip
@click.option("--no-improvement", type=AMOUNT_OVER_ZERO, metavar="S",
              help="Stop when S seconds have brought no better plan.")  # fmt: skip
@click.option("--engine", type=EngineChoice(), default="portfolio", show_default=True,
              help="`kerfwise engines` says what each is.")  # fmt: skip
@click.option("--solver", metavar="NAME", default="gecode", show_default=True, help="Solver of the engine minizinc.")
@click.option("--strategy", type=click.Choice(list(STRATEGIES)), default="ours", show_default=True,
              help="Others than ours are to compare with: they keep the hard rules, no soft ones.")  # fmt: skip
@click.option("--lock-from", metavar="OLD.plan.json|OLD.nc",
              help="Go on after a stop: plan only what the old plan or program has not cut yet.")  # fmt: skip
@click.option(
    "--upto", type=click.IntRange(min=1), metavar="N", help="How many of its cuts are made; with --lock-from."
)
@click.option("--redo-last", is_flag=True, help="Cut N broke off: begin with it, from its start; with --lock-from.")
@click.option("--relax", is_flag=True, help="Where hard rules clash, take the cheapest way out, marked in the plan.")
@click.option("--conflict-picture", metavar="OUT.svg|.png", help="Where rules that clash are drawn: NEST.conflict.svg.")
@click.option("-v", "--verbose", is_flag=True, help="Say which engines ran, which did not, and why.")
def command(
    output: str | None,
    plan_path: str | None,
    picture: str | None,
    time_limit: float | None,
    work: float,
    seed: int,
    gap: float | None,
    no_improvement: float | None,
    engine: Any,
    solver: str,
    strategy: Any,
    lock_from: str | None,
    upto: int | None,
    redo_last: bool,
    relax: bool,
    conflict_picture: str | None,
    verbose: bool,
    **options: Any,
) -> int:
    """Turn NEST into a cutting program that keeps every hard rule of the profile, checked before it is written."""
    from kerfwise.jobs.ask import ask, facts_of
    from kerfwise.jobs.produce import produce
    from kerfwise.models.engines.solution import SolveOptions
    from kerfwise.models.physics.timing.choose import feeds_of
    from kerfwise.postproc.dialects import fitting_dialect
    from kerfwise.postproc.files import write_files
    from kerfwise.postproc.report import draw

    from .conflict import tell_conflict
    from .kept import again_first, already_cut
    from .progress import listening
    from .summary import summary

    file = Path(options["nest"])
    if output is plan_path is picture is None:
        beside = f"{file.stem}.plan.svg" if file.suffix.lower() == ".svg" else f"{file.stem}.svg"
        output, plan_path, picture = f"{file.stem}.nc", f"{file.stem}.plan.json", beside
    conflict_picture = conflict_picture or f"{file.stem}.conflict.svg"
    _expect((output, plan_path, picture, conflict_picture), (picture, conflict_picture), (file, lock_from))
    given = read_given(**options)
    note_placing(given)
    already = already_cut(given, lock_from, upto, redo_last)
    nest, profile = given.nest, again_first(given.profile, already)
    fitting_dialect(profile)  # a file of the plant's own may be wrong: better said now than at the end
    limits = SolveOptions(
        seed, work, time_limit, profile.home_on(nest), feeds_of(profile), gap, no_improvement, member_of(engine)
    )
    began_s = time.monotonic()
    facts = facts_of(nest, profile, already)
    _not_counted("the facts of the nest", time.monotonic() - began_s, time_limit)
    if (time_limit or no_improvement) and engine != "minizinc":
        _load_kernels()
    try:
        began_s = time.monotonic()
        asked = ask(facts, profile, relax, engine, limits)
        left = limits
        if time_limit:  # stating the rules is inside the limit; a plan gets its share all the same
            spent_s = time.monotonic() - began_s
            left = replace(limits, time_s=max(time_limit - spent_s, LEAST_SHARE * time_limit))
        began_s = time.monotonic()
        with listening() as progress:
            made = produce(asked, profile, left, progress, engine, solver, strategy)
    except RulesConflict as error:
        return tell_conflict(facts, profile, error, conflict_picture, limits)
    over_s = time.monotonic() - began_s - made.judging_s - (left.time_s or 0.0)
    _not_counted("ending the planning", over_s, time_limit)
    _not_counted("writing and checking the program", made.judging_s, time_limit)
    if verbose:
        click.echo("\n".join(made.notes))
    click.echo(summary(made.plan, made.verdict))
    if not made.verdict.ok:
        click.echo("kerfwise: the check refuses this plan; nothing was written", err=True)
        return 1
    files: dict[Path, str | bytes] = {}
    if output:
        files[Path(output)] = made.program
    if plan_path:
        files[Path(plan_path)] = made.plan.to_json()
    if picture:
        files[Path(picture)] = draw(nest, made.plan, Path(picture).suffix, profile.home_on(nest))
    write_files(files)
    click.echo("written: " + ", ".join(map(str, files)))
    return 130 if progress.interrupted else 0


def _not_counted(what: str, took_s: float, time_limit: float | None) -> None:
    """Say what took long beside a limit in seconds."""
    if time_limit and took_s > SAID_S:
        click.echo(f"note: {what} took {took_s:.0f} s, which the limit does not count", err=True)


def _load_kernels() -> None:
    """Before the clock of a limit in seconds starts; said where it took long, as the first time it does."""
    from kerfwise.models.engines.warm_up import load_kernels

    started_s = time.monotonic()
    load_kernels()
    if (took_s := time.monotonic() - started_s) > SAID_S:
        text = f"kernels were compiled first, which is done once: {took_s:.0f} s, not counted by the limit"
        click.echo(f"note: {text}", err=True)


def _expect(outputs: Iterable[str | None], pictures: Iterable[str | None], inputs: Iterable[str | Path | None]) -> None:
    """Say before the work what could not be written after it."""
    from kerfwise.postproc.files import expect_outputs
    from kerfwise.postproc.report import expect_picture

    for picture in pictures:
        if picture:
            expect_picture(Path(picture).suffix)
    expect_outputs((Path(name) for name in outputs if name), (Path(name) for name in inputs if name))
