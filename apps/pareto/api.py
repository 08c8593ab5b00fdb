"""`kerfwise.trade_off`: plans at several prices of an overheat."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from kerfwise.api.planning import already_cut_by
from kerfwise.api.reading import LockLike, Settings, nest_request
from kerfwise.apps.pareto.pareto import Offer
from kerfwise.apps.pareto.pareto import trade_off as made_trade_off
from kerfwise.encoder.errors import InputError
from kerfwise.jobs.inputs import NestLike, ProfileLike
from kerfwise.jobs.nest_job.request import JobLike, inputs_for
from kerfwise.jobs.progress import Listener, OnProgress
from kerfwise.jobs.request import options_for
from kerfwise.jobs.result import Result
from kerfwise.models.plan.plan import Plan
from kerfwise.rules.profile.plant_sections import PRICES_MM


def trade_off(
    nest: NestLike,
    profile: ProfileLike | None = None,
    *,
    prices_mm: Iterable[float] = PRICES_MM,
    locks: Iterable[LockLike] | LockLike = (),
    job: JobLike = None,
    settings: Settings = (),
    time_s: float | None = None,
    work: float = 10.0,
    seed: int = 1,
    gap: float | None = None,
    no_improvement_s: float | None = None,
    relax: bool = False,
    resume_from: Plan | Result | str | Path | None = None,
    upto: int | None = None,
    redo_last: bool = False,
    on_progress: OnProgress | None = None,
) -> Offer:
    """Plan a nest at several prices of an overheat, and simulate every plan: idle travel against overheats.

    Parameters
    ----------
    nest, profile, locks, job, settings, relax, resume_from, upto, redo_last
        As for `solve`.
    prices_mm
        Prices of one overheat, each in mm of idle travel.
    time_s, work, seed, gap, no_improvement_s
        Limits and seed of each plan, as for `solve`.
    on_progress
        As for `solve`.

    Returns
    -------
    Offer
        `trades`, and `front`: those that no other beats; `picture()`, `to_frame()`, `save(folder)`.

    Raises
    ------
    InputError
        If something given cannot be used.
    RulesConflict
        If the rules leave no plan at all.

    Examples
    --------
    >>> import kerfwise
    >>> offer = kerfwise.trade_off("examples/nests/e1x_6.json", prices_mm=[0], work=1)
    >>> len(offer.front)
    1
    """
    inputs = inputs_for(nest, nest_request(profile, job, settings, locks, resume_from))
    prices = tuple(prices_mm)
    for price in prices:
        if not isinstance(price, int | float) or not 0 <= price < float("inf"):
            raise InputError(f"prices_mm: expected numbers from 0, got {price!r}")
    limits = options_for(
        inputs.nest, inputs.profile, work=work, seed=seed, time_s=time_s, gap=gap, no_improvement_s=no_improvement_s
    )
    return made_trade_off(
        inputs, prices, limits, lambda: Listener(on_progress), inputs.nest.file,
        already=already_cut_by(inputs, resume_from, upto, redo_last, []), relax=relax,
    )  # fmt: skip
