"""How long plans without zones, and by other zones, are looked for, and whether that is begun at all.

Up to `FEW` contours a look has a share of the limit, always. In larger nests a plan by the zones of geometry is proven
within a small part of the work, and other zones are proven about as fast: a look has what these two leave. It is not
begun where it would have so little that all goes into its tables.
"""

from __future__ import annotations

from dataclasses import replace

from kerfwise.models.engines.solution import LEAST_SHARE, Solution, SolveOptions
from kerfwise.models.kernels import running_s

SHARE = 0.15
"""Share of a limit in which a plan without zones is looked for, at the most: of one in seconds, of which it is left so
much, or of the work, beside it. As much again is there for a plan by other zones, and what the first plan has left."""
LEAST, A_CONTOUR = 0.5, 0.02
"""Work that it takes at the least, and for every contour."""
FEW, MOST_CONTOURS = 2500, 12_000
"""Contours up to which that share is all it has, and up to which it is looked for."""
LEAST_WORK, LEAST_S, PROVEN_S = 1e-4, 1e-3, 1e-3
"""Work, and seconds by the clock, for every contour of a larger nest, with less of which a look is not begun there; and
seconds that other zones have beside `STATED`, at the least, where there is time for them at all."""
PROOF = 4.0
"""How many times as long as the first plan took is kept for plans by other zones there, or half of what is left."""
STATED = 3.0
"""How many times as long as stating the rules took it takes there to draw zones, to state the rules by them, to make
the problem, and to look at one plan: what comes beside a proof."""
HELD_GB = 1e-4
"""What facts and statements of a contour take there in memory, beside the tables of a proof."""


def begun(contours: int, limits: SolveOptions) -> bool:
    """Whether a plan without zones is looked for at all, as far as can be told before the first plan.

    Examples
    --------
    >>> [begun(10_000, SolveOptions(work=work)) for work in (0.1, 10.0)], begun(2_000, SolveOptions(work=0.1))
    ([False, True], True)
    """
    if contours <= FEW:
        return True
    if contours > MOST_CONTOURS:
        return False
    if limits.time_s is None:
        return limits.work / 2 >= LEAST_WORK * contours
    return SHARE * limits.time_s >= LEAST_S * contours


def look_for(
    contours: int, limits: SolveOptions, ends_s: float | None, first: Solution, stated_s: float = 0.0
) -> SolveOptions | None:
    """How long a plan without zones is looked for; None for not at all.

    Parameters
    ----------
    ends_s
        When a limit in seconds ends, by `running_s`.
    first
        The plan by the zones of geometry.
    stated_s
        How long it took to state the rules.
    """
    if contours <= FEW:
        return _share(contours, limits, ends_s)
    if not begun(contours, limits):
        return None
    if limits.time_s is None or ends_s is None:
        left = limits.work - first.seconds
        work = max(left - min(PROOF * first.seconds, left / 2), SHARE * limits.work)
        return replace(limits, work=work) if work >= LEAST_WORK * contours else None
    left_s = ends_s - running_s()
    kept_s = min(PROOF * first.seconds, left_s / 2)
    all_s = max(kept_s, STATED * stated_s + PROVEN_S * contours)
    times_s = [left_s - all_s, left_s - kept_s]  # where zones have no time to move, what they cost is looked for alone
    time_s = next((time_s for time_s in times_s if time_s >= LEAST_S * contours), None)
    return None if time_s is None else replace(limits, time_s=time_s)


def look_again(contours: int, limits: SolveOptions, ends_s: float | None) -> SolveOptions | None:
    """How long a plan that mixes neighbouring zones is looked for, where the other one was of no avail."""
    found = _share(contours, limits, ends_s)
    if contours <= FEW:
        return found
    if found.time_s is None:
        return found if found.work >= LEAST_WORK * contours else None
    return found if found.time_s >= LEAST_S * contours else None


def _share(contours: int, limits: SolveOptions, ends_s: float | None) -> SolveOptions:
    if limits.time_s is None or ends_s is None:
        return replace(limits, work=min(SHARE * limits.work, max(LEAST, A_CONTOUR * contours)))
    left_s = (ends_s - running_s()) / 2
    return replace(limits, time_s=max(min(SHARE * limits.time_s, left_s), SHARE * LEAST))


def beside(contours: int, looked: float, limits: SolveOptions) -> float:
    """How much of the work of a look is missing for plans by other zones; those have as much beside it as a look."""
    return 0.0 if contours <= FEW else looked - 2 * SHARE * limits.work


def once_more(contours: int, limits: SolveOptions, ends_s: float | None, spent: float) -> SolveOptions:
    """How long a plan by other zones may take: as long as the limit leaves, where so much work of it is spent."""
    if contours > FEW:
        limits = replace(limits, memory_gb=max(limits.memory_gb - HELD_GB * contours, LEAST_SHARE * limits.memory_gb))
    if limits.time_s is None or ends_s is None:
        return replace(limits, work=max(limits.work - spent, SHARE * limits.work))
    return replace(limits, time_s=max(ends_s - running_s(), SHARE * LEAST))
