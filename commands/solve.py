"""kerfwise solve: the main job, a nest becomes a checked program."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise.app_modules import app_module
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.text import escape_text
from kerfwise.jobs.by_engine import Method
from kerfwise.jobs.request import NoPlan
from kerfwise.models.engines import STRATEGIES
from kerfwise.models.jit import counted_s
from kerfwise.pipeline import Watchers

from .shared_options import (
    AMOUNT_OVER_ZERO,
    DATE,
    MEMORY,
    Amount,
    EngineChoice,
    input_options,
    note_placing,
    print_note,
    protect,
    read_inputs,
    reading_of,
)

if TYPE_CHECKING:
    from kerfwise.jobs.inputs import Inputs
    from kerfwise.jobs.time_limits import CommandLimit
    from kerfwise.models.plan.plan import Plan
    from kerfwise.pipeline import OrdersOf


def _plan_at_hand(path: str, inputs: Inputs) -> Plan:
    from kerfwise.jobs.inputs import damaged
    from kerfwise.models.plan.read_plan import read_plan

    plan = read_plan(Path(path))
    for text in damaged(plan, inputs):
        print_note(text)
    return plan


# What solve says when there is no plan: which hard rules contradict each other, the way out, and a picture.


def print_conflict(no_plan: NoPlan, picture: str | Path) -> int:
    """Say why there is no plan, and draw the contours in conflict if they are known; the exit code is 1."""
    conflict, facts, profile = no_plan.conflict, no_plan.facts, no_plan.profile
    text = str(no_plan.why if conflict is None else conflict)
    if conflict is not None and facts.past is not None:
        text = "\n".join(conflict.for_operator(len(facts.past.already.cuts)))
    click.echo(f"kerfwise: {text}", err=True)
    if conflict is None:
        for line in no_plan.notes:
            click.echo(f"  {line}", err=True)
        return 1
    if conflict.relax is not None:
        click.echo("--relax takes this way out, and says so in the plan and in the program", err=True)
    if named := [name for name in conflict.contours if name in facts.whole_nest.index]:
        from kerfwise.postproc.report import plot_spot

        caption = f"in conflict: {', '.join(dict.fromkeys(about.rule for about in conflict.clash))}"
        nest = facts.whole_nest  # after a stop what is out may be in conflict, too
        plot_spot(nest, named, picture, caption=caption, home=profile.home_on(nest))
        click.echo(f"the contours in conflict: {picture}", err=True)
    return 1


# The drawing of a nest in cutting order, as solve writes it for the senders of others.


def expect_drawings(svg: str | None, dxf: str | None) -> None:
    """Say at once that a name does not end as its kind does."""
    for name, suffix in ((svg, ".svg"), (dxf, ".dxf")):
        if name and Path(name).suffix.lower() != suffix:
            raise InputError(f"the reordered drawing is written as {suffix}: give a name that ends so", file=name)


def expect_as_drawn(inputs: Inputs, svg: str | None, dxf: str | None) -> None:
    """Say before the work that the drawing does not show what is cut."""
    if (svg or dxf) and inputs.nest.bridges:
        option = "--svg" if svg else "--reordered-dxf"
        raise InputError(
            f"{option}: bridges join parts, and the drawing has these apart: --dxf writes the torch's paths"
        )


def drawings(
    plan: Plan, inputs: Inputs, svg: str | None, dxf: str | None, options: Mapping[str, Any]
) -> dict[Path, str | bytes]:
    """The files that are asked for; what is not in them is said."""
    if not svg and not dxf:
        return {}
    from kerfwise.postproc.nc.ordered_drawings import reordered_dxf, reordered_svg

    files: dict[Path, str | bytes] = {}
    for name, reordered in ((svg, reordered_svg), (dxf, reordered_dxf)):
        if name:
            drawing = reordered(plan, inputs.nest, options["nest"], reading_of(inputs, options))
            files[Path(name)] = drawing.content
            for note in drawing.notes:
                print_note(f"{name}: {note}")
    return files


@click.command()
@input_options
@click.option(
    "-o",
    "--output",
    metavar="OUT.nc",
    help="Write the program. Default, without any output: NEST.nc, .plan.json, .svg.",
)
@click.option("--plan", "plan_path", metavar="PLAN.json", help="Write the plan.")
@click.option("--dxf", metavar="OUT.dxf", help="Write the torch's paths as DXF, one polyline per cut, in order.")
@click.option("--svg", metavar="OUT.svg", help="Write the drawing with its shapes in cutting order, for other senders.")
@click.option("--reordered-dxf", metavar="OUT.dxf", help="The same as DXF: geometry, layers and colours as drawn.")
@click.option("--picture", metavar="OUT.svg|.png|.pdf|.html", help="Write a picture of the plan.")
@click.option("--time-limit", type=AMOUNT_OVER_ZERO, metavar="S", help="Time limit of the command, in seconds.")
@click.option("--work", type=AMOUNT_OVER_ZERO, default=30.0, show_default=True, metavar="W",
              help="Deterministic limit, without --time-limit: the same work gives the same bytes.")  # fmt: skip
@click.option(
    "--seed", type=click.IntRange(min=0), default=1, show_default=True, metavar="N", help="Seed of the search."
)
@click.option("--gap", type=Amount(min=0, max=1), metavar="G",
              help="Stop at this gap; 0.01 is 1 %.")  # fmt: skip
@click.option("--no-improvement", type=AMOUNT_OVER_ZERO, metavar="S",
              help="Stop after S seconds without a better plan.")  # fmt: skip
@MEMORY
@click.option("--engine", type=EngineChoice(), default="portfolio", show_default=True,
              help="`kerfwise engines` describes them.")  # fmt: skip
@click.option("--solver", metavar="NAME", default="gecode", show_default=True, help="Solver of the engine minizinc.")
@click.option("--strategy", type=click.Choice(list(STRATEGIES)), default="ours", show_default=True,
              help="All but ours are for comparison: they keep the hard rules and ignore soft ones.")  # fmt: skip
@click.option("--lock-from", metavar="OLD.plan.json|OLD.nc",
              help="With --upto, resume after a stop: plan only what this plan or program has not cut. Alone, number "
                   "locks such as '#7 first' by it.")  # fmt: skip
@click.option(
    "--upto", type=click.IntRange(min=1), metavar="N", help="Number of its last finished cut; with --lock-from."
)
@click.option("--redo-last", is_flag=True, help="Repeat cut N, which broke off, from its start; with --lock-from.")
@click.option(
    "--relax", is_flag=True, help="If hard rules conflict, relax the cheapest ones and mark them in the plan."
)
@click.option(
    "--conflict-picture", metavar="OUT.svg|.png", help="Picture of a conflict of rules. Default: NEST.conflict.svg."
)
@DATE
@click.option("--first", is_flag=True, help="Write the first lawful plan, which a moment's search finds, and stop.")
@click.option("--start", "start_path", metavar="OLD.plan.json",
              help="Go on from this plan, as of the nest before an edit; today's costs no more.")  # fmt: skip
@click.option("-v", "--verbose", is_flag=True, help="Report which engines ran, which did not, and why.")
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
    date: str,
    first: bool,
    start_path: str | None,
    verbose: bool,
    **options: Any,
) -> int:
    """Write a checked cutting program of NEST that keeps every hard rule of the profile."""
    began_s = counted_s()
    from kerfwise.commands.page_picture import DrawnBeside, planned_picture
    from kerfwise.jobs.display import job_line, summary
    from kerfwise.jobs.request import options_for
    from kerfwise.jobs.resume import already_cut
    from kerfwise.jobs.time_limits import CommandLimit
    from kerfwise.jobs.warm_up import search_beside
    from kerfwise.pipeline import plan_nest
    from kerfwise.postproc.nc.ordered_drawings import write_dxf
    from kerfwise.postproc.output_files import expect_own, output_names, remnant_files, remnant_names, write_files

    from .progress import ProgressLine

    file = Path(options["nest"])
    if not file.name:
        raise InputError("this is a folder; expected a nest file", file=file)
    if by_default := output is plan_path is dxf is picture is svg is reordered_dxf is None:
        output, plan_path, picture = output_names(file)
    conflict_picture = conflict_picture or f"{file.stem}.conflict.svg"
    outputs = (output, plan_path, dxf, picture, conflict_picture, svg, reordered_dxf)
    expect_drawings(svg, reordered_dxf)
    if dxf and Path(dxf).suffix.lower() != ".dxf":
        raise InputError("the torch's paths are written as DXF: give a name ending in .dxf", file=dxf)
    _expect(outputs, (picture, conflict_picture), (file, lock_from, start_path))
    if by_default:
        expect_own(file, Path(str(output)), Path(str(plan_path)), Path(str(picture)))
    inputs = read_inputs(**options, last=lock_from, date=date)
    beside_program = remnant_names(output, inputs.profile) if output else ()
    protect(inputs, options["nest"], (*outputs, *beside_program), lock_from)
    expect_as_drawn(inputs, svg, reordered_dxf)
    note_placing(inputs)
    start = None if start_path is None else _plan_at_hand(start_path, inputs)
    already = already_cut(inputs, lock_from, upto, redo_last, print_note)
    limits = options_for(
        inputs.nest, inputs.profile,
        work=work, seed=seed, time_s=time_limit, gap=gap, no_improvement_s=no_improvement, engine=engine,
        memory_gb=memory_gb,
    )  # fmt: skip
    suffix = None if picture is None else Path(picture).suffix
    home = inputs.profile.home_on(inputs.nest)
    beside = click.get_current_context().with_resource(DrawnBeside(inputs.nest, suffix, home))
    drawn = () if suffix is None else (suffix,)
    whole = None if time_limit is None else CommandLimit(time_limit, began_s, drawn, beside=beside.draws)
    listener = ProgressLine()
    orders, foretold = _distortion(inputs)
    if engine in ("portfolio", "search"):
        search_beside(len(inputs.nest.contours))
    try:
        done = plan_nest(
            inputs,
            limits,
            Method(engine, solver, strategy, start, first),
            Watchers(listener, print_note, planned=beside.begin),
            already=already,
            relax=relax,
            whole=whole,
            orders=orders,
        )
    except NoPlan as no_plan:
        code = print_conflict(no_plan, conflict_picture)
        _tell_late(whole)
        return code
    verified = done.made
    found = None
    if foretold and verified.verdict.ok:
        found = app_module("distortion.predict").distort_made(done.given, verified.plan)
    if found is not None and inputs.profile.distortion.keep_tolerance and found.beyond:
        click.echo(f"kerfwise: {found.line()} (distortion.keep_tolerance); nothing was written", err=True)
        _tell_late(whole)
        return 1
    files: dict[Path, str | bytes] = {}
    if verified.verdict.ok:
        if output:
            files[Path(output)] = verified.program
            files |= remnant_files(output, inputs.nest, inputs.profile)
        if plan_path:
            files[Path(plan_path)] = verified.plan.to_json()
        if dxf:
            files[Path(dxf)] = write_dxf(verified.plan, inputs.nest, inputs.profile)
        files |= drawings(verified.plan, inputs, svg, reordered_dxf, options)
        if picture and suffix is not None:
            files[Path(picture)] = planned_picture(inputs, verified, suffix, beside)
        write_files(files)
    if verbose:
        click.echo("\n".join(verified.notes))
    if inputs.nest.reading is not None and inputs.nest.reading.taken:
        click.echo(escape_text(inputs.nest.reading.short()))
    click.echo(summary(verified.plan, verified.verdict))
    if line := listener.first_line(verified.plan.solve.objective, began_s):
        click.echo(line)
    if found is not None:
        click.echo(found.line())
    if inputs.job is not None and (line := job_line(inputs.job, verified.plan)):
        click.echo(line)
    if not verified.verdict.ok:
        click.echo("kerfwise: the check refuses this plan; nothing was written", err=True)
        _tell_late(whole)
        return 1
    click.echo("written: " + ", ".join(escape_text(str(path)) for path in files))
    _tell_late(whole)
    return 130 if listener.interrupted else 0


def _distortion(inputs: Inputs) -> tuple[OrdersOf | None, bool]:
    """What finds straighter orders, if there is a price on distortion, and whether the parts' errors are asked for."""
    options, price = inputs.profile.distortion, inputs.profile.objective.distortion
    common = options.predict or bool(price) or options.tolerance_mm is not None
    if not common and not any("tolerance" in part.attributes for part in inputs.nest.parts):
        return None, False
    orders: OrdersOf | None = app_module("distortion.straighter").orders_for(inputs)
    return orders, True


def _tell_late(whole: CommandLimit | None) -> None:
    """Say what took how long where the command, which ends now, has taken longer than its limit."""
    if whole is not None and (over := whole.over()):
        print_note(over)


def _expect(outputs: Iterable[str | None], pictures: Iterable[str | None], inputs: Iterable[str | Path | None]) -> None:
    """Say before the work what could not be written after it."""
    from kerfwise.postproc.output_files import expect_outputs
    from kerfwise.postproc.report import expect_picture

    for picture in pictures:
        if picture:
            expect_picture(Path(picture).suffix, picture)
    expect_outputs((Path(name) for name in outputs if name), (Path(name) for name in inputs if name))
