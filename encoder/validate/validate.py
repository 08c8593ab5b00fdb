"""A nest is checked once, when it is read; from there on everyone may trust it."""

from __future__ import annotations

from dataclasses import replace

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest

from .duplicates import drop_duplicates
from .inside import hole_problems, mark_notes
from .overlaps import overlap_problems, sheet_problems
from .rings import contour_problems, sheet_ring_problems
from .scrap import scrap_problems

MOST_DETAILS = 200


def validated(nest: Nest) -> Nest:
    """The nest without contours drawn twice, every contour a proper ring (or mark) in its place.

    What is only doubtful (contours that touch, lines drawn twice, marks off their part) is added to the notes.

    Raises
    ------
    InputError
        One error for all that is wrong, with a line each in `details`: rings that cross themselves or enclose
        nothing, holes outside their part, parts that overlap or lie off the sheet, scrap lines through parts.

    Examples
    --------
    >>> from kerfwise.encoder.by_hand import nest, part, rect
    >>> validated(nest(100, 50, part("A", rect(5, 5, 60, 20)), part("B", rect(40, 5, 70, 20))))
    Traceback (most recent call last):
    kerfwise.encoder.errors.InputError: the nest cannot be cut as it is drawn: 2 problems
      - A.outer and B.outer overlap by 500.000 mm² at (52.500, 15.000): move one of the parts
      - B.outer reaches 10.000 mm off the sheet at (105.000, 15.000): move the part or give a larger sheet
    """
    parts, notes = drop_duplicates(nest.parts)
    by_contour = contour_problems([c for p in parts for c in p])
    problems = [*sheet_ring_problems(nest.sheet), *by_contour.values()]
    sound = [p for p in parts if not any(c.id in by_contour for c in p)]
    for found, said in (hole_problems(sound), overlap_problems(sound)):
        problems += found
        notes += said
    if not sheet_ring_problems(nest.sheet):
        problems += sheet_problems(sound, nest.sheet)
        problems += scrap_problems(nest.scrap, sound, nest.sheet)
    if problems:
        raise wrong("the nest cannot be cut as it is drawn", problems)
    return replace(nest, parts=parts, notes=(*nest.notes, *notes, *mark_notes(parts)))


def wrong(message: str, problems: list[str]) -> InputError:
    """One error for a list of problems; a very long list is cut short and says so."""
    count = f"{len(problems)} problem{'s' if len(problems) != 1 else ''}"
    shown = problems[:MOST_DETAILS]
    if len(problems) > MOST_DETAILS:
        shown.append(f"… and {len(problems) - MOST_DETAILS} more")
    return InputError(f"{message}: {count}", details=tuple(shown))
