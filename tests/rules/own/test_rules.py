"""Own rules among all others: settings, conflicts, what is judged and what cannot be, the words of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.facts import compute_facts
from kerfwise.rules.case import cut, in_order, nest, part, rect
from kerfwise.rules.judging.violation import Violation
from kerfwise.rules.own import OwnFile, Thresholds, as_rule
from kerfwise.rules.own.demands import MOST
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.profile_yaml import profile_yaml
from kerfwise.rules.rule import Plate
from kerfwise.rules.statements import Precede
from kerfwise.rules.stating.state_rules import Stated, state_rules
from kerfwise.tests.rules.own.made import rules_of

ROW = nest(400, 100, *(part(f"P{k}", rect(100 * k + 10, 10, 80, 80)) for k in range(4)))


def plant(text: str) -> Profile:
    return replace(Profile("plant"), own_rules=rules_of(text))


def stated(profile: Profile) -> Stated:
    return state_rules(compute_facts(ROW, profile.fact_options(ROW), ()), profile)


def test_statement_says_whence_it_comes() -> None:
    profile = plant("- {name: swap, why: it is asked for, select: {part: P2}, before: {part: P0}}")
    (own,) = (s for s in stated(profile).statements if s.about.rule == "own:swap")
    assert own.about.sentence == "P2.outer is cut before P0.outer: it is asked for"
    assert own.weight is None


def test_soft_rule_has_its_weight() -> None:
    profile = plant("- {name: swap, strength: soft, weight: 5 cm, select: {part: P2}, before: {part: P0}}")
    (own,) = (s for s in stated(profile).statements if s.about.rule == "own:swap")
    assert own.weight == 50.0


def test_rule_that_is_off_states_nothing() -> None:
    profile = plant("- {name: swap, strength: off, select: {part: P2}, before: {part: P0}}")
    assert "own:swap" not in profile.settings()
    assert not any(s.about.rule == "own:swap" for s in stated(profile).statements)


def test_orders_of_geometry_give_way_to_own_rules() -> None:
    found = stated(plant("- {name: swap, select: {part: P1}, before: {part: P0}}"))
    assert [(d.rule, d.contours) for d in found.dropped] == [("level-ahead", ("P0.outer", "P1.outer"))]


def test_own_rules_do_not_give_way() -> None:
    with pytest.raises(RulesConflict) as caught:
        stated(
            plant(
                "- {name: there, why: A, select: {part: P1}, before: {part: P0}}\n"
                "- {name: back, why: B, select: {part: P1}, after: {part: P0}}"
            )
        )
    assert set(caught.value.reasons) == {"P1.outer is cut before P0.outer: A", "P0.outer is cut before P1.outer: B"}


def test_zones_follow_own_orders() -> None:
    profile = plant("- {name: far first, select: {part: P3}, before: {part: P0}}")
    small = replace(profile.fact_options(ROW), zone_contours=1, zone_respects=frozenset())
    zone = dict(zip([c.id for c in ROW.contours], compute_facts(ROW, small, ()).zone.tolist(), strict=True))
    assert zone["P3.outer"] <= zone["P0.outer"]
    assert profile.fact_options(ROW).zone_pairs == (("P3.outer", "P0.outer"),)


def test_rules_about_zones_do_not_make_zones() -> None:
    assert plant("- {name: z, select: {part: P3}, first: true, scope: zone}").fact_options(ROW).zone_pairs == ()


def test_violation_to_the_letter() -> None:
    (own,) = rules_of("- {name: swap, why: it is asked for, select: {part: P2}, before: {part: P0}}")
    found = as_rule(own).violations(ROW, in_order(ROW, "P0.outer P1.outer P2.outer P3.outer"), Thresholds())
    text = "P2.outer (cut 3) must be cut before P0.outer (cut 1): it is asked for"
    assert found == [Violation("own:swap", ("P2.outer", "P0.outer"), text, (1, 3))]


VIOLATIONS = {
    "last: true, select: {part: P0}": "P1.outer (cut 2) must be cut before P0.outer (cut 1)",
    "not_first: true, select: {part: P0}": "P0.outer (cut 1) must not be the first",
    "not_last: true, select: {part: P3}": "P3.outer (cut 4) must not be the last",
    "together: true, select: {part: [P0, P2]}": "P1.outer (cut 2) comes between P0.outer (cut 1) and P2.outer (cut 3)",
    "apart: {cuts: 2}, select: {part: [P0, P2]}": (
        "between P0.outer (cut 1) and P2.outer (cut 3) lie 1 cuts, not at least 2 cuts"
    ),
    "next: {never: {part: P1}}, select: {part: P0}": "P1.outer (cut 2) must not directly follow P0.outer (cut 1)",
    "next: {differs: direction}, select: {part: [P1, P2]}": (
        "P2.outer (cut 3) must not directly follow P1.outer (cut 2), cw and then cw"
    ),
    "one_stays_while: {part: P3}, select: {part: [P0, P1]}": (
        "P0.outer, P1.outer are all cut (cut 2) while P3.outer are still in"
    ),
    "direction: ccw, select: {part: P1}": "P1.outer (cut 2) is cut cw, not ccw",
    "no_pierce: {left_gap_mm: '< 100'}": (
        "P0.outer (cut 1) is pierced at (10.00, 10.00); it must be not pierced where left_gap_mm < 100"
    ),
    "entry: {x_mm: '> 100'}": "P0.outer (cut 1) is entered at (10.00, 10.00); it must be entered only where x_mm > 100",
}


@pytest.mark.parametrize("text", VIOLATIONS)
def test_words_of_every_demand(text: str) -> None:
    (own,) = rules_of(f"- {{name: r, why: W, {text}}}")
    found = as_rule(own).violations(ROW, in_order(ROW, "P0.outer P1.outer P2.outer P3.outer"), Thresholds())
    assert found[0].text == f"{VIOLATIONS[text]}: W"


def test_seconds_are_judged_by_the_clock() -> None:
    (own,) = rules_of("- {name: r, why: W, select: {part: [P0, P1]}, apart: {time: 5 s}}")
    rule = as_rule(own)
    timed = [cut(ROW, "P0.outer", start_s=0.0, end_s=8.0), cut(ROW, "P1.outer", start_s=12.0, end_s=20.0)]
    text = "between P0.outer (cut 1) and P1.outer (cut 2) lie 0 cuts and 4.0 s, not at least 5 s: W"
    assert [v.text for v in rule.violations(ROW, CutSequence(tuple(timed)), Thresholds())] == [text]
    later = (timed[0], replace(timed[1], start_s=13.0, end_s=21.0))
    assert rule.violations(ROW, CutSequence(later), Thresholds()) == []
    blind = in_order(ROW, "P0.outer P1.outer")
    assert rule.unjudged(ROW, blind, Thresholds()) == "the times of the cuts are not stated"


def test_zones_that_are_not_stated_cannot_be_judged() -> None:
    (own,) = rules_of("- {name: r, select: {zone: 1}, last: true}")
    rule, order = as_rule(own), "P0.outer P1.outer"
    assert rule.unjudged(ROW, in_order(ROW, order), Thresholds()) == "the zones of the cuts are not stated"
    zoned = in_order(ROW, order, zones={"P0": 1, "P1": 2})
    assert rule.unjudged(ROW, zoned, Thresholds()) is None
    assert len(rule.violations(ROW, zoned, Thresholds())) == 1


def test_a_rule_that_speaks_of_no_contour_is_said_to() -> None:
    """A selector with a typo would otherwise hold in silence."""
    (own,) = rules_of("- {name: r, select: {part: Q0}, first: true}")
    rule, order = as_rule(own), in_order(ROW, "P0.outer P1.outer")
    assert rule.unjudged(ROW, order, Thresholds()) == (
        "it selects no contour of this nest: none has the part 'Q0'; there is 'P0', 'P1', 'P2', 'P3'"
    )
    assert rule.violations(ROW, order, Thresholds()) == []


def test_points_are_judged_to_what_programs_round_to() -> None:
    (never,) = rules_of("- {name: r, no_pierce: {x_mm: '< 10'}}")
    (only,) = rules_of("- {name: r, pierce: {x_mm: '< 10'}}")
    for x, breaches in {9.9: (1, 0), 9.99: (0, 0), 10.01: (0, 0), 10.1: (0, 1)}.items():
        cuts = CutSequence((cut(ROW, "P0.outer", pierce=(x, 5.0)),))
        found = tuple(len(as_rule(rule).violations(ROW, cuts, Thresholds())) for rule in (never, only))
        assert found == breaches, x


@pytest.mark.minizinc
def test_a_file_states_what_it_says(tmp_path: Path) -> None:
    rule = 'constraint forall(i, j in CONTOUR where contour_id[i] = "P1.outer" /\\ i != j)(before(i, j));\n'
    (tmp_path / "plant_rule.mzn").write_text(rule, encoding="utf-8")
    path = tmp_path / "plant.yaml"
    path.write_text("own_rules:\n  - {file: plant_rule.mzn, why: P1 is hot}\n", encoding="utf-8")
    profile = load_profile(path)
    (own,) = profile.own_rules
    assert isinstance(own, OwnFile)
    assert (own.id, own.path) == ("own:plant_rule", tmp_path / "plant_rule.mzn")
    facts = compute_facts(ROW, profile.fact_options(ROW), ())
    stated = [s for s in state_rules(facts, profile).statements if s.about.rule == own.id]
    assert [ROW.contours[s.before].id for s in stated if isinstance(s, Precede)] == ["P1.outer"] * (facts.n - 1)
    assert stated[0].about.sentence.endswith(": P1 is hot (plant_rule.mzn:1)")
    assert profile_yaml(load_profile(path)) == profile_yaml(profile)


def test_rule_of_too_many_statements_is_refused() -> None:
    side = int(MOST**0.5) + 10
    many = nest(10 * side, 100, *(part(f"Q{k}", rect(10 * k, 10, 5, 5)) for k in range(2 * side)))
    (own,) = rules_of(f"- {{name: r, select: {{left_gap_mm: '< {10 * side}'}}, first: true}}")
    with pytest.raises(InputError, match=r"own:r comes to 260,100 statements on this nest, at most 250,000 are taken"):
        as_rule(own).violations(many, CutSequence(()), Thresholds())


def test_a_rule_for_one_thickness_is_judged_on_that_sheet() -> None:
    """What selects by the sheet is not measured on the usual one."""
    (own,) = rules_of("- {name: r, select: {part: P2, thickness_mm: '> 10'}, before: {part: P0, process: laser}}")
    rule, order = as_rule(own), in_order(ROW, "P0.outer P1.outer P2.outer P3.outer")
    thick = Thresholds(plate=Plate(thickness_mm=12.0, process="laser"))
    assert rule.unjudged(ROW, order, thick) is None
    assert [violation.contours for violation in rule.violations(ROW, order, thick)] == [("P2.outer", "P0.outer")]
    assert "none has the thickness_mm '> 10'; there is '6.0'" in str(rule.unjudged(ROW, order, Thresholds()))


def test_what_two_torches_cut_at_one_time_comes_between_nothing() -> None:
    together, apart = rules_of(
        "- {name: t, select: {part: [P0, P1]}, together: true}\n- {name: a, select: {part: [P0, P1]}, apart: {cuts: 1}}"
    )
    pairs = (("P0", "P2"), ("P1", "P3"))
    cuts = CutSequence(
        tuple(
            cut(ROW, f"{part}.outer", torch=torch, together="" if torch == 1 else f"{first}.outer")
            for first, second in pairs
            for torch, part in ((1, first), (2, second))
        )
    )
    assert as_rule(together).violations(ROW, cuts, Thresholds()) == []
    assert [v.text for v in as_rule(apart).violations(ROW, cuts, Thresholds())] == [
        "between P0.outer (cut 1) and P1.outer (cut 3) lie 0 cuts, not at least 1 cuts: a rule of the plant's own"
    ]
