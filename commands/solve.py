"""kerfwise solve: the main job, a nest becomes a checked program."""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from kerfwise.app_modules import app_module
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.jobs.by_engine import Method, OrdersOf
from kerfwise.jobs.request import NoPlan
from kerfwise.models.engines import STRATEGIES
from kerfwise.models.jit import counted_s
from kerfwise.pipeline import Watchers

from .option_groups import (
    GAP,
    NO_IMPROVEMENT,
    RELAX,
    Stopped,
    limit_options,
    stopped_options,
    together,
)
from .shared_options import (
    DATE,
    MEMORY,
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
    from kerfwise.models.engines.solution import Limits
    from kerfwise.models.plan.plan import Plan
    from kerfwise.pipeline import FinishedPlan, Promise, VerifiedPlan

    from .page_picture import DrawnBeside


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


# The files that solve writes: what is refused of their names before the work, and what is in them after it.


@dataclass(frozen=True, slots=True)
class Outputs:
    """Names of the files: program, plan, torch's paths, drawings in cutting order, pictures of plan and conflict."""

    output: str | None
    plan_path: str | None
    dxf: str | None
    svg: str | None
    reordered_dxf: str | None
    picture: str | None
    conflict_picture: str | None

    @property
    def paths(self) -> tuple[str | None, ...]:
        """All of them."""
        named = (self.output, self.plan_path, self.dxf, self.picture, self.conflict_picture)
        return (*named, self.svg, self.reordered_dxf)

    @property
    def suffix(self) -> str | None:
        """Of the picture of the plan."""
        return None if self.picture is None else Path(self.picture).suffix

    def checked(self, nest: Path, *read: str | None) -> Outputs:
        """The same with the names that files have where none is given; `read` are files that are read besides the nest.

        Raises InputError for a name that could not be written after the work.
        """
        from kerfwise.postproc.output_files import expect_outputs, expect_own, output_names
        from kerfwise.postproc.report import expect_picture

        if not nest.name:
            raise InputError("this is a folder; expected a nest file", file=nest)
        full = replace(self, conflict_picture=self.conflict_picture or f"{nest.stem}.conflict.svg")
        if by_default := all(name is None for name in replace(self, conflict_picture=None).paths):
            output, plan_path, picture = output_names(nest)
            full = replace(full, output=output, plan_path=plan_path, picture=picture)
        for name, suffix in ((self.svg, ".svg"), (self.reordered_dxf, ".dxf")):
            if name and Path(name).suffix.lower() != suffix:
                raise InputError(f"the reordered drawing is written as {suffix}: give a name that ends so", file=name)
        if self.dxf and Path(self.dxf).suffix.lower() != ".dxf":
            raise InputError("the torch's paths are written as DXF: give a name ending in .dxf", file=self.dxf)
        for picture_name in (full.picture, full.conflict_picture):
            if picture_name:
                expect_picture(Path(picture_name).suffix, picture_name)
        expect_outputs((Path(name) for name in full.paths if name), (nest, *(Path(name) for name in read if name)))
        if by_default:
            expect_own(nest, Path(str(full.output)), Path(str(full.plan_path)), Path(str(full.picture)))
        return full

    def expect_as_drawn(self, inputs: Inputs) -> None:
        """Say before the work that the drawing does not show what is cut. Raises InputError."""
        if (self.svg or self.reordered_dxf) and inputs.nest.bridges:
            option = "--svg" if self.svg else "--reordered-dxf"
            raise InputError(
                f"{option}: bridges join parts, and the drawing has these apart: --dxf writes the torch's paths"
            )

    def contents(
        self, verified: VerifiedPlan, inputs: Inputs, options: Mapping[str, Any], beside: DrawnBeside, at_once: bool
    ) -> Iterator[dict[Path, str | bytes]]:
        """What is in each file; what is not in a drawing is said. With `at_once` the picture follows all others."""
        from kerfwise.commands.page_picture import planned_picture
        from kerfwise.postproc.output_files import remnant_files

        plan, files = verified.plan, dict[Path, str | bytes]()
        if self.output:
            files[Path(self.output)] = verified.program
            files |= remnant_files(self.output, inputs.nest, inputs.profile)
        if self.plan_path:
            files[Path(self.plan_path)] = plan.to_json()
        if self.dxf:
            from kerfwise.postproc.nc.ordered_drawings import write_dxf

            files[Path(self.dxf)] = write_dxf(plan, inputs.nest, inputs.profile)
        files |= self._drawings(plan, inputs, options)
        if at_once and files:
            yield files
            files = {}
        if self.picture and self.suffix is not None:
            files[Path(self.picture)] = planned_picture(inputs, verified, self.suffix, beside)
        yield files

    def _drawings(self, plan: Plan, inputs: Inputs, options: Mapping[str, Any]) -> dict[Path, str | bytes]:
        """The drawing of the nest in cutting order, as the senders of others read it."""
        if not self.svg and not self.reordered_dxf:
            return {}
        from kerfwise.postproc.nc.ordered_drawings import reordered_dxf, reordered_svg

        files: dict[Path, str | bytes] = {}
        for name, reordered in ((self.svg, reordered_svg), (self.reordered_dxf, reordered_dxf)):
            if name:
                drawing = reordered(plan, inputs.nest, options["nest"], reading_of(inputs, options))
                files[Path(name)] = drawing.content
                for note in drawing.notes:
                    print_note(f"{name}: {note}")
        return files


@click.command()
@input_options
@together(
    "outputs",
    Outputs,
    click.option(
        "-o",
        "--output",
        metavar="OUT.nc",
        help="Write the program. Default, without any output: NEST.nc, .plan.json, .svg.",
    ),
    click.option("--plan", "plan_path", metavar="PLAN.json", help="Write the plan."),
    click.option("--dxf", metavar="OUT.dxf", help="Write the torch's paths as DXF, one polyline per cut, in order."),
    click.option("--svg", metavar="OUT.svg",
                 help="Write the drawing with its shapes in cutting order, for other senders."),
    click.option("--reordered-dxf", metavar="OUT.dxf", help="The same as DXF: geometry, layers and colours as drawn."),
    click.option("--picture", metavar="OUT.svg|.png|.pdf|.html", help="Write a picture of the plan."),
    click.option("--conflict-picture", metavar="OUT.svg|.png",
                 help="Picture of a conflict of rules. Default: NEST.conflict.svg."),
)  # fmt: skip
@limit_options(
    GAP,
    NO_IMPROVEMENT,
    MEMORY,
    click.option("--engine", type=EngineChoice(), default="portfolio", show_default=True,
                 help="`kerfwise engines` describes them."),
    of="of the command",
)  # fmt: skip
@together(
    "method",
    dict,
    click.option("--solver", metavar="NAME", default="gecode", show_default=True,
                 help="Solver of the engine minizinc."),
    click.option("--strategy", type=click.Choice(list(STRATEGIES)), default="ours", show_default=True,
                 help="All but ours are for comparison: they keep the hard rules and ignore soft ones."),
    click.option("--first", is_flag=True,
                 help="Write the first lawful plan, which a moment's search finds, then its picture, and stop."),
)  # fmt: skip
@stopped_options(
    "With --upto, resume after a stop: plan only what this plan or program has not cut. Alone, number locks such as "
    "'#7 first' by it."
)
@RELAX
@DATE
@click.option("--start", "start_path", metavar="OLD.plan.json",
              help="Go on from this plan, as of the nest before an edit; today's costs no more.")  # fmt: skip
@click.option("-v", "--verbose", is_flag=True, help="Report which engines ran, which did not, and why.")
def command(
    outputs: Outputs,
    limits: Limits,
    method: dict[str, Any],
    stopped: Stopped,
    relax: bool,
    date: str,
    start_path: str | None,
    verbose: bool,
    **options: Any,
) -> int:
    """Write a checked cutting program of NEST that keeps every hard rule of the profile."""
    began_s = counted_s()
    solver_from = click.get_current_context().get_parameter_source("solver")
    if limits["engine"] != "minizinc" and solver_from is not ParameterSource.DEFAULT:
        raise click.UsageError("--solver is for --engine minizinc")
    if gc.isenabled():  # there are few circles of objects: looks for them make facts and rules half as long again
        gc.disable()
        click.get_current_context().call_on_close(gc.enable)
    from kerfwise.jobs.request import options_for
    from kerfwise.jobs.time_limits import CommandLimit
    from kerfwise.jobs.warm_up import search_beside
    from kerfwise.pipeline import plan_nest
    from kerfwise.postproc.output_files import remnant_names

    from .progress import ProgressLine

    lock_from = stopped.lock_from
    outputs = outputs.checked(Path(options["nest"]), lock_from, start_path)
    inputs = read_inputs(**options, last=lock_from, date=date)
    beside_program = remnant_names(outputs.output, inputs.profile) if outputs.output else ()
    protect(inputs, options["nest"], (*outputs.paths, *beside_program), lock_from)
    outputs.expect_as_drawn(inputs)
    note_placing(inputs)
    start = None if start_path is None else _plan_at_hand(start_path, inputs)
    already = stopped.already_cut(inputs)
    of_plan = options_for(inputs.nest, inputs.profile, **limits)
    beside, planned = _beside(inputs, outputs.suffix)
    whole = None
    if (time_s := limits["time_s"]) is not None:
        whole = CommandLimit(time_s, began_s, filter(None, [outputs.suffix]), beside=beside.pays)
    listener = ProgressLine()
    orders, foretold = _distortion(inputs, start)
    if limits["engine"] in ("portfolio", "search"):
        search_beside(len(inputs.nest.contours))
    try:
        done = plan_nest(
            inputs,
            of_plan,
            Method(limits["engine"], start=start, orders=orders, **method),
            Watchers(listener, print_note, planned=planned),
            already=already,
            relax=relax,
            whole=whole,
        )
    except NoPlan as no_plan:
        code = print_conflict(no_plan, str(outputs.conflict_picture))
    else:
        first_line = listener.first_line(done.made.plan.solve.objective, began_s)
        contents = outputs.contents(done.made, inputs, options, beside, method["first"])
        refused = _finish(done, inputs, foretold, first_line, verbose, contents)
        code = refused or (130 if listener.interrupted else 0)
    if whole is not None and (over := whole.over()):  # what took how long, where the command took longer than its limit
        print_note(over)
    return code


def _beside(inputs: Inputs, suffix: str | None) -> tuple[DrawnBeside, Callable[[Plan], Promise | None]]:
    """The processes that draw and judge a plan, as long as the command runs, and what tells both of it."""
    from .judged_beside import JudgedBeside
    from .page_picture import DrawnBeside

    context, nest = click.get_current_context(), inputs.nest
    drawn = context.with_resource(DrawnBeside(nest, suffix, inputs.profile.home_on(nest)))
    judged = context.with_resource(JudgedBeside(nest, inputs.profile))

    def planned(plan: Plan) -> Promise | None:
        promise = judged.begin(plan)  # the program waits for that, and nothing for the picture
        drawn.begin(plan)
        return promise

    return drawn, planned


def _finish(
    done: FinishedPlan,
    inputs: Inputs,
    predicts: bool,
    first_line: str,
    verbose: bool,
    contents: Iterator[dict[Path, str | bytes]],
) -> int:
    """Write the files of a plan that passes, and say what was planned; with `predicts` how far parts will be off."""
    from kerfwise.jobs.display import job_line, summary
    from kerfwise.postproc.output_files import write_files

    plan, verdict, reading = done.made.plan, done.made.verdict, inputs.nest.reading
    of_parts = ""
    if predicts and verdict.ok:
        found = app_module("distortion.predict").distort_made(done.given, plan)
        of_parts = found.line()
        if inputs.profile.distortion.keep_tolerance and found.beyond:
            click.echo(f"kerfwise: {of_parts} (distortion.keep_tolerance); nothing was written", err=True)
            return 1
    files = next(contents) if verdict.ok else {}
    write_files(files)
    notes = "\n".join(done.made.notes) if verbose else ""
    read = escape_text(reading.short()) if reading is not None and reading.taken else ""
    of_job = "" if inputs.job is None else job_line(inputs.job, plan)
    for text in (notes, read, summary(plan, verdict), first_line, of_parts, of_job):
        if text:
            click.echo(text)
    if not verdict.ok:
        click.echo("kerfwise: the check refuses this plan; nothing was written", err=True)
        return 1
    click.echo(f"written: {', '.join(escape_text(str(path)) for path in files)}")
    for later in filter(None, contents):
        write_files(later)
        click.echo(f"written: {', '.join(escape_text(str(path)) for path in later)}")
    return 0


def _distortion(inputs: Inputs, start: Plan | None) -> tuple[OrdersOf | None, bool]:
    """What finds straighter orders, if there is a price on distortion, and whether the parts' errors are asked for."""
    options, price = inputs.profile.distortion, inputs.profile.objective.distortion
    common = options.predict or bool(price) or options.tolerance_mm is not None
    if not common and not any("tolerance" in part.attributes for part in inputs.nest.parts):
        return None, False
    orders: OrdersOf | None = app_module("distortion.straighter").orders_for(inputs, start)
    return orders, True
