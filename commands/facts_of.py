"""From a nest and a profile to its facts and statements: the part that several verbs share."""

from __future__ import annotations

from ..encoder.candidates import build_candidates
from ..encoder.facts import compute_facts
from ..encoder.facts.facts import Facts
from ..rules.lock import check_locks
from .given import Given


def facts_of(given: Given) -> Facts:
    """All facts of the nest under the profile's thresholds.

    Raises
    ------
    InputError
        If a lock names what the nest does not have, or a contour cannot be cut as the profile asks.
    """
    check_locks(given.profile.locks, given.nest)
    candidates = build_candidates(given.nest, given.profile.lead_options())
    return compute_facts(given.nest, given.profile.fact_options(given.nest), candidates)
