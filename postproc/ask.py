"""What is asked of a plan: the facts of a nest, and what a profile's rules state of them."""

from __future__ import annotations

from dataclasses import dataclass

from ..encoder.candidates import build_candidates
from ..encoder.facts import compute_facts
from ..encoder.facts.facts import Facts
from ..encoder.nest import Nest
from ..models.engines import Engine
from ..rules.lock import check_locks
from ..rules.profile import Profile
from ..rules.state import Stated, state_rules
from .contour_heat import contour_heat_kj


@dataclass(frozen=True, eq=False, slots=True)
class Asked:
    """What is asked of a plan: the facts of the nest, and what the profile's rules state of them."""

    facts: Facts
    stated: Stated


def facts_of(nest: Nest, profile: Profile) -> Facts:
    """All facts of the nest under the profile's thresholds.

    Raises
    ------
    InputError
        If a lock names what the nest does not have, or a contour cannot be cut as the profile asks.
    """
    check_locks(profile.locks, nest)
    candidates = build_candidates(nest, profile.lead_options(nest))
    return compute_facts(nest, profile.fact_options(nest), candidates, contour_heat_kj(nest, candidates, profile))


def ask(facts: Facts, profile: Profile, relax: bool = False, engine: Engine = "cp-sat") -> Asked:
    """What the rules state of the facts; `relax` lets the cheapest statements give way where they clash.

    Rule files of the plant's own are read by the engine minizinc only.

    Raises
    ------
    RulesConflict
        If hard orders contradict each other (and nothing that may give way helps).
    """
    if relax:
        from ..models.conflict import state_relaxed

        return Asked(facts, state_relaxed(facts, profile, reads_files=engine == "minizinc"))
    return Asked(facts, state_rules(facts, profile, reads_files=engine == "minizinc"))
