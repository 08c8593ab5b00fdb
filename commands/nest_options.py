"""What a person says of parts, sheets and how to lay them: the options of `nest` and `make`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise.encoder.errors import InputError
from kerfwise.rules.profile.profile import DEFAULT

from .given import TRUST, tell_note
from .lengths import length_or_zero
from .numbers import AMOUNT_OVER_ZERO

if TYPE_CHECKING:
    from kerfwise.jobs.nesting.run import Nested
    from kerfwise.jobs.nesting.weigh import Weighed
    from kerfwise.nesting.rounds import Effort
    from kerfwise.nesting.wanted import Spacing, Wanted
    from kerfwise.rules.profile.profile import Profile

Verb = Callable[..., Any]

_OPTIONS = (
    click.option("--sheet", "sheets", metavar="WxH[=N]|FILE[=N]", multiple=True,
                 help="A sheet in mm, such as 3000x1500, and how many there are; may be repeated."),
    click.option("--remnant", "remnants", metavar="FILE[=N]|WxH[=N]", multiple=True,
                 help="A remnant of any shape, used before sheets; may be repeated."),
    click.option("-p", "--profile", metavar="PROFILE", default=DEFAULT, show_default=True, help="Name or path."),
    TRUST,
    click.option("-o", "--output", metavar="DIR", required=True, help="The folder of the nests."),
    click.option("--gap", metavar="LENGTH", help="Between parts, instead of a kerf and the profile's nesting.web."),
    click.option("--edge", metavar="LENGTH", help="To the edge of the sheet, instead of the profile's nesting.edge."),
    click.option("--dxf", is_flag=True, help="Write each nest as DXF, too."),
    click.option("--rounds", type=click.IntRange(1, 100_000), default=12, show_default=True, metavar="N",
                 help="Orders that are tried, without --time-limit. The same number gives the same bytes."),
    click.option("--time-limit", type=AMOUNT_OVER_ZERO, metavar="S", help="Look as long, by the clock, in seconds."),
    click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True, metavar="N",
                 help="Of random orders."),
    click.option("--engine", type=click.Choice(["own", "sparrow"]), default="own", show_default=True,
                 help="sparrow: make the best layout denser with spyrrow (pip install kerfwise[nest])."),
    click.option("--for", "purpose", type=click.Choice(["density", "cutting"]), default="density", show_default=True,
                 help="cutting: plan several layouts that use the sheets alike, and take the cheapest to cut."),
    click.option("--weigh", type=click.IntRange(1, 100), default=4, show_default=True, metavar="N",
                 help="Layouts that are planned with --for cutting."),
    click.option("--weigh-work", type=AMOUNT_OVER_ZERO, default=2.0, show_default=True, metavar="W",
                 help="Limit of each such plan."),
    click.option("--units", metavar="UNIT", help="Unit of the drawings: mm, cm, m, in or ft."),
    click.option("--repair", is_flag=True, help="Mend what can be mended in the drawings, and say what was done."),
    click.argument("parts", metavar="PARTS…", nargs=-1, required=True),
)  # fmt: skip


def nest_options(verb: Verb) -> Verb:
    """Add PARTS and all that says how they are laid."""
    for add in reversed(_OPTIONS):
        verb = add(verb)
    return verb


@dataclass(frozen=True, eq=False, slots=True)
class Asked:
    """What these options ask for, read."""

    plant: Profile
    out: Path
    wanted: Wanted
    spacing: Spacing
    effort: Effort
    engine: str = "own"


def read_asked(
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
    engine: str,
) -> Asked:
    """Read parts, sheets and profile; what the readers have to say goes to standard error."""
    from kerfwise.jobs.given import plant_of, reading
    from kerfwise.jobs.nesting.engines import expect_engine
    from kerfwise.jobs.nesting.files import expect_folder
    from kerfwise.jobs.nesting.order import order_of
    from kerfwise.jobs.nesting.spacing import spacing_of
    from kerfwise.nesting.rounds import Effort

    plant, out = plant_of(profile, trust), Path(output)
    expect_engine(engine)
    expect_folder(out)
    gap_mm = None if gap is None else length_or_zero("--gap", gap)
    spacing = spacing_of(plant, gap_mm, None if edge is None else length_or_zero("--edge", edge))
    wanted = order_of(parts, sheets, remnants, reading(plant, units=units, repair=repair), tell_note)
    return Asked(plant, out, wanted, spacing, Effort(rounds, time_limit, seed), engine)


@dataclass(frozen=True, eq=False, slots=True)
class Found:
    """The nests that are to be written, what was weighed to choose them, and whether Ctrl-C ended the look."""

    nested: Nested
    weighed: tuple[Weighed, ...] = ()
    interrupted: bool = False


def find_nests(asked: Asked, purpose: str, most: int, work: float) -> Found:
    """Lay the parts, and weigh layouts for cutting where that is asked for.

    Raises
    ------
    InputError
        If a part fits on no sheet, or the check refuses the nests.
    """
    from kerfwise.jobs.nesting.engines import ranked_layouts
    from kerfwise.jobs.nesting.run import expect_room, nests_from

    from .nest_progress import NestProgress

    expect_room(asked.wanted, asked.spacing)
    with NestProgress() as progress:
        ranked = ranked_layouts(asked.wanted, asked.spacing, asked.effort, asked.engine, progress, tell_note)
    if purpose == "density":
        return Found(_sound(nests_from(ranked[0])), interrupted=progress.interrupted)
    from kerfwise.jobs.nesting.weigh import alike, cheapest, weigh

    from .progress import ProgressLine

    weighed: list[Weighed] = []
    interrupted = progress.interrupted
    for layout in alike(ranked, most):
        if interrupted and weighed:
            break
        lines: list[ProgressLine] = []

        def listener(name: str) -> ProgressLine:
            lines.append(ProgressLine())  # noqa: B023 - called in this round only
            return lines[-1]  # noqa: B023

        weighed.append(weigh(_sound(nests_from(layout)), asked.plant, work, listener))
        interrupted = interrupted or any(line.interrupted for line in lines)
    return Found(cheapest(weighed).nested, tuple(weighed), interrupted)


def _sound(nested: Nested) -> Nested:
    if nested.faults:
        raise InputError("the check refuses these nests; nothing was written", details=nested.faults)
    return nested


def tell_found(found: Found, plant: Profile) -> None:
    """Print the table of the nests, and what was weighed."""
    from kerfwise.jobs.nesting.table import as_text

    click.echo(as_text(found.nested))
    if found.weighed:
        from kerfwise.jobs.nesting.weigh import weighed_text

        taken = next(one for one in found.weighed if one.nested is found.nested)
        click.echo(weighed_text(found.weighed, taken, plant))
