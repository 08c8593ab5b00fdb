"""`kerfwise.simulate`: how hot a plan or a program makes the sheet."""

from __future__ import annotations

from kerfwise.api.reading import PlanOrResult, nest_request, plan_or_path
from kerfwise.jobs.inputs import NestLike, ProfileLike
from kerfwise.jobs.nest_job.request import JobLike, inputs_for
from kerfwise.rules.profile.plant_sections import HeatModel

from .simulation import Simulation, simulate_made


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
