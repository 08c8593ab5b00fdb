"""What is already cut stays as it was: the first cuts of an old plan as locks for a new one."""

from __future__ import annotations

from ..encoder.errors import InputError
from ..rules.lock import Lock
from .plan import Plan


def kept_locks(plan: Plan, upto: int, file: str = "") -> tuple[Lock, ...]:
    """Locks on place, entry and direction of the plan's first `upto` cuts; `file` is the plan's, for sentences.

    Raises
    ------
    InputError
        If the plan has fewer cuts.
    """
    if upto > len(plan.cuts):
        raise InputError(f"--upto {upto}: the plan has {len(plan.cuts)} cuts only", file=file or None)
    locks = []
    for k, planned in enumerate(plan.cuts[:upto], 1):
        cut, reason = planned.cut, f"kept as cut {k} of {file or 'the old plan'}"
        locks.append(Lock(contour=cut.contour, position=k, entry=cut.entry, direction=cut.direction, reason=reason))
    return tuple(locks)
