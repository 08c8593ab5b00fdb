"""Whether a picture's plan is one of its nest."""

from __future__ import annotations

from collections.abc import Iterable

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.models.plan.plan import Plan


def expect_known(nest: Nest, plan: Plan | None, named: Iterable[str] = ()) -> None:
    """Say that a plan, or a list of contours, is not of this nest.

    Raises
    ------
    InputError
        If the plan cuts, or the list names, a contour that the nest does not have.
    """
    cuts = [] if plan is None else [planned.cut.contour for planned in plan.cuts]
    unknown = [c for c in (*cuts, *named) if c not in nest.index]
    if unknown:
        raise InputError(
            f"no contour {unknown[0]!r} in the nest ({len(unknown)} unknown in all): is it the nest of this plan?",
            file=nest.file or None,
        )
