"""What --lock-from and --upto ask: the profile with what is already cut locked."""

from __future__ import annotations

from dataclasses import replace

from ..encoder.errors import InputError
from ..rules.profile import Profile


def keeping(profile: Profile, lock_from: str | None, upto: int | None) -> Profile:
    """The profile with the first `upto` cuts of an old plan among its locks.

    Raises
    ------
    InputError
        If one is given without the other, or the plan cannot be read or has fewer cuts.
    """
    from ..models.kept import kept_locks
    from ..models.plan_reader import read_plan

    if lock_from is None and upto is None:
        return profile
    if lock_from is None or upto is None:
        raise InputError("--lock-from PLAN.json and --upto N go together: which plan, and how many of its cuts are cut")
    return replace(profile, locks=(*profile.locks, *kept_locks(read_plan(lock_from), upto, lock_from)))
