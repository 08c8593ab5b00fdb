"""The data of a page: nest, plan, verdict, reasons, heat and program of one plan, or of two that are compared."""

from __future__ import annotations

from pathlib import Path

from kerfwise.encoder.shown import shown
from kerfwise.jobs.checking import check_made
from kerfwise.jobs.compare.comparison import Compared
from kerfwise.jobs.compare.side import Side
from kerfwise.jobs.given import Given
from kerfwise.jobs.one_torch import expect_one_torch
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.report.legend import nest_name
from kerfwise.postproc.report.page import page_html
from kerfwise.postproc.report.page_data import Data, page_of, plain_page

from .comparison import comparison_data
from .heat import heat_data
from .program import program_data
from .side import plan_side, program_side
from .why import Detail, reasons


def page_data(
    given: Given,
    plan: Plan | None,
    verdict: CheckResult | None = None,
    program: str | None = None,
    heat: bool | None = None,
    detail: Detail | None = None,
) -> Data:
    """All that the page of a plan shows, as JSON can hold it; of a nest alone where there is no plan.

    Parameters
    ----------
    given
        Nest and profile.
    plan
        Of that nest.
    verdict, program
        Of the plan, where they are known; else they are made.
    heat
        Whether to simulate the heat; None simulates it where that takes seconds.
    detail
        How much is worked out of why each contour is cut where it is; None for all in plans of up to `FULL` contours,
        and for what holds each in larger ones.

    Raises
    ------
    InputError
        If the plan is one of another nest, or of several torches.
    """
    home = given.profile.home_on(given.nest)
    expect_one_torch(given.profile, "the page for the browser", plan)
    if plan is None:
        return plain_page(given.nest, None, home)
    profile = given.profile.at_origin(plan.origin)
    side = plan_side(given, plan, verdict or check_made(given, plan))
    side["why"] = reasons(given, plan, detail)
    side["heat"] = heat_data(given, plan, heat)
    side["nc"] = program_data(program or write_program(plan, given.nest, profile), given.nest, profile)
    return page_of(given.nest, [side], nest_name(given.nest, plan))


def compared_data(made: Compared) -> Data:
    """The page of two plans or programs, with what differs."""
    sides = [
        _compared(side) | {"name": f"{letter}: {shown(side.name)}"} for letter, side in (("A", made.a), ("B", made.b))
    ]
    nest = made.a.given.nest
    title = f"{shown(Path(nest.file or 'nest').name)} compared"
    return page_of(nest, sides, title) | {"comparison": comparison_data(made)}


def _compared(side: Side) -> Data:
    expect_one_torch(side.given.profile, "the page for the browser", side.plan)
    if side.plan is None:
        return program_side(side)
    nest, profile = side.given.nest, side.profile.at_origin(side.plan.origin)
    data = plan_side(side.given, side.plan, side.verdict)
    data["nc"] = program_data(write_program(side.plan, nest, profile), nest, profile)
    data["heat"] = heat_data(side.given, side.plan, side.heat is not None)
    return data


def page_bytes(data: Data) -> bytes:
    """The page as the content of a file."""
    return page_html(data).encode("utf-8")
