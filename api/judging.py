"""What a finished plan or program is worth: verdicts, reasons, times, pictures; two of them compared."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from kerfwise.app_modules import app_module
from kerfwise.jobs.display import Picture, PictureKind
from kerfwise.jobs.explainer import Explainer
from kerfwise.jobs.inputs import NestLike, ProfileLike
from kerfwise.jobs.nest_job.request import JobLike, inputs_for
from kerfwise.jobs.programs import Times, check_made, time_made
from kerfwise.jobs.result import Result
from kerfwise.models.plan.explain.explain import Explanation
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.report import draw as drawn
from kerfwise.postproc.report.picture import Spot

from .reading import PlanOrResult, nest_request, plan_of, plan_or_path


def check(
    nest: NestLike,
    made: PlanOrResult,
    profile: ProfileLike | None = None,
    plan: PlanOrResult | None = None,
    *,
    job: JobLike = None,
) -> CheckResult:
    """Judge a plan or an NC program by every rule, independently of whatever made it: from geometry and profile alone.

    Parameters
    ----------
    nest
        A nest, or the path of its file.
    made
        A plan, a result, or the path of a plan (.json) or of an NC program.
    profile
        A profile, its name or its path; None for that of the job file, or "plasma-carbon-steel".
    plan
        The plan of an NC program, a result, or its path: the program has to follow it, and what the program's comments
        do not say is taken from there.
    job
        As for `solve`: None for the job file beside the nest's file, False for none.

    Returns
    -------
    CheckResult
        `ok`, `broken()`, a judgement on each rule in `rules`; print it to read it.

    Raises
    ------
    InputError
        If something given cannot be read or understood, with the line.

    Examples
    --------
    >>> import kerfwise
    >>> nest = kerfwise.read_nest("examples/nests/e1x_6.json")
    >>> result = kerfwise.solve(nest, work=2)
    >>> verdict = kerfwise.check(nest, result.plan)
    >>> verdict.ok, verdict.rule("inner-before-outer").verdict
    (True, 'holds')
    """
    of_plan = None if plan is None else plan_or_path(plan)
    return check_made(inputs_for(nest, nest_request(profile, job, last=made)), plan_or_path(made), plan=of_plan)


def explain(
    nest: NestLike,
    made: Plan | Result | str | Path,
    contour: str,
    profile: ProfileLike | None = None,
    *,
    job: JobLike = None,
) -> Explanation:
    """Say why a contour is cut where it is, then, and so, and what moving it would cost.

    `Result.explain` does the same, and is faster where several contours are asked about.

    Parameters
    ----------
    nest, profile, job
        As for `check`.
    made
        A plan, a result, or the path of a plan.
    contour
        Its id, such as "P1.outer".

    Raises
    ------
    InputError
        If the plan does not cut such a contour (with the nearest id), or something given cannot be used.

    Examples
    --------
    >>> import kerfwise
    >>> nest = kerfwise.read_nest("examples/nests/e1x_6.json")
    >>> told = kerfwise.explain(nest, kerfwise.solve(nest, work=2), "part#1.outer")
    >>> str(told).splitlines()[0]  # doctest: +ELLIPSIS
    'part#1.outer is cut ...'
    """
    return Explainer(inputs_for(nest, nest_request(profile, job, last=made)), plan_of(made)).explain(contour)


def times(nest: NestLike, made: PlanOrResult, profile: ProfileLike | None = None, *, job: JobLike = None) -> Times:
    """Say how long a plan or an NC program takes by the profile's time model, and what it costs.

    Parameters
    ----------
    nest, made, profile, job
        As for `check`.

    Returns
    -------
    Times
        `total_s`, `report` with what the seconds are spent on, `cost`; print it to read it.

    Raises
    ------
    InputError
        If something given cannot be read or is of another nest.

    Examples
    --------
    >>> import kerfwise
    >>> nest = kerfwise.read_nest("examples/nests/e1x_6.json")
    >>> took = kerfwise.times(nest, kerfwise.solve(nest, work=2))
    >>> took.total_s > took.report.cut_s > 0
    True
    """
    return time_made(inputs_for(nest, nest_request(profile, job, last=made)), plan_or_path(made))


def draw(
    nest: NestLike,
    made: Plan | Result | str | Path | None = None,
    profile: ProfileLike | None = None,
    *,
    kind: PictureKind = "svg",
    contours: Iterable[str] = (),
    caption: str = "",
    job: JobLike = None,
) -> Picture:
    """Draw a nest, a plan of it, or some of its contours enlarged.

    Parameters
    ----------
    nest, profile, job
        As for `check`.
    made
        A plan, a result, or the path of a plan; without one, the parts are drawn with their names.
    kind
        "svg", "png", or "html" for a page that plays the cuts in order.
    contours
        Ids of the contours to draw enlarged, in red, with what is around them.
    caption
        A sentence that says why they are drawn.

    Returns
    -------
    Picture
        A notebook shows it; `save(path)` writes it.

    Raises
    ------
    InputError
        If something given cannot be used, or the plan or the contours are not of this nest.

    Examples
    --------
    >>> import kerfwise
    >>> kerfwise.draw("examples/nests/e1x_6.json").content[:4]
    b'<svg'
    """
    inputs = inputs_for(nest, nest_request(profile, job, last=made))
    plan = None if made is None else plan_of(made)
    plant = inputs.profile if plan is None else inputs.profile.at_origin(plan.origin)
    named = frozenset([contours] if isinstance(contours, str) else contours)
    spot = Spot(named, caption) if named else None
    if kind == "html" and plan is not None and spot is None:
        page = app_module("viewer.page.page_data")
        return Picture(page.page_bytes(page.page_data(inputs, plan)), kind)
    return Picture(drawn(inputs.nest, plan, f".{kind}", plant.home_on(inputs.nest), spot), kind)
