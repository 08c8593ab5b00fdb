"""Nests whose rules cannot hold, repaired: the parts of a sheet moved apart on it, where there is room to spare."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import replace

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.jobs.listening import Listener, Listeners
from kerfwise.jobs.main_job import Finished
from kerfwise.nesting.allot import Sheetful, laid_anew
from kerfwise.nesting.fill import LEFT, Taste
from kerfwise.nesting.shapes import Shapes
from kerfwise.nesting.written import OF
from kerfwise.rules.profile.profile import Profile

from .programs import plan_sheet
from .run import Nested, nests_from

_WIDER = (0.25, 0.75, 1.5)
"""By how much of the gap parts have more around them, in turn; of `_LEAST_MM` where the gap is less."""
_LEAST_MM = 2.0
_SMALLER = (2, 1, 0)
"""How often blocks with common edges are doubled instead, in turn."""
_TASTES = (LEFT, Taste(0.01, 1.0), Taste(blocks=True))


def plan_or_repair(
    nested: Nested, number: int, plan: Callable[[str, str], Finished], stopped: Callable[[], bool]
) -> tuple[Nested, Finished, str]:
    """Plan a sheet; where it cannot be cut, move its parts apart and plan it again.

    First the parts that the refusal names are moved, then all. The sheet stays the same, and so does what lies on it.

    Parameters
    ----------
    nested, number
        The nests, and which of them, from 0 on.
    plan
        Plans a nest: takes its name and its text.
    stopped
        Whether somebody wants no more of it.

    Returns
    -------
    The nests, the plan, and what was moved, in a clause; nothing where nothing was.

    Raises
    ------
    InputError, RulesConflict
        The first refusal, if the parts have no room to be moved, or cannot be cut for another reason.
    """
    name = nested.names[number]
    try:
        return nested, plan(name, nested.texts[number]), ""
    except (InputError, RulesConflict) as error:
        for made, how in _moved(nested, number, str(error)):
            if stopped():
                break
            if made.faults:
                continue
            try:
                return made, plan(name, made.texts[number]), f"{name} repaired: {how}"
            except (InputError, RulesConflict):
                continue
        raise


def _moved(nested: Nested, number: int, refusal: str) -> Iterator[tuple[Nested, str]]:
    """The nests with the parts of one sheet further apart, wider and wider."""
    layout, sheet = nested.layout, nested.layout.sheets[number]

    def anew(full: Sheetful) -> Nested:
        return nests_from(replace(layout, sheets=(*layout.sheets[:number], full, *layout.sheets[number + 1 :])))

    if layout.spacing.common is not None:
        for doubled in _SMALLER:
            if (placed := _laid(nested, sheet, {}, doubled)) is not None:
                yield (
                    anew(placed),
                    f"blocks of {2**doubled} parts with common edges at most" if doubled else "no blocks",
                )
    kinds = sorted({one.kind for one in sheet.placed})
    named = _named(nested, number, refusal) or set(kinds)
    spacing = layout.spacing
    for widened in [named] if named == set(kinds) else [named, set(kinds)]:
        for share in _WIDER:
            more_mm = share * max(spacing.gap_mm, _LEAST_MM)
            if (placed := _laid(nested, sheet, dict.fromkeys(widened, more_mm))) is None:
                break
            names = ", ".join(layout.wanted.types[kind].name for kind in sorted(widened))
            told = "all parts" if widened == set(kinds) else names
            yield anew(placed), f"{more_mm:.3g} mm more around {told}"


def _named(nested: Nested, number: int, refusal: str) -> set[int]:
    """The part types that a refusal is about."""
    words = set(re.findall(r"[^\s,;:()]+", refusal))
    said = {word.rsplit(".", 1)[0] for word in words} | words
    numbers = {kind.name: k for k, kind in enumerate(nested.layout.wanted.types)}
    parts = nested.nests[number].parts
    return {numbers[str(part.attributes[OF])] for part in parts if part.id in said}


def _laid(nested: Nested, sheet: Sheetful, more: dict[int, float], doubled: int = 0) -> Sheetful | None:
    """The sheet with its parts laid once more, some with so much more around them; None where they have no room.

    Blocks with common edges are doubled so often at the most; 0: none are made.
    """
    layout = nested.layout
    shapes = Shapes(
        layout.wanted.types, layout.spacing.gap_mm, layout.spacing.common if doubled else None, more, doubled
    )
    tastes = [replace(taste, blocks=taste.blocks or doubled > 0) for taste in _TASTES]
    return laid_anew(sheet, sheet.placed, shapes, layout.spacing, tastes)


def planned(
    nested: Nested,
    number: int,
    profile: Profile,
    work: float,
    listener: Callable[[str], Listener],
    relax: bool = False,
) -> tuple[Nested, Finished, str]:
    """A sheet planned as `kerfwise solve` would plan it, repaired where that is needed: see `plan_or_repair`."""
    heard = Listeners(listener)

    def plan(name: str, text: str) -> Finished:
        return plan_sheet(name, text, profile, work, relax=relax, listener=heard(name))

    return plan_or_repair(nested, number, plan, lambda: heard.stopped)
