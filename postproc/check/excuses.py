"""Order rules that contradict each other: which broken orders a plan could not have kept.

Level-ahead and hull-before can ask for cycles (two hooks that interlock), so that some of their orders must be broken.
An order "a before b" is excused only if the orders that the plan does keep, of rules that give way no sooner, lead from
b to a: then keeping it as well would have broken another of them. Which of several orders equally firm is given up is
not judged, nor which rule gives way in a tangle of more orders than the planner resolves exactly.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

from ...encoder.cut import CutSequence
from ...encoder.nest import Nest
from ...rules.cycles import components, contracted, path
from ...rules.feedback import EXACT_LINKS
from ...rules.profile import Profile
from ...rules.registry import RULES
from ...rules.rule import Ids, OrderRule
from .result import Excused, Judgement


def excuse(nest: Nest, cuts: CutSequence, profile: Profile, judged: Sequence[Judgement]) -> list[Judgement]:
    """The judgements, with violations of rules that give way moved to the excused where the rules leave no choice."""
    if not any(_yields(judgement) for judgement in judged):
        return list(judged)
    why = _contradictions(nest, cuts, profile, {j.id for j in judged if j.strength == "hard" and j.holds})
    return [_excused(judgement, why) if _yields(judgement) else judgement for judgement in judged]


def _yields(judgement: Judgement) -> bool:
    return judgement.strength == "hard" and bool(judgement.violations) and RULES[judgement.id].gives_way > 0


def _excused(judgement: Judgement, why: dict[Ids, str]) -> Judgement:
    violations, excused = [], []
    for violation in judgement.violations:
        first, then = violation.contours
        if (first, then) in why:
            excused.append(Excused(violation, why[first, then]))
        else:
            violations.append(violation)
    return Judgement(judgement.id, judgement.strength, judgement.sentence, tuple(violations), tuple(excused))


def _contradictions(nest: Nest, cuts: CutSequence, profile: Profile, holding: set[str]) -> dict[Ids, str]:
    """Every broken order that the kept ones contradict, with the kept orders that do so."""
    at = cuts.positions()
    asked = _asked(nest, cuts, profile, holding)
    pairs = list(asked)
    number = {name: k for k, name in enumerate(dict.fromkeys(name for pair in pairs for name in pair))}
    runs = _runs(nest) if "part-contiguous" in holding else []
    together = [[number[name] for name in run if name in number] for run in runs]
    links = contracted(len(number), [(number[a], number[b]) for a, b in pairs], together)
    found: dict[Ids, str] = {}
    for component in components(links):
        kept = [k for k in component if asked[pairs[k]] == "zone-order" or at[pairs[k][0]] < at[pairs[k][1]]]
        for k in sorted(set(component) - set(kept)):
            softest = RULES[asked[pairs[k]]].gives_way if len(component) <= EXACT_LINKS else math.inf
            firm = [m for m in kept if RULES[asked[pairs[m]]].gives_way <= softest]
            before, after = links[k]
            against = path(links, firm, after, before)
            if against:
                orders = ", ".join(f"{' before '.join(pairs[m])} ({asked[pairs[m]]})" for m in against)
                found[pairs[k]] = f"the order rules contradict each other here: {orders}"
    return found


def _asked(nest: Nest, cuts: CutSequence, profile: Profile, holding: set[str]) -> dict[Ids, str]:
    """Every order that a hard rule asks of contours that are cut, with the firmest rule that asks for it."""
    asked: dict[Ids, str] = {}
    settings = profile.settings()
    if "zone-order" in holding:
        asked = dict.fromkeys(_zone_chain(cuts), "zone-order")
    asked |= {(lock.contour, lock.before): "locks" for lock in profile.locks if lock.contour and lock.before}
    for name in sorted(settings, key=lambda name: RULES[name].gives_way):
        rule = RULES[name]
        if settings[name].strength == "hard" and isinstance(rule, OrderRule):
            for pair in rule.pairs(nest, cuts, settings[name].options):
                asked.setdefault(pair, name)
    known = cuts.positions().keys() | {pair[1] for pair in _zone_chain(cuts)}
    return {pair: name for pair, name in asked.items() if known.issuperset(pair)}


def _zone_chain(cuts: CutSequence) -> Iterator[Ids]:
    """The order of zones in few pairs: each contour before the end of its zone, which is before all of the next."""
    zones = sorted({cut.zone for cut in cuts})
    for zone, following in pairwise(zones):
        end = f"the end of zone {zone}"
        for cut in cuts:
            if cut.zone == zone:
                yield cut.contour, end
            elif cut.zone == following:
                yield end, cut.contour


def _runs(nest: Nest) -> list[list[str]]:
    """Contours that are cut without a break, by rule part-contiguous."""
    return [[contour.id for contour in (*part.holes, part.outer)] for part in nest.parts if part.holes]
