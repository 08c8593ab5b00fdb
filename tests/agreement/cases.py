"""Random nests of 5 to 9 contours, under rules whose every price the check can see, small enough to try every plan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import prod
from typing import Literal

import numpy as np

from kerfwise import InputError, Nest, Profile
from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.facts.links import with_links
from kerfwise.encoder.nest import KINDS
from kerfwise.encoder.slits import with_slits
from kerfwise.jobs.request import options_for
from kerfwise.postproc.clock import contour_heat_kj
from kerfwise.rule_kit import Candidate, Contour, Curve, RuleSetting
from kerfwise.rules.catalogue.heat_lag import HeatLagOptions
from kerfwise.rules.catalogue.no_narrow_strips import NoNarrowStripsOptions
from kerfwise.rules.catalogue.part_rigidity import PartRigidityOptions
from kerfwise.rules.own import OwnRule
from kerfwise.rules.own.criteria import Pattern
from kerfwise.rules.own.demands import NextCut
from kerfwise.rules.own.selector import Selector
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.sections import Common, Cuts, Links
from kerfwise.tests.agreement.scrap_lines import with_lines
from kerfwise.tests.drawn_options import with_drawn_options
from kerfwise.tests.metal.common_nests import block
from kerfwise.tests.models.engines.cases import Case, lead_options, near_parts, random_nest, random_profile

ROUTES = {5: 256, 6: 128, 7: 64, 8: 16, 9: 4}
"""Contours → the most ways to pick entries and directions that are tried along each order."""
WORK = 8
"""The limit of each engine: enough for a proof, with a search before it that finds nothing more."""
FIRM = ("inner-before-outer", "level-ahead", "zone-order")
"""Rules that are always hard on the larger nests, so that few enough orders are left to judge one by one."""
PROMISED = "inner-before-outer"
"""What no profile turns off, whatever its rules say: nothing is cut in metal that has come loose. Every plan that is
tried one by one is judged by rules alone, so that this rule stands for the promise."""
SCRAP_LAST = "scrap-last"
"""The rule that is always hard where there are scrap lines: without it the check fails for loose metal."""
Kind = Literal["plain", "slits", "options", "links", "scrap", "common"]
"""What the nests of a run have besides tabs, and what is drawn for them."""
Mixed = Kind | Literal["stretches"]
"""The same, or ways along stretches, and bevels: see `stretch_nests`."""


NEXT = {
    "part by part": NextCut("next", (("same", "part"),)),
    "kinds alternate": NextCut("next", (("differs", "kind"),)),
    "along rows": NextCut("next", (("same", "y_mm"), ("within", 60.0))),
    "no outline after another": NextCut("next", (("never", Selector((("kind", Pattern("outer")),))),)),
    "one way round": NextCut("next", (("same", "direction"),)),
}
"""Prices of moves and bans on them, by the names of the own rules that ask them."""
TURNS = "own:one way round"
"""The one of them that hangs on how contours are cut."""


def with_moves(profile: Profile, seed: int) -> Profile:
    """The profile with own rules about what directly follows what, in two of three nests."""
    rng = np.random.default_rng([seed, 9])
    if seed % 3 == 0:
        return profile
    chosen = rng.choice(sorted(NEXT), 1 + seed % 2, replace=False).tolist()
    asked = []
    for name in chosen:
        hard = bool(rng.random() < 0.25)
        price = None if hard else float(rng.choice([15.0, 60.0, 250.0]))
        outer = Selector((("kind", Pattern("outer")),))
        asked.append(
            OwnRule(
                name,
                NEXT[name],
                outer if "never" in dict(NEXT[name].value) else Selector(),
                strength="hard" if hard else "soft",
                weight=price,
            )
        )
    return replace(profile, own_rules=tuple(asked))


def judged_case(seed: int, kind: Kind = "plain") -> Case:
    """A nest of 5 to 9 contours under a random mixture of rules, tabs among them; the same for the same seed.

    With slits one or two of 5 to 8 contours are slits. With options each option of each rule is drawn from what it
    declares, for 5 or 6 contours. With links 5 or 6 contours stand near each other, and 2 s a pierce make links worth
    it. With scrap lines there are one to three, and 4 or 5 other contours. With common edges 3 to 6 contours stand a
    kerf apart, and are cut one way round.
    """
    match kind:
        case "options":
            return _with_options(seed)
        case "links":
            return _with_links(seed)
        case "scrap":
            return _with_scrap(seed)
        case "common":
            return _with_common(seed)
        case "plain" | "slits":
            return _with_slits_or_none(seed, kind == "slits")


def kind_of(seed: int) -> Mixed:
    """What is tried with a seed where everything is to be in the mixture: of eight nests two each with links and scrap.

    One has common edges, one stretches or bevels. Eight has no divisor in common with 3 and 5, by which seeds decide
    other things.
    """
    kinds: Sequence[Mixed] = ("plain", "links", "plain", "scrap", "common", "links", "stretches", "scrap")
    return kinds[seed % 8]


def _with_links(seed: int) -> Case:
    rng = np.random.default_rng([seed, 6])
    drawn = near_parts(rng, 6)
    profile = _visible(rng, random_profile(rng, drawn))
    rules = dict(profile.rules)
    heat = rules["heat-lag"]
    rules["heat-lag"] = replace(heat, options=replace(heat.options, lag_s=0.0))  # type: ignore[type-var]
    machine = replace(profile.machine, pierce_time_s=2.0)
    profile = replace(with_moves(profile, seed), rules=rules, machine=machine, cuts=Cuts(links=Links(longest_mm=90.0)))
    made = _as_case(rng, drawn, profile, seed)
    return replace(made, facts=with_links(made.facts, profile.link_options()))


def _with_common(seed: int) -> Case:
    rng = np.random.default_rng([seed, 8])
    kerf_mm = load_profile().material.kerf_mm
    drawn = block(rng, 3, kerf_mm, holes=True) if seed % 5 == 0 else block(rng, 4, kerf_mm)
    profile = _visible(rng, random_profile(rng, drawn))
    rules, machine = dict(profile.rules), profile.machine
    heat, held = rules["heat-lag"], rules["hold-small-parts"]
    rules["heat-lag"] = replace(heat, options=replace(heat.options, lag_s=0.0))  # type: ignore[type-var]
    rules["hold-small-parts"] = replace(held, strength="off", weight=None)
    # The check lets parts hold together that face each other by corners alone, as in grids; the planner is stricter.
    rules["no-islands"] = replace(rules["no-islands"], strength="off", weight=None)
    machine = replace(machine, pierce_time_s=2.0, pierce_dwell="program", kerf_start=bool(rng.random() < 0.7))
    cuts = Cuts(common=Common(shortest_mm=20.0, good_side="any"))
    profile = replace(with_moves(profile, seed), rules=rules, machine=machine, cuts=cuts)
    profile = replace(profile, leads=replace(profile.leads, entries=2))
    options = replace(profile.lead_options(drawn), directions=dict.fromkeys(KINDS, ("cw",)))
    candidates = build_candidates(drawn, options)
    facts = compute_facts(drawn, profile.fact_options(drawn), candidates, contour_heat_kj(drawn, candidates, profile))
    return Case(facts, profile, options_for(drawn, profile, work=WORK))


def _with_scrap(seed: int) -> Case:
    rng = np.random.default_rng([seed, 7])
    while True:
        drawn = random_nest(rng, 4 + seed % 2, 4)
        profile = _visible(rng, random_profile(rng, drawn))
        lined = with_lines(rng, drawn, 1 + seed % 3, profile.material.kerf_mm)
        if lined is not None:
            rules = dict(profile.rules) | {rule: _hard(profile, rule) for rule in (SCRAP_LAST, PROMISED)}
            return _as_case(rng, lined, replace(with_moves(profile, seed), rules=rules), seed)


def _as_case(rng: np.random.Generator, drawn: Nest, profile: Profile, seed: int) -> Case:
    if len(drawn.contours) > 7:
        profile = replace(profile, rules=dict(profile.rules) | {rule: _hard(profile, rule) for rule in FIRM})
    most = ROUTES[len(drawn.contours)]
    candidates = thinned(rng, drawn, build_candidates(drawn, lead_options(profile, seed)), most)
    facts = compute_facts(drawn, profile.fact_options(drawn), candidates)
    return Case(facts, profile, options_for(drawn, profile, work=WORK))


def _with_slits_or_none(seed: int, slits: bool) -> Case:
    rng = np.random.default_rng([seed, 4 if slits else 3])
    contours = 4 + seed % 3 if slits else 5 + seed % 5
    drawn = random_nest(rng, contours, contours)
    if slits:
        kerf_mm = load_profile().material.kerf_mm
        while (made := with_slits(slotted(rng, drawn, 1 + seed % 2), kerf_mm)) is drawn or made.drawn is None:
            drawn = random_nest(rng, contours, contours)  # without a rectangle that could have a slot
        drawn = made
    profile = _visible(rng, random_profile(rng, drawn))
    profile = replace(with_moves(profile, seed), cuts=Cuts("slit" if slits else "refuse"))
    return _as_case(rng, drawn, profile, seed)


def _with_options(seed: int) -> Case:
    rng = np.random.default_rng([seed, 5])
    while True:
        drawn = random_nest(rng, 5 + seed % 2, 5)
        profile = _visible_as_drawn(with_drawn_options(random_profile(rng, drawn), rng))
        try:
            candidates = build_candidates(drawn, lead_options(profile, seed))
        except InputError:  # a contour has no room for the leads that were drawn
            continue
        candidates = thinned(rng, drawn, candidates, ROUTES[len(drawn.contours)])
        heat_kj = contour_heat_kj(drawn, candidates, profile)
        facts = compute_facts(drawn, profile.fact_options(drawn), candidates, heat_kj)
        return Case(facts, profile, options_for(drawn, profile, work=WORK))


def slotted(rng: np.random.Generator, drawn: Nest, most: int) -> Nest:
    """The nest with slots narrower than the kerf in some of its rectangles, which stand on corners 0 to 3."""
    rings = [
        c for c in drawn.contours if c.encloses and len(c.curve.vertices) == 4 and not c.curve.vertices[:, 2].any()
    ]
    chosen = {rings[k].id: _with_slot(rng, rings[k]) for k in rng.permutation(len(rings))[:most].tolist()}
    parts = [
        replace(
            part,
            outer=chosen.get(part.outer.id, part.outer),
            holes=tuple(chosen.get(hole.id, hole) for hole in part.holes),
        )
        for part in drawn.parts
    ]
    return replace(drawn, parts=tuple(parts))


def _with_slot(rng: np.random.Generator, ring: Contour) -> Contour:
    """A rectangle with a slot from the middle of one of its sides into the part."""
    corners = ring.curve.towards("ccw").vertices[:, :2]
    k, wide, deep = int(rng.integers(4)), float(rng.choice([0.5, 1.0, 1.3])), float(rng.choice([2, 4]))
    a, b = corners[k], corners[(k + 1) % 4]
    along = (b - a) / np.hypot(*(b - a))
    into = np.array([-along[1], along[0]]) * (1 if ring.kind == "outer" else -1)
    mouth = [(a + b) / 2 - along * wide / 2, (a + b) / 2 + along * wide / 2]
    rows = [*corners[: k + 1], mouth[0], mouth[0] + into * deep, mouth[1] + into * deep, mouth[1], *corners[k + 1 :]]
    return replace(ring, curve=Curve.of([(float(x), float(y)) for x, y in rows]))


def _visible(rng: np.random.Generator, profile: Profile) -> Profile:
    """The profile without prices that no violation shows.

    The wish where a cut begins is never judged; what soft strips cost hangs on which of them geometry was shown; and
    seconds that are missing of a soft lag are not counted by violations. All three are compared by statements alone, in
    `tests/models/engines/test_equivalence.py`.
    """
    rules = dict(profile.rules)
    strips, heat, rigidity = rules["no-narrow-strips"], rules["heat-lag"], rules["part-rigidity"]
    narrow = NoNarrowStripsOptions(strip_mm=float(rng.choice([60, 100, 140])))
    rules["no-narrow-strips"] = RuleSetting("off" if strips.strength == "off" else "hard", None, narrow)
    assert isinstance(heat.options, HeatLagOptions)
    if heat.strength == "soft":
        rules["heat-lag"] = replace(heat, options=replace(heat.options, lag_s=0.0))
    assert isinstance(rigidity.options, PartRigidityOptions)
    rigid_min = float(rng.choice([0.35, 0.6, 0.8]))
    rules["part-rigidity"] = replace(
        rigidity, options=replace(rigidity.options, rigid_min=rigid_min, head_weight_mm=0.0)
    )
    return replace(profile, rules=rules)


def _visible_as_drawn(profile: Profile) -> Profile:
    """The same for a profile whose options are drawn: they stay as they are wherever the check sees what they cost."""
    rules = dict(profile.rules)
    strips, heat, rigidity = rules["no-narrow-strips"], rules["heat-lag"], rules["part-rigidity"]
    rules["no-narrow-strips"] = replace(strips, strength="off" if strips.strength == "off" else "hard", weight=None)
    if heat.strength == "soft":
        rules["heat-lag"] = replace(heat, options=replace(heat.options, lag_s=0.0))  # type: ignore[type-var]
    rules["part-rigidity"] = replace(rigidity, options=replace(rigidity.options, head_weight_mm=0.0))  # type: ignore[type-var]
    return replace(profile, rules=rules)


def _hard(profile: Profile, rule: str) -> RuleSetting:
    return RuleSetting("hard", None, profile.rules[rule].options)


def thinned(rng: np.random.Generator, drawn: Nest, candidates: Sequence[Candidate], most: int) -> tuple[Candidate, ...]:
    """Some of the candidates of every contour, so that no more than `most` ways are left to pick one of each."""
    kept = [[c for c in candidates if c.contour == i] for i in range(len(drawn.contours))]
    while prod(max(len(own), 1) for own in kept) > most:
        widest = max(range(len(kept)), key=lambda i: (len(kept[i]), rng.random()))
        kept[widest].pop(int(rng.integers(len(kept[widest]))))
    return tuple(c for own in kept for c in own)
