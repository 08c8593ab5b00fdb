"""kerfwise solve: the main job, a nest becomes a checked program."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.shown import shown
from kerfwise.models.engines.baselines import STRATEGIES
from kerfwise.models.kernels import counted_s

from .drawings_out import drawings, expect_as_drawn, expect_drawings
from .engine_choice import EngineChoice
from .given import given_options, note_placing, protect, read_given, tell_note
from .numbers import AMOUNT_OVER_ZERO, MEMORY, Amount

if TYPE_CHECKING:
    from kerfwise.jobs.whole_limit import WholeLimit


@click.command()
@given_options
@click.option("-o", "--output", metavar="OUT.nc", help="The program. If no output is named: NEST.nc, .plan.json, .svg.")
@click.option("--plan", "plan_path", metavar="PLAN.json", help="The plan.")
@click.option("--dxf", metavar="OUT.dxf", help="The torch's paths as a drawing, a polyline a cut, in order.")
@click.option(
    "--svg", metavar="OUT.svg", help="The drawing itself with its shapes in cutting order, for other senders."
)
@click.option("--reordered-dxf", metavar="OUT.dxf", help="The same as DXF: geometry, layers and colours as drawn.")
@click.option("--picture", metavar="OUT.svg|.png|.pdf|.html", help="A picture of the plan.")
@click.option("--time-limit", type=AMOUNT_OVER_ZERO, metavar="S", help="Limit the command by the clock, in seconds.")
@click.option("--work", type=AMOUNT_OVER_ZERO, default=30.0, show_default=True, metavar="W",
              help="Limit without --time-limit. The same work gives the same bytes, on each machine.")  # fmt: skip
@click.option(
    "--seed", type=click.IntRange(min=0), default=1, show_default=True, metavar="N", help="Seed of the search."
)
@click.option("--gap", type=Amount(min=0, max=1), metavar="G",
              help="Stop at a plan proven this close to the best; 0.01 is 1 %.")  # fmt: skip
@click.option("--no-improvement", type=AMOUNT_OVER_ZERO, metavar="S",
              help="Stop when S seconds have brought no better plan.")  # fmt: skip
@MEMORY
@click.option("--engine", type=EngineChoice(), default="portfolio", show_default=True,
              help="`kerfwise engines` says what each is.")  # fmt: skip
@click.option("--solver", metavar="NAME", default="gecode", show_default=True, help="Solver of the engine minizinc.")
@click.option("--strategy", type=click.Choice(list(STRATEGIES)), default="ours", show_default=True,
              help="All but ours are there to compare with: they keep the hard rules, and no soft ones.")  # fmt: skip
@click.option("--lock-from", metavar="OLD.plan.json|OLD.nc",
              help="With --upto go on after a stop: plan only what the old plan or program has not cut yet. Alone: the "
                   "one that locks such as '#7 first' count in.")  # fmt: skip
@click.option(
    "--upto", type=click.IntRange(min=1), metavar="N", help="How many of its cuts are made; with --lock-from."
)
@click.option("--redo-last", is_flag=True, help="Cut N broke off: cut it again from its start; with --lock-from.")
@click.option("--relax", is_flag=True, help="Where hard rules clash, take the cheapest way out, marked in the plan.")
@click.option("--conflict-picture", metavar="OUT.svg|.png", help="Picture of rules that clash: NEST.conflict.svg.")
@click.option("-v", "--verbose", is_flag=True, help="Say which engines ran, which did not, and why.")
def command(
    output: str | None,
    plan_path: str | None,
    dxf: str | None,
    svg: str | None,
    reordered_dxf: str | None,
    picture: str | None,
    time_limit: float | None,
    work: float,
    seed: int,
    gap: float | None,
    no_improvement: float | None,
    memory_gb: float,
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
    began_s = counted_s()
    from kerfwise.jobs.default_names import expect_own, named_after
    from kerfwise.jobs.main_job import plan_nest
    from kerfwise.jobs.no_plan import NoPlan
    from kerfwise.jobs.page.drawn_beside import DrawnBeside
    from kerfwise.jobs.page.picture import planned_picture
    from kerfwise.jobs.solve_options import options_for
    from kerfwise.jobs.stopped import already_cut
    from kerfwise.jobs.summary import job_line, summary
    from kerfwise.jobs.whole_limit import WholeLimit
    from kerfwise.postproc.files import write_files
    from kerfwise.postproc.nc.dxf_out import write_dxf
    from kerfwise.postproc.nc.remnant import remnant_files, remnant_names

    from .conflict import tell_conflict
    from .progress import ProgressLine

    file = Path(options["nest"])
    if by_default := output is plan_path is dxf is picture is svg is reordered_dxf is None:
        output, plan_path, picture = named_after(file)
    conflict_picture = conflict_picture or f"{file.stem}.conflict.svg"
    outputs = (output, plan_path, dxf, picture, conflict_picture, svg, reordered_dxf)
    expect_drawings(svg, reordered_dxf)
    if dxf and Path(dxf).suffix.lower() != ".dxf":
        raise InputError("the torch's paths are written as DXF: give a name ending in .dxf", file=dxf)
    _expect(outputs, (picture, conflict_picture), (file, lock_from))
    if by_default:
        expect_own(file, Path(str(output)), Path(str(plan_path)), Path(str(picture)))
    given = read_given(**options, last=lock_from)
    beside_program = remnant_names(output, given.profile) if output else ()
    protect(given, options["nest"], (*outputs, *beside_program), lock_from)
    expect_as_drawn(given, svg, reordered_dxf)
    note_placing(given)
    already = already_cut(given, lock_from, upto, redo_last, tell_note)
    limits = options_for(
        given.nest, given.profile,
        work=work, seed=seed, time_s=time_limit, gap=gap, no_improvement_s=no_improvement, engine=engine,
        memory_gb=memory_gb,
    )  # fmt: skip
    suffix = None if picture is None else Path(picture).suffix
    home = given.profile.home_on(given.nest)
    beside = click.get_current_context().with_resource(DrawnBeside(given.nest, suffix, home))
    drawn = () if suffix is None else (suffix,)
    whole = None if time_limit is None else WholeLimit(time_limit, began_s, drawn, beside=beside.draws)
    listener = ProgressLine()
    try:
        done = plan_nest(
            given, limits,
            already=already, relax=relax, engine=engine, solver=solver, strategy=strategy,
            listener=listener, tell=tell_note, whole=whole, planned_as=beside.begin,
        )  # fmt: skip
    except NoPlan as no_plan:
        code = tell_conflict(no_plan, conflict_picture)
        _tell_late(whole)
        return code
    made = done.made
    files: dict[Path, str | bytes] = {}
    if made.verdict.ok:
        if output:
            files[Path(output)] = made.program
            files |= remnant_files(output, given.nest, given.profile)
        if plan_path:
            files[Path(plan_path)] = made.plan.to_json()
        if dxf:
            files[Path(dxf)] = write_dxf(made.plan, given.nest, given.profile)
        files |= drawings(made.plan, given, svg, reordered_dxf, options)
        if picture and suffix is not None:
            files[Path(picture)] = planned_picture(given, made, suffix, beside)
        write_files(files)
    if verbose:
        click.echo("\n".join(made.notes))
    if given.nest.reading is not None:
        click.echo(shown(given.nest.reading.short()))
    click.echo(summary(made.plan, made.verdict))
    if given.job is not None and (told := job_line(given.job, made.plan)):
        click.echo(told)
    if not made.verdict.ok:
        click.echo("kerfwise: the check refuses this plan; nothing was written", err=True)
        _tell_late(whole)
        return 1
    click.echo("written: " + ", ".join(shown(str(path)) for path in files))
    _tell_late(whole)
    return 130 if listener.interrupted else 0


def _tell_late(whole: WholeLimit | None) -> None:
    """Say what took how long where the command, which ends now, has taken longer than its limit."""
    if whole is not None and (over := whole.over()):
        tell_note(over)


def _expect(outputs: Iterable[str | None], pictures: Iterable[str | None], inputs: Iterable[str | Path | None]) -> None:
    """Say before the work what could not be written after it."""
    from kerfwise.postproc.files import expect_outputs
    from kerfwise.postproc.report import expect_picture

    for picture in pictures:
        if picture:
            expect_picture(Path(picture).suffix, picture)
    expect_outputs((Path(name) for name in outputs if name), (Path(name) for name in inputs if name))
