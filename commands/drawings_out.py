"""The drawing of a nest in cutting order, as solve writes it for the senders of others."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kerfwise.encoder.errors import InputError

from .given import reading_of, tell_note

if TYPE_CHECKING:
    from kerfwise.jobs.given import Given
    from kerfwise.models.plan.plan import Plan


def expect_drawings(svg: str | None, dxf: str | None) -> None:
    """Say at once that a name does not end as its kind does."""
    for name, suffix in ((svg, ".svg"), (dxf, ".dxf")):
        if name and Path(name).suffix.lower() != suffix:
            raise InputError(f"the reordered drawing is written as {suffix}: give a name that ends so", file=name)


def expect_as_drawn(given: Given, svg: str | None, dxf: str | None) -> None:
    """Say before the work that the drawing does not show what is cut."""
    if (svg or dxf) and given.nest.bridges:
        option = "--svg" if svg else "--reordered-dxf"
        raise InputError(
            f"{option}: bridges join parts, and the drawing has these apart: --dxf writes the torch's paths"
        )


def drawings(
    plan: Plan, given: Given, svg: str | None, dxf: str | None, options: Mapping[str, Any]
) -> dict[Path, str | bytes]:
    """The files that are asked for; what is not in them is said."""
    if not svg and not dxf:
        return {}
    from kerfwise.postproc.nc.reordered_dxf import reordered_dxf
    from kerfwise.postproc.nc.reordered_svg import reordered_svg

    files: dict[Path, str | bytes] = {}
    for name, reordered in ((svg, reordered_svg), (dxf, reordered_dxf)):
        if name:
            made = reordered(plan, given.nest, options["nest"], reading_of(given, options))
            files[Path(name)] = made.content
            for note in made.notes:
                tell_note(f"{name}: {note}")
    return files
