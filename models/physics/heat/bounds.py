"""How much a simulation may take: said before any memory is taken or any step is made."""

from __future__ import annotations

from pathlib import Path

from kerfwise.encoder.errors import InputError
from kerfwise.rules.profile.heat_section import Heat

from .physical import point_steps
from .timed_path import TimedPath

MOST_S = 7 * 86400.0
"""The longest program that is simulated, s: a week."""
MOST_POINT_STEPS = 2e13
"""The most points times steps: half a day on a usual machine."""


def expect_bounded(metal_points: int, path: TimedPath, heat: Heat) -> None:
    """Refuse what would take days or all memory.

    Parameters
    ----------
    metal_points
        Points of the grid that are metal.
    path
        Where the torch burns, and when.
    heat
        The profile's section `heat`.

    Raises
    ------
    InputError
        If the program takes over a week, naming the contour that takes the longest; or if the grid's points times the
        steps in time are too many, naming the profile's key.
    """
    expect_short(path)
    if heat.model == "logical":
        steps, key = metal_points * path.end_s / heat.logical_step_s, "heat.logical_step"
        given = f"{heat.logical_step_s:g} s"
        least = f"{heat.logical_step_s * steps / MOST_POINT_STEPS:.2g} s"
    else:
        steps, key = point_steps(metal_points * heat.grid_mm**2, path.end_s, heat), "heat.grid"
        given = f"{heat.grid_mm:g} mm"
        least = f"{heat.grid_mm * (steps / MOST_POINT_STEPS) ** 0.25:.2g} mm"
    if steps > MOST_POINT_STEPS:
        raise InputError(
            f"{key}: {given} makes {steps:.1e} steps of points of this program, and {MOST_POINT_STEPS:.0e} is the "
            f"most; give about {least} or more"
        )


def expect_short(path: TimedPath, file: str | Path | None = None) -> None:
    """Refuse a path of more than a week.

    Raises
    ------
    InputError
        With the file, and the contour that takes the longest.
    """
    if not path.end_s <= MOST_S:
        contour, what, seconds = longest(path)
        raise InputError(
            f"the program takes {path.end_s / 3600:.4g} h, and heat is simulated for up to {MOST_S / 3600:g} h; the "
            f"longest is {contour}, {what} takes {seconds / 3600:.4g} h: correct its feeds and waits",
            file=file,
        )


def longest(path: TimedPath) -> tuple[str, str, float]:
    """The contour of the longest cut or wait of a path, which of them it is, in words, and how long it takes, s.

    Examples
    --------
    >>> import numpy as np
    >>> from .timed_path import in_order, torch_on
    >>> line = np.array([[0.0, 0.0], [9.0, 0.0]])
    >>> longest(in_order([torch_on("A", line, 0.0, 5.0), torch_on("B", line, 95.0, 99.0)], 99.0))
    ('B', 'whose way and wait before it', 90.0)
    """
    begins_s = [0.0, *(float(burn.at_s[-1]) for burn in path.burns)]
    found = [(burn.seconds, burn.contour, "whose cut") for burn in path.burns]
    found += [
        (float(burn.at_s[0]) - begin_s, burn.contour, "whose way and wait before it")
        for begin_s, burn in zip(begins_s, path.burns, strict=False)
    ]
    found.append((path.end_s - begins_s[-1], "the end", "whose way and wait"))
    seconds, contour, what = max(found)
    return contour, what, seconds
