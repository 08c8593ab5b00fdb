"""What is asked of a plan: the facts of a nest, and what a profile's rules state of them."""

from __future__ import annotations

from dataclasses import dataclass

from ..encoder.candidates import build_candidates
from ..encoder.errors import MOST_DETAILS, InputError, RulesConflict
from ..encoder.facts import compute_facts
from ..encoder.facts.facts import Facts
from ..encoder.nest import Nest
from ..models.engines import Engine
from ..rules.lock import check_locks
from ..rules.profile import Profile
from ..rules.state import HOPELESS, Stated, hopeless_anyway, state_rules
from .contour_heat import contour_heat_kj


@dataclass(frozen=True, eq=False, slots=True)
class Asked:
    """What is asked of a plan: the facts of the nest, and what the profile's rules state of them."""

    facts: Facts
    stated: Stated


def facts_of(nest: Nest, profile: Profile) -> Facts:
    """All facts of the nest, as the profile has it cut, under the profile's thresholds.

    Raises
    ------
    InputError
        If a lock names what the nest does not have, or a contour cannot be cut as the profile asks.
    RulesConflict
        If contours cannot be cut and hard rules cannot hold in any order: the second is mostly the reason of the first.
    """
    nest = profile.as_cut(nest)
    check_locks(profile.locks, nest)
    try:
        candidates = build_candidates(nest, profile.lead_options(nest))
    except InputError as error:
        if alone := hopeless_anyway(compute_facts(nest, profile.fact_options(nest), ()), profile):
            besides = (f"besides, {error.message}, and --relax does not help there:", *error.details[:MOST_DETAILS])
            raise RulesConflict(HOPELESS, (*(about.sentence for about in alone), *besides)) from None
        raise
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
