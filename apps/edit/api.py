"""`kerfwise.edit`: a nest that changes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from kerfwise.api.reading import LockLike, Settings, nest_request
from kerfwise.apps.edit.edited_nest import EditedNest, contours_cut, editing
from kerfwise.jobs.inputs import NestLike, ProfileLike
from kerfwise.jobs.nest_job.request import JobLike, inputs_for
from kerfwise.models.plan.plan import Plan


def edit(
    nest: NestLike,
    profile: ProfileLike | None = None,
    *changes: str,
    cut_by: Plan | str | Path | None = None,
    upto: int | None = None,
    gap_mm: float | None = None,
    edge_mm: float | None = None,
    job: JobLike = None,
    settings: Settings = (),
    locks: Iterable[LockLike] | LockLike = (),
    answers: Mapping[str, str] | None = None,
) -> EditedNest:
    """A nest that can be changed, as `kerfwise edit` does: each change gives another one, and can be undone.

    Parameters
    ----------
    nest, profile, job, settings, locks, answers
        As for `solve`.
    changes
        Such as "drop P1", "keep P1 P2", "move P1 10 -5", "turn P1 90", "mirror P1", "sheet 400x300",
        "add bracket.dxf=2", "nest-anew P1" (all but P1).
    cut_by, upto
        A plan or program that is cut already, wholly or up to that cut: its parts stay where they are.
    gap_mm, edge_mm
        Distances, mm, instead of those of the profile.

    Returns
    -------
    EditedNest
        `nest`, `off`, `do`, `undo`, `redo`, `save`.

    Raises
    ------
    InputError
        If something given cannot be used, there is no such part, or parts would come too near to each other.

    Examples
    --------
    >>> import kerfwise
    >>> changed = kerfwise.edit("examples/nests/e1x_6.json", None, "drop part#1").do("drop part#3")
    >>> len(changed.nest.parts), len(changed.undo().nest.parts)
    (6, 7)
    """
    inputs = inputs_for(nest, nest_request(profile, job, settings, locks, cut_by, answers))
    done = contours_cut(inputs, nest if isinstance(nest, str | Path) else None, cut_by, upto)
    edited = editing(inputs.nest, inputs.profile, gap_mm=gap_mm, edge_mm=edge_mm, cut=done)
    return edited.do(*changes) if changes else edited
