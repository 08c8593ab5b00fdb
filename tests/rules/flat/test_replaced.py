"""Shipped rule files reversed, weakened and strengthened in a plant's folder: plans follow, and the check judges so.

Two judges look at each pair of plans: the shipped rule's own `violations()`, which knows nothing of the plant's file,
and the check by that file.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.request import facts_of, make_request
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.pipeline import VerifiedPlan, solve_and_verify
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.minizinc.twin import rule_file
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.registry import RULES
from kerfwise.tests.tools.amount import few

pytestmark = [pytest.mark.minizinc, pytest.mark.slow]

HOLED = part("A", rect(20, 20, 100, 100), [rect(40, 40, 20, 20), rect(80, 80, 20, 20)])
ROW = nest(460, 140, HOLED, part("B", rect(180, 20, 100, 100)), part("C", rect(340, 20, 100, 100)))
HOOK = [(20, 20), (220, 20), (220, 60), (60, 60), (60, 140), (220, 140), (220, 180), (20, 180), (20, 20)]
MOUTH = nest(420, 200, part("U", HOOK), part("V", rect(120, 85, 60, 30)), part("W", rect(300, 40, 100, 100)))
MARKED_ONE = part("A", rect(20, 20, 100, 100), [rect(40, 40, 20, 20)], [[(90, 80), (110, 80)]])
MARKED = nest(300, 140, MARKED_ONE, part("B", rect(160, 20, 100, 100)))
HOST = nest(200, 200, part("H", rect(20, 20, 150, 150), [rect(40, 40, 100, 100)]), part("G", rect(70, 70, 40, 40)))
CUT_UP = nest(460, 140, part("A", rect(200, 20, 100, 100)), scrap=[[(100, 0), (100, 140)], [(180, 0), (180, 140)]])
OFF = (
    "heat-lag, no-islands, no-narrow-strips, no-tip-travel, part-rigidity, zone-order, level-ahead, hull-before, "
    "part-contiguous"
)


@dataclass(frozen=True)
class Change:
    """A shipped rule's file with `old` written otherwise; which of the two rules is kept by both plans, if any."""

    rule: str
    old: str
    new: str
    how: str
    nest: Nest = ROW
    setting: str = "hard"


CHANGES = [
    Change("level-ahead", "before(j, i)", "before(i, j)", "reversed"),
    Change("level-ahead", "level_ahead[j, i]]", "level_ahead[j, i] /\\ part[j] = 2]", "weakened"),
    Change(
        "level-ahead",
        "level_ahead[j, i]]",
        "level_ahead[j, i] \\/ (kind[j] = HOLE /\\ kind[i] = OUTER)]",
        "strengthened",
    ),
    Change("hull-before", "before(j, i)", "before(i, j)", "reversed", MOUTH),
    Change("hull-before", "in_hull[j, i]]", "in_hull[j, i] /\\ false]", "weakened", MOUTH),
    Change("zone-order", "before(i, j)", "before(j, i)", "reversed", ROW, "{zone_contours: 1}"),
    Change("zone-order", "[before(i, j)", "[picked(1) \\/ before(i, j)", "weakened", ROW, "{zone_contours: 1}"),
    Change("part-contiguous", "before(i, outer) |", "true |", "weakened"),
    Change("part-contiguous", "[before(i, outer) |", "[before(i, outer) /\\ position[outer] >= 5 |", "strengthened"),
    Change(
        "marks-first",
        "[before(m, i) | m, i in CONTOUR where",
        "[before(i, m) | m, i in CONTOUR where part[m] != part[i] /\\",
        "reversed",
        MARKED,
    ),
    Change("marks-first", "kind[i] != MARK /\\", "kind[i] = HOLE /\\", "weakened", MARKED),
    Change(
        "cut-direction",
        "where not if",
        "where k = OUTER /\\ not if",
        "weakened",
        ROW,
        "{strength: hard, outer: cw, hole: ccw}",
    ),
    Change("heat-lag", ">= k |", ">= k - 1 |", "weakened", ROW, "{strength: hard, heat_radius: 80 mm}"),
    Change("heat-lag", ">= k |", ">= k + 1 |", "strengthened", ROW, "{strength: hard, heat_radius: 80 mm}"),
    Change("no-islands", "> 1];", "> 99];", "weakened"),
    Change("part-rigidity", ">= part_rigidity_needed[c]\n", ">= part_rigidity_needed[c] div 2\n", "weakened"),
    Change("nested-before-host-holes", "kind[guest] = OUTER", "kind[guest] = MARK", "weakened", HOST),
    Change("inner-before-outer", "before(i, parent[i])", "before(i, parent[i]) \\/ kind[i] = HOLE", "weakened"),
    Change("scrap-last", "kind[i] != SCRAP /\\", "kind[i] = HOLE /\\", "weakened", CUT_UP),
]


FIRST = sorted(CHANGES, key=lambda change: CHANGES.index(change) not in (2, 3, 6, 12))
"""Reversed, weakened and strengthened first, each of another rule."""


def profile_of(folder: Path, change: Change, plants: bool) -> Profile:
    """A profile with one order rule on; of the plant's file, if wanted."""
    off = ", ".join(f"{name}: off" for name in OFF.split(", ") if name != change.rule)
    models = ""
    if plants:
        shipped = rule_file(change.rule).read_text(encoding="utf-8")
        assert shipped.count(change.old) == 1
        (folder / "plant").mkdir()
        written = shipped.replace(change.old, change.new)
        (folder / "plant" / rule_file(change.rule).name).write_text(written, encoding="utf-8")
        models = "models: plant/*.mzn\n"
    path = folder / f"{'own' if plants else 'shipped'}.yaml"
    path.write_text(f"{models}rules: {{{off}, {change.rule}: {change.setting}}}\n", encoding="utf-8")
    return load_profile(path)


def planned(change: Change, profile: Profile) -> VerifiedPlan:
    made = solve_and_verify(make_request(facts_of(change.nest, profile), profile), profile, SolveOptions(work=10.0))
    assert made.plan.solve.status == "optimal"
    return made


def cuts_of(made: VerifiedPlan) -> CutSequence:
    plan = made.plan
    return CutSequence(tuple(planned.cut for planned in plan.cuts), plan.start_side)


def test_a_file_that_cuts_in_loose_metal_is_contradicted(tmp_path: Path) -> None:
    """What lies in a contour is cut before it, whatever a plant's file says: that is no rule but a promise."""
    change = Change("inner-before-outer", "before(i, parent[i])", "before(parent[i], i)", "reversed")
    with pytest.raises(RulesConflict) as error:
        planned(change, profile_of(tmp_path, change, True))
    assert "cutting A.outer frees the metal it is in" in str(error.value)


@pytest.mark.parametrize("change", few(FIRST, 4), ids=lambda c: f"{c.rule} {c.how}")
def test_the_plants_file_is_obeyed_and_judged_by(tmp_path: Path, change: Change) -> None:
    own, shipped = profile_of(tmp_path, change, True), profile_of(tmp_path, change, False)
    of_own, of_shipped = planned(change, own), planned(change, shipped)
    (judged,) = (j for j in of_own.verdict.rules if j.id == change.rule)
    assert judged.verdict == "holds"
    options = own.settings()[change.rule].options
    by_shipped = RULES[change.rule].violations(change.nest, cuts_of(of_own), shipped.settings()[change.rule].options)
    by_own = own.rulebook()[change.rule].violations(change.nest, cuts_of(of_shipped), options)
    cost, before = of_own.plan.solve.objective, of_shipped.plan.solve.objective
    if change.how == "reversed":
        assert by_shipped != []
        assert by_own != []
    elif change.how == "weakened":
        assert by_own == []
        assert cost <= before
        assert (by_shipped != []) == (cost < before)
    else:
        assert by_shipped == []
        assert cost >= before
        assert (by_own != []) == (cost > before)
    assert all(f"({rule_file(change.rule).name}:" in violation.text for violation in by_own)


@cache
def names() -> frozenset[str]:
    return frozenset(change.how for change in CHANGES if isinstance(change, Change))


def test_every_kind_of_change_is_tried() -> None:
    assert names() == {"reversed", "weakened", "strengthened"}


FULL = nest(
    420, 260,
    part("H", rect(20, 20, 110, 110), [rect(35, 35, 80, 80)]),
    part("G", rect(55, 55, 40, 40)),
    part("M", rect(160, 20, 90, 90), [rect(180, 40, 20, 20)], marks=[[(215, 80), (235, 80)]]),
    part("U", [(280, 20), (390, 20), (390, 50), (310, 50), (310, 110), (390, 110), (390, 140), (280, 140)]),
    part("V", rect(335, 65, 40, 30)),
)  # fmt: skip
REPLACED = [name for name, rule in RULES.items() if not rule.takes_no_file]


@pytest.mark.parametrize("rule", few(REPLACED, 3))
@pytest.mark.parametrize("strength", ["hard", "soft"])
def test_a_copy_of_a_shipped_file_changes_nothing(tmp_path: Path, rule: str, strength: str) -> None:
    if strength not in RULES[rule].strengths:
        return
    weight = ", weight: 40" if strength == "soft" else ""
    others = {"zone-order": "", "heat-lag": "level-ahead: off, hull-before: off, zone-order: off, "}
    zones = others.get(rule, "zone-order: {zone_contours: 4}, ")
    options = ", heat_radius: 16 mm" if rule == "heat-lag" else ""
    settings = f"rules: {{{zones}{rule}: {{strength: {strength}{weight}{options}}}}}\n"
    (tmp_path / "shipped.yaml").write_text(settings, encoding="utf-8")
    text = rule_file(rule).read_text(encoding="utf-8")
    (tmp_path / rule_file(rule).name).write_text(text, encoding="utf-8")
    (tmp_path / "own.yaml").write_text(f"models: '*.mzn'\n{settings}", encoding="utf-8")
    shipped, own = (planned_in(FULL, load_profile(tmp_path / name)) for name in ("shipped.yaml", "own.yaml"))
    assert own.verdict.ok == shipped.verdict.ok is True
    assert (own.plan.solve.objective, own.plan.solve.status) == (shipped.plan.solve.objective, "optimal")
    assert {j.id: j.verdict for j in own.verdict.rules}[rule] == {j.id: j.verdict for j in shipped.verdict.rules}[rule]


def planned_in(of: Nest, profile: Profile) -> VerifiedPlan:
    return solve_and_verify(make_request(facts_of(of, profile), profile), profile, SolveOptions(work=3.0))


def test_every_file_that_may_be_replaced_is_changed() -> None:
    changed = {change.rule for entry in CHANGES for change in getattr(entry, "values", (entry,))}
    assert changed == set(REPLACED)
