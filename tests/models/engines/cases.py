"""Small random nests under random mixtures of rules, the same for the same seed."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kerfwise import InputError, Lock, Nest, Profile
from kerfwise.apps.authoring.trials.trial import random_nest
from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.facts.links import with_links
from kerfwise.encoder.nest import KINDS
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.physics.motion import Feeds
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.postproc.clock import contour_heat_kj
from kerfwise.rule_kit import Facts, LeadOptions, RuleSetting, circle, nest, part, rect
from kerfwise.rules.catalogue.cut_direction import CutDirectionOptions
from kerfwise.rules.catalogue.heat_lag import HeatLagOptions
from kerfwise.rules.catalogue.hold_small_parts import HoldSmallPartsOptions
from kerfwise.rules.catalogue.marks_first import MarksFirstOptions
from kerfwise.rules.catalogue.no_islands import NoIslandsOptions
from kerfwise.rules.catalogue.part_contiguous import PartContiguousOptions
from kerfwise.rules.catalogue.part_rigidity import PartRigidityOptions
from kerfwise.rules.catalogue.pierce import PierceOptions
from kerfwise.rules.catalogue.zone_order import ZoneOrderOptions
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.sections import Common, Cuts, Links
from kerfwise.rules.registry import RULES
from kerfwise.tests.drawn_options import with_drawn_options
from kerfwise.tests.metal.common_nests import block


@dataclass(frozen=True, eq=False)
class Case:
    """A nest under a profile, and what an engine is given of them."""

    facts: Facts
    profile: Profile
    options: SolveOptions


def case(seed: int, contours: int = 7) -> Case:
    """A nest of 5 contours to about `contours`, a profile with every rule hard, soft or off as the seed has it."""
    drawn, profile = _drawn(seed, contours)
    candidates = build_candidates(drawn, lead_options(profile, seed))
    facts = compute_facts(drawn, profile.fact_options(drawn), candidates)
    feeds = Feeds(profile.machine.cut_feed_mm_s, profile.machine.mark_feed_mm_s, profile.machine.travel_mm_s, 0.5, 0.2)
    return Case(facts, profile, SolveOptions(work=60, home_mm=profile.machine.home, feeds=feeds))


def drawn_case(seed: int, contours: int = 6) -> Case | None:
    """As `case`, with each option of each rule drawn from what it declares; None where no contour could be entered."""
    rng = np.random.default_rng([seed, 11])
    drawn = random_nest(rng, contours)
    first = with_drawn_options(random_profile(rng, drawn), rng)
    for profile in (first, without_tabs(first)):
        try:
            candidates = build_candidates(drawn, lead_options(profile, seed))
            break
        except InputError:
            continue
    else:
        return None
    heat_kj = contour_heat_kj(drawn, candidates, profile)
    facts = compute_facts(drawn, profile.fact_options(drawn), candidates, heat_kj)
    return Case(facts, profile, SolveOptions(work=60, home_mm=profile.machine.home, feeds=feeds_of(profile)))


def linked_case(seed: int, contours: int = 5) -> Case:
    """As `case`, with links wherever 2 s a pierce make them worth it; no rule counts seconds."""
    drawn = near_parts(np.random.default_rng([seed, 31]), contours)
    profile = load_profile()
    profile = replace(
        profile,
        rules=_rules_of_moves(np.random.default_rng([seed, 37]), profile),
        machine=replace(profile.machine, pierce_time_s=2.0),
        cuts=Cuts(links=Links(longest_mm=90.0)),
        leads=replace(profile.leads, entries=2),
    )
    candidates = build_candidates(drawn, lead_options(profile, seed))
    heat_kj = contour_heat_kj(drawn, candidates, profile)
    facts = compute_facts(drawn, profile.fact_options(drawn), candidates, heat_kj)
    facts = with_links(facts, profile.link_options())
    return Case(facts, profile, SolveOptions(work=60, home_mm=profile.machine.home, feeds=feeds_of(profile)))


def common_case(seed: int, parts: int = 4, one_way: bool = False) -> Case:
    """A block of parts a kerf apart, with common cuts, under rules that decide on orders and entries.

    With `one_way` all are cut clockwise, and entered at one place, so that all plans can be tried.
    """
    rng = np.random.default_rng([seed, 41])
    profile = load_profile("laser-st10kp-2mm")
    kerf_mm = float(rng.choice([0.2, 1.5]))
    drawn = block(rng, parts, kerf_mm)
    machine = replace(profile.machine, pierce_time_s=2.0, kerf_start=bool(rng.random() < 0.7))
    profile = replace(
        profile,
        rules=_rules_of_moves(np.random.default_rng([seed, 43]), profile),
        machine=machine,
        material=replace(profile.material, kerf_mm=kerf_mm),
        cuts=Cuts(common=Common(shortest_mm=20.0, good_side="any")),
        leads=replace(profile.leads, entries=1 if one_way else 2),
    )
    options = profile.lead_options(drawn)
    options = replace(options, directions=dict.fromkeys(KINDS, ("cw",))) if one_way else options
    candidates = build_candidates(drawn, options)
    heat_kj = contour_heat_kj(drawn, candidates, profile)
    facts = compute_facts(drawn, profile.fact_options(drawn), candidates, heat_kj)
    return Case(facts, profile, SolveOptions(work=60, home_mm=profile.machine.home, feeds=feeds_of(profile)))


MOVED_BY = ("cut-direction", "heat-lag", "hull-before", "level-ahead", "no-tip-travel", "part-rigidity", "pierce")
"""Rules that decide which contours are linked; their list is fixed, so that a new rule changes no seed."""


def _rules_of_moves(rng: np.random.Generator, profile: Profile) -> dict[str, RuleSetting]:
    """These rules hard, soft or off, part-contiguous and inner-before-outer hard, all others off."""
    rules = {name: RuleSetting("off", None, setting.options) for name, setting in profile.rules.items()}
    for name in ("inner-before-outer", "part-contiguous"):
        rules[name] = profile.rules[name]
    for name in MOVED_BY:
        strength = str(rng.choice(["hard", "soft", "off", "off"]))
        if strength in RULES[name].strengths:
            rules[name] = RuleSetting(strength, 40.0 if strength == "soft" else None, profile.rules[name].options)  # type: ignore[arg-type]
    return rules


def near_parts(rng: np.random.Generator, contours: int) -> Nest:
    """Rectangles and a disc in rows of three, few millimetres apart; the first has a hole now and then."""
    parts = []
    for k in range(contours - 1):
        x, y = 8 + 55 * (k % 3) + int(rng.integers(0, 4)), 8 + 55 * (k // 3)
        w, h = (int(side) for side in rng.integers(38, 49, 2))
        if k == 0:
            parts.append(part("P0", rect(x, y, w, h), [circle(x + 19, y + 19, 9)] if rng.random() < 0.5 else []))
        else:
            parts.append(part(f"P{k}", circle(x + 22, y + 22, 20) if rng.random() < 0.2 else rect(x, y, w, h)))
    return nest(190, 130, *parts)


def lead_options(profile: Profile, seed: int) -> LeadOptions:
    """How candidates are made; for every third seed whatever older kerfs they meet, so that many do."""
    options = profile.lead_options()
    return replace(options, splash_mm=None) if seed % 3 == 0 else options


def profile_of(seed: int, contours: int = 7) -> Profile:
    """The profile of a case alone."""
    return _drawn(seed, contours)[1]


def _drawn(seed: int, contours: int) -> tuple[Nest, Profile]:
    rng = np.random.default_rng(seed)
    drawn = random_nest(rng, contours)
    return drawn, random_profile(rng, drawn)


SIMULATED = "t-max"
"""The rule of which no engine knows more than what a simulation says afterwards: it is off."""
LAST_DRAWN = ("shared-metal", "hold-small-parts")
"""Rules whose strength is drawn after all else, so that seeds keep the nests and rules that they had before them."""


def random_profile(rng: np.random.Generator, drawn: Nest) -> Profile:
    """The default profile with other strengths, weights, options and locks."""
    base = load_profile()
    scope = str(rng.choice(["sheet", "part"]))
    together = scope == "part" and rng.random() < 0.5
    options = {
        "marks-first": MarksFirstOptions(scope),  # type: ignore[arg-type]
        "part-contiguous": PartContiguousOptions("together" if together else "apart"),
        "zone-order": ZoneOrderOptions(zone_contours=int(rng.integers(1, 5))),
        "cut-direction": CutDirectionOptions(*(str(way) for way in rng.choice(["free", "cw", "ccw"], 3))),  # type: ignore[arg-type]
        "heat-lag": HeatLagOptions(float(rng.choice([15, 40])), int(rng.integers(0, 3)), float(rng.choice([0, 0, 8]))),
        "pierce": PierceOptions(clearance_mm=1.5, splash_mm=float(rng.choice([0.5, 3, 6]))),
        "no-islands": NoIslandsOptions(frame_share=float(rng.choice([0.1, 0.5, 1.0]))),
        "part-rigidity": PartRigidityOptions(head_weight_mm=float(rng.choice([0, 25, 60]))),
    }
    rules = {SIMULATED: base.rules[SIMULATED]}
    for name, rule in RULES.items():
        if name in (SIMULATED, *LAST_DRAWN):
            continue
        strength = str(rng.choice(rule.strengths))
        weight = float(rng.choice([3.5, 40, 400])) if strength == "soft" else None
        rules[name] = RuleSetting(strength, weight, options.get(name, base.rules[name].options))  # type: ignore[arg-type]
    objective = replace(base.objective, time=float(rng.choice([0, 0, 100])))
    leads = replace(base.leads, entries=int(rng.integers(1, 3)))
    machine = replace(base.machine, home=(float(rng.choice([0, 200])), 0.0))
    locks = _locks(rng, drawn)
    metal, tabs = LAST_DRAWN
    rules[metal] = replace(base.rules[metal], strength=str(rng.choice(["hard", "off"])))  # type: ignore[arg-type]
    rules[tabs] = base.rules[tabs]
    made = replace(base, rules=rules, objective=objective, leads=leads, machine=machine, locks=locks)
    return _with_tabs(rng, made, drawn)


def without_tabs(profile: Profile) -> Profile:
    """The same without tabs, for which a nest may have no room."""
    tabs = profile.rules[LAST_DRAWN[1]]
    return replace(profile, rules=dict(profile.rules) | {LAST_DRAWN[1]: replace(tabs, strength="off")})


def _with_tabs(rng: np.random.Generator, profile: Profile, drawn: Nest) -> Profile:
    """Every third profile with tabs, of a laser or a torch, where all parts have room for them."""
    if rng.random() < 2 / 3:
        return profile
    tabs = str(rng.choice(["tipping", "all"]))
    options = HoldSmallPartsOptions(tabs, width_mm=0.5, count=int(rng.integers(1, 3)), corner_mm=0.5)  # type: ignore[arg-type]
    rules = dict(profile.rules) | {LAST_DRAWN[1]: RuleSetting("hard", None, options)}
    machine = replace(profile.machine, dialect="linuxcnc", process=str(rng.choice(["laser", "plasma"])))  # type: ignore[arg-type]
    made = replace(profile, rules=rules, machine=machine)
    try:
        for seed in (0, 1):
            build_candidates(drawn, lead_options(made, seed))
    except InputError:
        return profile
    return made


def _locks(rng: np.random.Generator, drawn: Nest) -> tuple[Lock, ...]:
    """Mostly none; else an order, a position or a direction of single contours."""
    names = [c.id for c in drawn.contours]
    one, other = (str(name) for name in rng.choice(names, 2, replace=False))
    locks = [
        Lock(contour=one, before=other),
        Lock(contour=one, position=int(rng.integers(1, len(names) + 1))),
        Lock(contour=one, position="last"),
        Lock(contour=one, direction="cw"),
    ]
    return (locks[int(rng.integers(len(locks)))],) if rng.random() < 0.3 else ()
