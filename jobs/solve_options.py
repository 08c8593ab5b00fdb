"""The limits of a solve for one nest and one profile: whoever solves gets home and feeds from here."""

from __future__ import annotations

import math

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.models.engines.names import ENGINES, Engine, member_of
from kerfwise.models.engines.solution import MEMORY_GB, SolveOptions
from kerfwise.models.physics.timing.choose import feeds_of
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.profile.profile import Profile

WORK = 30.0
"""The deterministic limit where nobody gives another."""


def options_for(
    nest: Nest,
    profile: Profile,
    *,
    work: float = WORK,
    seed: int = 1,
    time_s: float | None = None,
    gap: float | None = None,
    no_improvement_s: float | None = None,
    engine: Engine = "portfolio",
    memory_gb: float = MEMORY_GB,
) -> SolveOptions:
    """The limits given, with the machine's home on this nest and the feeds that plans are made with.

    See `SolveOptions` for what each limit means.

    Raises
    ------
    InputError
        For a limit that is not above 0, a gap outside 0 … 1, a seed that is no whole number from 0, or an engine that
        there is not.

    Examples
    --------
    >>> from kerfwise.encoder.by_hand import nest, part, rect
    >>> from kerfwise.rules.profile.load import load_profile
    >>> plate = nest(100, 100, part("A", rect(10, 10, 80, 80)))
    >>> options = options_for(plate, load_profile(), work=2, engine="beam")
    >>> options.work, options.member, options.home_mm, round(options.feeds.cut_mm_s, 1)
    (2, 'beam', (0.0, 0.0), 41.7)
    """
    amounts = {"work": work, "time_s": time_s, "no_improvement_s": no_improvement_s, "memory_gb": memory_gb}
    for name, amount in amounts.items():
        if amount is not None:
            _expect(name, amount, "a number over 0", _is_number(amount) and amount > 0)
    if gap is not None:
        _expect("gap", gap, "a share from 0 to 1, such as 0.01", _is_number(gap) and 0 <= gap <= 1)
    _expect("seed", seed, "a whole number from 0", isinstance(seed, int) and seed >= 0)
    if engine not in ENGINES:
        raise InputError(unknown("engine", str(engine), ENGINES))
    home_mm, feeds, member = profile.home_on(nest), feeds_of(profile), member_of(engine)
    return SolveOptions(seed, work, time_s, home_mm, feeds, gap, no_improvement_s, member, memory_gb)


def _is_number(given: object) -> bool:
    return isinstance(given, int | float) and math.isfinite(given)


def _expect(name: str, given: object, expected: str, fits: bool) -> None:
    if not fits:
        raise InputError(f"{name}: expected {expected}, got {given!r}")
