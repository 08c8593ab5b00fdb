"""kerfwise compare: two ways to cut one nest, side by side."""

from __future__ import annotations

import contextlib
import io
import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise.commands.option_groups import RELAX, limit_options, together
from kerfwise.commands.shared_options import nest_options, print_note, protect, read_inputs
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.rules.profile.load import DEFAULT

if TYPE_CHECKING:
    from kerfwise.jobs.inputs import Inputs
    from kerfwise.models.engines.solution import Limits

    from . import Comparison, SideAsked

_PROFILES = click.option(
    "-p", "--profile", "profiles", multiple=True, metavar="PROFILE",
    help=f"Name or path of the profile (default {DEFAULT}); given twice, that of A and that of B.",
)  # fmt: skip


def _options(verb: Callable[..., Any]) -> Callable[..., Any]:
    return nest_options(verb, _PROFILES)


@click.command()
@_options
@click.argument("a", metavar="[A]", required=False)
@click.argument("b", metavar="[B]", required=False)
@together(
    "rules",
    dict,
    click.option("--without", multiple=True, metavar="RULE", help="Plan B with this rule off; repeatable."),
    click.option("--with", "with_", multiple=True, metavar="RULE[=hard|soft]",
                 help="Plan B with this rule on; repeatable."),
    RELAX,
)  # fmt: skip
@together(
    "simulated",
    dict,
    click.option("--heat", is_flag=True, help="Simulate the temperatures of both."),
    click.option("--distortion", is_flag=True, help="Simulate how far the parts of both will be off."),
)
@click.option("-o", "--output", "outputs", multiple=True, metavar="OUT.svg|.png|.html|.pdf",
              help="Write a picture of both routes, or a page or PDF with everything; repeatable.")  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="Print the comparison as JSON.")
@limit_options()
def command(
    a: str | None,
    b: str | None,
    profiles: Sequence[str],
    rules: dict[str, Any],
    simulated: dict[str, bool],
    outputs: Sequence[str],
    as_json: bool,
    limits: Limits,
    **options: Any,
) -> int:
    """Compare two ways to cut NEST: figures, rules, cuts that differ, and a picture of both routes.

    A and B are plans or programs of NEST. A missing one is planned: by two profiles, or by one with rules on or
    off.
    """
    from . import pair_of

    with_, without, relax = rules["with_"], rules["without"], rules["relax"]
    _expect_two(a, b, profiles, with_, without)
    _expect_outputs(outputs, (options["nest"], a, b))
    inputs = _given_twice(profiles or [None], options | {"last": a})
    for side in inputs:
        protect(side, options["nest"], outputs, a, b)
    for text in dict.fromkeys(text for side in inputs for text in side.profile.time_and_price_notes()):
        print_note(text)
    pair = pair_of(inputs, a, b, with_, without, limits, relax)
    comparison = _compared(pair, simulated["heat"])
    if comparison is None:
        return 1
    if simulated["distortion"]:
        comparison = _with_distortion(comparison, pair)
    files = comparison.save(*outputs)
    click.echo(json.dumps(comparison.as_json(), ensure_ascii=False) if as_json else comparison)
    if files and not as_json:
        click.echo("written: " + ", ".join(escape_text(str(path)) for path in files))
    return 130 if comparison.interrupted else 0


def _with_distortion(comparison: Comparison, pair: Sequence[SideAsked]) -> Comparison:
    """The same with two more figures: how far parts will be off, at the most and on average, mm."""
    from kerfwise.apps.distortion.predict import distort_made

    from .differences import Figure

    a, b = (
        distort_made(side.given, str(request.file) if side.plan is None else side.plan)
        for side, request in zip((comparison.a, comparison.b), pair, strict=True)
    )
    more = (
        Figure("off_max_mm", "worst part off", "mm", a.max_mm, b.max_mm),
        Figure("off_mean_mm", "parts off, mean", "mm", a.mean_mm, b.mean_mm),
    )
    return replace(comparison, figures=(*comparison.figures, *more))


def _expect_two(
    a: str | None, b: str | None, profiles: Sequence[str], with_: Sequence[str], without: Sequence[str]
) -> None:
    from . import expect_two

    if len(profiles) > 2:
        raise click.UsageError(f"--profile is given {len(profiles)} times: two at the most, that of A and that of B")
    try:
        expect_two(a, b, len(profiles), with_, without)
    except InputError as error:
        raise click.UsageError(error.message) from None


def _expect_outputs(outputs: Sequence[str], inputs: Sequence[str | None]) -> None:
    from kerfwise.postproc.output_files import expect_outputs

    from .comparison import expect_kinds

    expect_kinds(outputs)
    expect_outputs(map(Path, outputs), (Path(name) for name in inputs if name))


def _given_twice(profiles: Sequence[str | None], options: dict[str, Any]) -> tuple[Inputs, Inputs]:
    """The nest by the profile of A and by that of B; what the reader says twice is said once."""
    if len(profiles) < 2 or profiles[0] == profiles[1]:
        first = read_inputs(profile=profiles[0], **options)
        return first, first
    captured = io.StringIO()
    try:
        with contextlib.redirect_stderr(captured):
            return read_inputs(profile=profiles[0], **options), read_inputs(profile=profiles[1], **options)
    finally:
        for line in dict.fromkeys(captured.getvalue().splitlines()):
            click.echo(line, err=True)


def _compared(requests: Sequence[SideAsked], heat: bool) -> Comparison | None:
    """Both sides; None where one has no plan, which is said."""
    from kerfwise.commands.progress import ProgressLine
    from kerfwise.jobs.request import NoPlan

    from . import compare, side_of

    sides = []
    for letter, side in zip("AB", requests, strict=True):
        already: set[str] = set()

        def tell(text: str, letter: str = letter, seen: set[str] = already) -> None:
            if text not in seen:
                seen.add(text)
                print_note(f"{letter}: {text}")

        try:
            sides.append(side_of(side, heat, ProgressLine(), tell))
        except NoPlan as no_plan:
            click.echo(f"kerfwise: {letter}, {escape_text(side.name)}: {no_plan}", err=True)
            return None
    return compare(sides[0], sides[1])
