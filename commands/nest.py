"""kerfwise nest: parts with quantities become nests, sheet by sheet, checked before they are written."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import click

from kerfwise.encoder.text import escape_text
from kerfwise.jobs.nesting.find_nests import Watching
from kerfwise.rules.profile.load import DEFAULT

from .shared_options import AMOUNT_OVER_ZERO, TRUST, length_or_zero, print_note
from .terminal import expect_printed

if TYPE_CHECKING:
    from kerfwise.jobs.nesting.find_nests import Engine, NestingRequest, NestingResult, Purpose
    from kerfwise.jobs.nesting.nests import Nested
    from kerfwise.nesting.layout import Layout
    from kerfwise.rules.profile.profile import Profile


# What nesting shows on a terminal while it looks, and Ctrl-C that keeps the best nests so far.


class NestProgress(Watching):
    """Told after each round; answers False once the user has pressed Ctrl-C. In a pipe it is silent."""

    def __init__(self) -> None:
        super().__init__()
        self._status: Any = None
        if sys.stderr.isatty():
            from rich.console import Console

            from .terminal import bare

            self._status = Console(file=bare(sys.stderr)).status("laying parts")

    def __call__(self, number: int, best: Layout) -> bool:
        """Show the best so far; whether to go on."""
        if self._status is not None:
            whole = sum(sheet.stock.area_mm2 for sheet in best.sheets)
            used = sum(sheet.metal_mm2(best.wanted) for sheet in best.sheets) / whole if whole else 0.0
            spent = time.monotonic() - self.started
            line = f"{spent:5.1f} s  round {number}  {len(best.sheets)} sheets, {used:.1%} used"
            self._status.update(f"{line}  (Ctrl-C keeps the best so far)")
        return super().__call__(number, best)

    def going(self, doing: str) -> bool:
        """Show what is being done; whether to go on."""
        if self._status is not None:
            self._status.update(f"{time.monotonic() - self.started:5.1f} s  {doing}  (Ctrl-C keeps the best so far)")
        return super().going(doing)

    def __enter__(self) -> Self:
        super().__enter__()
        if self._status is not None:
            self._status.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._status is not None:
            self._status.__exit__(kind, error, trace)
        super().__exit__(kind, error, trace)


# What a person says of parts, sheets and how to lay them: the options of `nest` and `make`.

Verb = Callable[..., Any]

_OPTIONS = (
    click.option("--sheet", "sheets", metavar="WxH[=N]|FILE[=N]", multiple=True,
                 help="A sheet in mm, such as 3000x1500, and its stock; repeatable."),
    click.option("--remnant", "remnants", metavar="FILE[=N]|WxH[=N]", multiple=True,
                 help="A remnant of any shape, used before sheets; repeatable."),
    click.option("-p", "--profile", metavar="PROFILE", default=DEFAULT, show_default=True, help="Name or path."),
    TRUST,
    click.option("-o", "--output", metavar="DIR", required=True, help="Output folder of the nests."),
    click.option("--gap", metavar="LENGTH", help="Gap between parts. Default: a kerf and the profile's nesting.web."),
    click.option("--edge", metavar="LENGTH", help="Distance to the sheet's edge. Default: the profile's nesting.edge."),
    click.option("--dxf", is_flag=True, help="Also write each nest as DXF."),
    click.option("--rounds", type=click.IntRange(1, 100_000), default=12, show_default=True, metavar="N",
                 help="Rounds to search, without --time-limit. The same number gives the same bytes."),
    click.option("--time-limit", type=AMOUNT_OVER_ZERO, metavar="S", help="Time limit of the search, in seconds."),
    click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True, metavar="N",
                 help="Seed of the search."),
    click.option("--engine", type=click.Choice(["own", "pavlov", "sparrow"]), default="own", show_default=True,
                 help="pavlov: the least rectangle around all parts, blocks by the defining line, for small lists. "
                 "sparrow: make the best layout denser with spyrrow (pip install kerfwise[nest])."),
    click.option("--for", "purpose", type=click.Choice(["density", "cutting"]), default="density", show_default=True,
                 help="cutting: plan several layouts that use the sheets alike, and take the cheapest to cut."),
    click.option("--weigh", type=click.IntRange(1, 100), default=4, show_default=True, metavar="N",
                 help="Number of layouts to plan with --for cutting."),
    click.option("--weigh-work", type=AMOUNT_OVER_ZERO, default=2.0, show_default=True, metavar="W",
                 help="Work limit of each of these plans."),
    click.option("--units", metavar="UNIT", help="Unit of the drawings: mm, cm, m, in, ft, pt, px, or as 90dpi."),
    click.option("--repair", is_flag=True, help="Repair the drawings where possible, and report each repair."),
    click.argument("parts", metavar="PARTS…", nargs=-1, required=True),
)  # fmt: skip


def nest_options(verb: Verb) -> Verb:
    """Add PARTS and all that says how they are laid."""
    for add in reversed(_OPTIONS):
        verb = add(verb)
    return verb


def read_nesting_request(
    parts: tuple[str, ...],
    sheets: tuple[str, ...],
    remnants: tuple[str, ...],
    profile: str,
    trust: bool,
    output: str,
    gap: str | None,
    edge: str | None,
    rounds: int,
    time_limit: float | None,
    seed: int,
    units: str | None,
    repair: bool,
    engine: Engine,
    purpose: Purpose,
    weigh: int,
    weigh_work: float,
) -> tuple[NestingRequest, Path]:
    """Read parts, sheets and profile; what the readers have to say goes to standard error.

    Returns
    -------
    What is asked for, and the folder that the nests are written to.
    """
    from kerfwise.jobs.inputs import plant_of, reading
    from kerfwise.jobs.nesting.find_nests import NestingRequest as Asked
    from kerfwise.jobs.nesting.find_nests import expect_engine, spacing_of, spacing_warning
    from kerfwise.jobs.nesting.nests import expect_folder
    from kerfwise.jobs.nesting.request import order_of
    from kerfwise.nesting.rounds import Effort

    plant, out = plant_of(profile, trust), Path(output)
    expect_engine(engine)
    expect_folder(out)
    gap_mm = None if gap is None else length_or_zero("--gap", gap)
    spacing = spacing_of(plant, gap_mm, None if edge is None else length_or_zero("--edge", edge))
    wanted = order_of(parts, sheets, remnants, reading(plant, units=units, repair=repair), print_note)
    if said := spacing_warning(plant, spacing):
        print_note(said)
    effort = Effort(rounds, time_limit, seed)
    return Asked(plant, wanted, spacing, effort, engine, purpose, weigh, weigh_work), out


def looked_for(asked: NestingRequest) -> NestingResult:
    """The nests: progress on a terminal, Ctrl-C that keeps the best so far, or says that nothing was laid."""
    from kerfwise.jobs.nesting.find_nests import NOTHING_LAID, find_nests

    from .progress import ProgressLine

    try:
        return find_nests(asked, NestProgress(), lambda name: ProgressLine(), print_note)
    except KeyboardInterrupt:
        print_note(NOTHING_LAID)
        raise


def print_nests(nested: Nested, found: NestingResult, plant: Profile) -> None:
    """Print the table of the nests that are written, and what was weighed."""
    from kerfwise.jobs.nesting.nests import as_text

    click.echo(as_text(nested))
    if found.taken is not None:
        from kerfwise.jobs.nesting.find_nests import weighed_text

        click.echo(weighed_text(found.weighed, found.taken, plant))


def _schema(context: click.Context, option: click.Parameter, asked: bool) -> None:
    """Print the schema, and nothing else."""
    if not asked:
        return
    from kerfwise.jobs.nesting.request import schema_text

    click.echo(schema_text(), nl=False)
    expect_printed()
    context.exit()


@click.command()
@nest_options
@click.option("--schema", is_flag=True, is_eager=True, expose_value=False, callback=_schema,
              help="Print the JSON Schema of lists of parts, for editors.")  # fmt: skip
@click.option("--picture", type=click.Choice(["svg", "png", "pdf"]), default="svg", show_default=True,
              help="Format of the pictures.")  # fmt: skip
def nest_command(dxf: bool, picture: str, **options: Any) -> int:
    """Lay PARTS, files with their quantities (bracket.dxf=12) or lists of parts, on sheets; remnants first."""
    from kerfwise.jobs.nesting.nests import nest_files, write_nests

    asked, out = read_nesting_request(**options)
    found = looked_for(asked)
    files = nest_files(found.nested, f".{picture}", dxf)
    written = write_nests(out, found.nested, files, profile=asked.plant.name, seed=asked.effort.seed)
    print_nests(found.nested, found, asked.plant)
    click.echo(f"written: {len(written)} files in {escape_text(str(out))}")
    if found.interrupted:
        return 130
    return 1 if any(found.nested.layout.missing) else 0


# kerfwise make: a list of parts to programs in one command: nest, plan, check, write.


@click.command()
@nest_options
@click.option("--work", type=AMOUNT_OVER_ZERO, default=30.0, show_default=True, metavar="W",
              help="Deterministic limit of each plan: the same work gives the same bytes.")  # fmt: skip
@click.option(
    "--relax", is_flag=True, help="If hard rules conflict, relax the cheapest ones and mark them in the plan."
)
def make_command(dxf: bool, work: float, relax: bool, **options: Any) -> int:
    """Lay PARTS on sheets, and write a checked program, plan and pictures for every sheet."""
    from kerfwise.jobs.nesting.nests import write_nests
    from kerfwise.jobs.nesting.programs import make_programs

    from .progress import ProgressLine

    asked, out = read_nesting_request(**options)
    found = looked_for(asked)
    made = make_programs(found.nested, asked.plant, work, relax, lambda name: ProgressLine())
    written = write_nests(out, made.nested, made.files(dxf), profile=asked.plant.name, seed=asked.effort.seed)
    print_nests(made.nested, found, asked.plant)
    click.echo("\n".join(made.told))
    click.echo(f"written: {len(written)} files in {escape_text(str(out))}")
    if found.interrupted or made.interrupted:
        return 130
    return 1 if any(made.nested.layout.missing) else 0
