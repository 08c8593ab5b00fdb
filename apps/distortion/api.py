"""`kerfwise.distort`: how far each part will be off."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kerfwise.api.reading import PlanOrResult, nest_request, plan_or_path
from kerfwise.jobs.inputs import NestLike, ProfileLike
from kerfwise.jobs.nest_job.request import JobLike, inputs_for

if TYPE_CHECKING:
    from kerfwise.apps.distortion.predict import Distortion


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
