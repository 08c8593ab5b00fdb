"""The picture of a plan that has just been made: a page with all that is known of it, or a drawing."""

from __future__ import annotations

from kerfwise.jobs.given import Given
from kerfwise.jobs.produce import Produced
from kerfwise.postproc.report import PAGE, draw

from .drawn_beside import DrawnBeside


def planned_picture(given: Given, made: Produced, suffix: str, beside: DrawnBeside) -> bytes:
    """The content of a picture's file, of the type that its suffix says, the one that was drawn beside if there is one.

    Raises
    ------
    InputError
        If it is none of a picture.
    """
    if suffix.lower() == PAGE:
        from .page import page_bytes, page_data  # asks for most of the package, which a drawing does without

        return page_bytes(page_data(given, made.plan, made.verdict, made.program))
    if (picture := beside.end(made.plan)) is not None:
        return picture
    return draw(given.nest, made.plan, suffix, given.profile.home_on(given.nest))
