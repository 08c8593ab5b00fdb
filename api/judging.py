"""What a finished plan or program is worth: verdicts, reasons, times, pictures; two of them compared."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from kerfwise.apps.viewer.compare import Comparison, SideAsked, expect_two, pair_of, side_of
from kerfwise.apps.viewer.compare import compare as compared
from kerfwise.apps.viewer.compare.sides import Side
from kerfwise.jobs.display import Picture, PictureKind
from kerfwise.jobs.explainer import Explainer
from kerfwise.jobs.inputs import NestLike, ProfileLike
from kerfwise.jobs.nest_job.request import JobLike, inputs_for
from kerfwise.jobs.programs import Times, check_made, time_made
from kerfwise.jobs.progress import Listener, OnProgress
from kerfwise.jobs.request import WORK, NoPlan
from kerfwise.jobs.result import Result
from kerfwise.jobs.simulation import Simulation, simulate_made
from kerfwise.models.plan.explain import Explanation
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.report import draw as drawn
from kerfwise.postproc.report.picture import Spot

from .reading import LockLike, PlanOrResult, Settings, nest_request, plan_of, plan_or_path

if TYPE_CHECKING:
    from kerfwise.apps.distortion.predict import Distortion
    from kerfwise.rules.profile.plant_sections import HeatModel


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


def distort(
    nest: NestLike,
    made: PlanOrResult,
    profile: ProfileLike | None = None,
    *,
    grid_mm: float | None = None,
    yields: bool = True,
    job: JobLike = None,
) -> Distortion:
    """Predict how far each part of a plan or an NC program will be off when it is cold, in mm, and where.

    Parameters
    ----------
    nest, made, profile, job
        As for `check`.
    grid_mm
        Width of a cell of the mesh; None for some 7000 cells to the sheet.
    yields
        Whether metal yields beside the cut.

    Returns
    -------
    Distortion
        `max_mm`, `mean_mm`, `parts` with `max_mm`, `rms_mm` and `at` of each, `beyond` (parts that do not keep their
        tolerance), `picture()`, `as_json()`; print it to read it.

    Raises
    ------
    InputError
        If something given cannot be read or is of another nest, the grid does not fit the sheet, or nothing is known of
        the material's strength.

    Examples
    --------
    >>> import kerfwise
    >>> nest = kerfwise.read_nest("examples/nests/e1x_6.json")
    >>> found = kerfwise.distort(nest, kerfwise.solve(nest, work=2), grid_mm=16)
    >>> 0 < found.mean_mm <= found.max_mm < 0.2
    True
    """
    from kerfwise.apps.distortion.predict import distort_made  # scipy: only those who ask pay for it

    inputs = inputs_for(nest, nest_request(profile, job, last=made))
    return distort_made(inputs, plan_or_path(made), grid_mm=grid_mm, yields=yields)


def simulate(
    nest: NestLike,
    made: PlanOrResult,
    profile: ProfileLike | None = None,
    *,
    model: HeatModel | None = None,
    job: JobLike = None,
) -> Simulation:
    """Simulate how hot a plan or an NC program makes the sheet.

    Parameters
    ----------
    nest, made, profile, job
        As for `check`; the profile's section `heat` says how fine the grid is and how hot is too hot.
    model
        "physical" or "logical", instead of the profile's.

    Returns
    -------
    Simulation
        `overheats`, `peak_c`, `parts`; `found.run.peak_c` is the map (nx, ny), °C; `picture()` draws it.

    Raises
    ------
    InputError
        If something given cannot be read or is of another nest, or the grid does not fit the sheet.

    Examples
    --------
    >>> import kerfwise
    >>> nest = kerfwise.read_nest("examples/nests/e1x_6.json")
    >>> heat = kerfwise.simulate(nest, kerfwise.solve(nest, work=2))
    >>> heat.peak_c > 20, len(heat.parts)
    (True, 8)
    """
    return simulate_made(inputs_for(nest, nest_request(profile, job, last=made)), plan_or_path(made), model)


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
        from kerfwise.apps.viewer.page.page_data import page_bytes, page_data

        return Picture(page_bytes(page_data(inputs, plan)), kind)
    return Picture(drawn(inputs.nest, plan, f".{kind}", plant.home_on(inputs.nest), spot), kind)


def compare(
    nest: NestLike,
    a: PlanOrResult | None = None,
    b: PlanOrResult | None = None,
    profile: ProfileLike | None = None,
    profile_b: ProfileLike | None = None,
    *,
    with_: Iterable[str] | str = (),
    without: Iterable[str] | str = (),
    heat: bool = False,
    locks: Iterable[LockLike] | LockLike = (),
    job: JobLike = None,
    settings: Settings = (),
    time_s: float | None = None,
    work: float = WORK,
    seed: int = 1,
    relax: bool = False,
    on_progress: OnProgress | None = None,
) -> Comparison:
    """Put two ways to cut a nest side by side: figures, what each rule costs, which cuts differ, both routes.

    Parameters
    ----------
    nest
        A nest, or the path of its file.
    a, b
        Plans, results, or the paths of plans (.json) or of NC programs. What is None is planned now.
    profile, profile_b
        Profiles, names or paths: that of A, or of both, and that of B. None as for `solve`.
    with_, without
        Rules that B is planned with, such as "t-max" or "hull-before=soft", and without.
    heat
        Simulate how hot both make the sheet.
    locks, job, settings, time_s, work, seed, relax, on_progress
        As for `solve`, for both; limits are those of each plan.

    Returns
    -------
    Comparison
        `figures`, `rules`, `changed`, `claim`; print it to read it; `picture()`, `save(…)`, `as_json()`.

    Raises
    ------
    InputError
        If something given cannot be used, or a plan or program is of another nest.
    NoPlan
        If a side is to be planned, and no plan keeps the hard rules: a note of the error says which side.
    KeyboardInterrupt
        If Ctrl-C was pressed before there was a plan.

    Examples
    --------
    >>> import kerfwise
    >>> made = kerfwise.compare("examples/nests/e1x_6.json", without="level-ahead", work=2)
    >>> [figure.texts for figure in made.figures if figure.key == "idle_mm"]
    [('1.873 m', '1.682 m', '-10.2%')]
    >>> made.a.plan.solve.status, made.b.verdict.ok, [pair.told for pair in made.changed][0]
    ('optimal', True, 'moved, entry 32.6 mm away')
    """
    on, off = _listed(with_), _listed(without)
    first, second = (None if side is None else plan_or_path(side) for side in (a, b))
    profiles = [profile] if profile_b is None else [profile, profile_b]
    expect_two(first, second, len(profiles), on, off)
    notes: list[str] = []
    inputs = [inputs_for(nest, nest_request(one, job, settings, locks, a), notes.append) for one in profiles]
    limits = {"work": work, "seed": seed, "time_s": time_s}
    of_a, of_b = pair_of((inputs[0], inputs[-1]), first, second, on, off, limits, relax)
    side_a, side_b = _side("A", of_a, heat, on_progress, notes), _side("B", of_b, heat, on_progress, notes)
    return compared(side_a, side_b, notes=tuple(dict.fromkeys(notes)))


def _side(letter: str, request: SideAsked, heat: bool, on_progress: OnProgress | None, notes: list[str]) -> Side:
    listener = Listener(on_progress)
    try:
        return side_of(request, heat, listener, lambda text: notes.append(f"{letter}: {text}"))
    except NoPlan as error:
        if listener.interrupted:
            raise KeyboardInterrupt from None
        error.add_note(f"{letter}: {request.name}")
        raise


def _listed(names: Iterable[str] | str) -> list[str]:
    return [names] if isinstance(names, str) else list(names)
