"""A partial evaluation never changes what a rule says: every order and every pick of a small nest is tried.

The judge shares nothing with it: the same text is evaluated by a few lines of Python, each element beside its MiniZinc.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from itertools import pairwise, permutations, product
from pathlib import Path

import pytest

from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.facts.facts import Facts
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.expression.node import Lit
from kerfwise.rules.expression.numbers import ChoiceSum, equal, in_values
from kerfwise.rules.flat.model_rule import read_model_rule
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.statements import (
    AtLeast,
    Before,
    Contiguous,
    Enough,
    Forbid,
    Lag,
    Move,
    Pick,
    Precede,
    Statement,
    Steps,
)

pytestmark = pytest.mark.minizinc

ROW = nest(300, 80, *(part(name, rect(10 + 60 * k, 10, 40, 40)) for k, name in enumerate("ABCD")))
N = 4


@cache
def facts() -> Facts:
    profile = load_profile()
    found = build_candidates(ROW, profile.lead_options())
    first = [next(c for c in found if c.contour == k) for k in range(N)]
    second = [[c for c in found if c.contour == k][1] for k in range(N)]
    two = [c for pair in zip(first, second, strict=True) for c in pair]
    return compute_facts(ROW, profile.fact_options(), tuple(two))


Means = Callable[[dict[int, int], dict[int, int]], bool]

TRIED: list[tuple[str, Means]] = [
    ("before(2, 1)", lambda p, q: p[2] < p[1]),
    ("not before(3, 4)", lambda p, q: not p[3] < p[4]),
    ("before(1, 2) /\\ before(2, 3)", lambda p, q: p[1] < p[2] < p[3]),
    ("before(1, 2) \\/ (before(2, 3) /\\ before(3, 4))", lambda p, q: p[1] < p[2] or p[2] < p[3] < p[4]),
    (
        "(before(1, 2) /\\ before(3, 4)) \\/ (before(2, 1) /\\ before(4, 3))",
        lambda p, q: (p[1] < p[2]) == (p[3] < p[4]),
    ),
    ("before(1, 2) xor before(2, 3)", lambda p, q: (p[1] < p[2]) != (p[2] < p[3])),
    ("before(1, 2) <-> (before(3, 4) \\/ picked(1))", lambda p, q: (p[1] < p[2]) == (p[3] < p[4] or q[1] == 1)),
    ("picked(1) -> before(1, 3)", lambda p, q: q[1] != 1 or p[1] < p[3]),
    ("picked(1) /\\ picked(4) -> before(1, 2)", lambda p, q: not (q[1] == 1 and q[2] == 4) or p[1] < p[2]),
    ("picked(3) -> before(2, 1) /\\ before(2, 4)", lambda p, q: q[2] != 3 or (p[2] < p[1] and p[2] < p[4])),
    ("sum(j in 2..4)(bool2int(before(j, 1))) >= 2", lambda p, q: sum(p[j] < p[1] for j in (2, 3, 4)) >= 2),
    ("count([before(j, 1) | j in 2..4], true) = 1", lambda p, q: sum(p[j] < p[1] for j in (2, 3, 4)) == 1),
    (
        "3 * bool2int(before(1, 2)) + 5 * bool2int(picked(5)) >= 4",
        lambda p, q: 3 * (p[1] < p[2]) + 5 * (q[3] == 5) >= 4,
    ),
    ("position[2] <= 3", lambda p, q: p[2] <= 3),
    ("position[2] = 3", lambda p, q: p[2] == 3),
    ("position[2] != 3", lambda p, q: p[2] != 3),
    ("position[1] + 1 < position[3]", lambda p, q: p[1] + 1 < p[3]),
    ("position[1] in {1, 4}", lambda p, q: p[1] in (1, 4)),
    ("abs(position[1] - position[4]) = 2", lambda p, q: abs(p[1] - p[4]) == 2),
    ("max(position[1], position[2]) <= 3", lambda p, q: max(p[1], p[2]) <= 3),
    ("min(position[1], position[2]) = 1", lambda p, q: min(p[1], p[2]) == 1),
    ("max([position[i] | i in 1..3]) = 4", lambda p, q: max(p[1], p[2], p[3]) == 4),
    ("position[1] mod 2 = 0", lambda p, q: p[1] % 2 == 0),
    ("position[1] div 2 = position[2] div 2", lambda p, q: p[1] // 2 == p[2] // 2),
    ("[10, 20, 30, 40][position[1]] >= 25", lambda p, q: p[1] >= 3),
    ("position[1] * position[2] >= 6", lambda p, q: p[1] * p[2] >= 6),
    ("directly_before(1, 2)", lambda p, q: p[1] + 1 == p[2]),
    ("not directly_before(2, 1)", lambda p, q: p[2] + 1 != p[1]),
    ("directly_before(1, 2) \\/ directly_before(2, 1)", lambda p, q: abs(p[1] - p[2]) == 1),
    ("cuts_between(1, 4) >= 1", lambda p, q: abs(p[1] - p[4]) >= 2),
    ("cuts_between(4, 1) <= 1", lambda p, q: abs(p[1] - p[4]) <= 2),
    ("cuts_between(1, 2) = cuts_between(3, 4)", lambda p, q: abs(p[1] - p[2]) == abs(p[3] - p[4])),
    ("before(1, 2) -> cuts_between(1, 2) >= 2", lambda p, q: p[1] > p[2] or p[2] - p[1] >= 3),
    ("pick[2] = 3", lambda p, q: q[2] == 3),
    ("pick[2] in {4} \\/ before(1, 2)", lambda p, q: q[2] == 4 or p[1] < p[2]),
    ("cand_x[pick[1]] = cand_x[1]", lambda p, q: X[q[1] - 1] == X[0]),
    ("if before(1, 2) then before(2, 3) else picked(7) endif", lambda p, q: p[2] < p[3] if p[1] < p[2] else q[4] == 7),
    ("exists(i in 1..3)(forall(j in 1..4 where j != i)(before(i, j)))", lambda p, q: p[4] != 1),
    ("breaches([before(1, 2), before(2, 3), before(3, 4)]) <= 1", lambda p, q: 3 - rises(p) <= 1),
    ("position[1] < position[2] /\\ position[2] < 4 -> picked(1)", lambda p, q: not (p[1] < p[2] < 4) or q[1] == 1),
    ("true", lambda p, q: True),
]
X: list[int] = []


def rises(p: dict[int, int]) -> int:
    return sum(p[k] < p[k + 1] for k in (1, 2, 3))


def stated(folder: Path, text: str, *, soft: bool) -> list[Statement]:
    path = folder / "tried.mzn"
    path.write_text(f"array[int] of var bool: tried_holds = [{text}];\n", encoding="utf-8")
    rule = read_model_rule(path).with_strength("soft" if soft else "hard")
    return list(rule.statements(facts(), rule.Options()))


def holds(statement: Statement, order: tuple[int, ...], picks: tuple[int, ...]) -> bool:
    """Whether a statement holds; `order` and `picks` count from 0."""
    at = {k: place for place, k in enumerate(order)}
    match statement:
        case Precede(before, after):
            return at[before] < at[after]
        case Forbid(candidate):
            return candidate not in picks
        case Contiguous(contours):
            return max(at[k] for k in contours) - min(at[k] for k in contours) < len(contours)
        case Move(leave, reach, leaving=None, reaching=None):
            return not any(i in leave and j in reach for i, j in pairwise(order))
        case Lag(first, second):
            return abs(at[first] - at[second]) - 1 >= statement.cuts
        case AtLeast():
            if statement.when is not None and statement.when not in picks:
                return True
            return enough(statement, at, picks)
    raise AssertionError(statement)


def enough(asked: AtLeast | Enough, at: dict[int, int], picks: tuple[int, ...]) -> bool:
    total = 0
    for lit, weight in zip(asked.literals, asked.weights, strict=True):
        if isinstance(lit, Before):
            total += weight * (at[lit.i] < at[lit.j])
        elif isinstance(lit, Steps):
            total += weight * (lit.least <= at[lit.j] - at[lit.i] <= lit.most)
        else:
            total += weight * (enough(lit, at, picks) if isinstance(lit, Enough) else lit.c in picks)
    return total >= asked.bound


@pytest.mark.parametrize(("text", "means"), TRIED, ids=[text for text, _ in TRIED])
@pytest.mark.parametrize("soft", [False, True], ids=["hard", "soft"])
def test_every_plan_is_judged_alike(tmp_path: Path, text: str, means: Means, soft: bool) -> None:
    statements = stated(tmp_path, text, soft=soft)
    assert not soft or len(statements) <= 1
    X[:] = [round(c.pierce[0] * 100) for c in facts().candidates]
    for order, ways in product(permutations(range(N)), product((0, 1), repeat=N)):
        picks = tuple(2 * k + way for k, way in enumerate(ways))
        positions = {k + 1: order.index(k) + 1 for k in range(N)}
        wanted = means(positions, {k + 1: c + 1 for k, c in enumerate(picks)})
        assert all(holds(s, order, picks) for s in statements) == wanted, (order, picks)


@pytest.mark.parametrize(
    ("text", "lag"),
    [
        ("pause_ms(1, 2) >= 20000", (0, 1, 0, 20.0)),
        ("pause_ms(4, 2) > 999", (1, 3, 0, 1.0)),
        ("2 * pause_ms(1, 2) >= 2500", (0, 1, 0, 1.25)),
        ("5000 <= pause_ms(1, 3) + 1000", (0, 2, 0, 4.0)),
        ("cuts_between(3, 1) >= 2", (0, 2, 2, 0.0)),
    ],
)
def test_a_gap_becomes_a_lag(tmp_path: Path, text: str, lag: tuple[int, int, int, float]) -> None:
    (one,) = stated(tmp_path, text, soft=False)
    assert isinstance(one, Lag)
    assert (one.first, one.second, one.cuts, one.seconds) == lag


def test_a_soft_rule_asks_for_no_seconds(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="a soft rule cannot ask for pause_ms") as refused:
        stated(tmp_path, "pause_ms(1, 2) >= 20000", soft=True)
    assert (refused.value.line, "element 1 of tried_holds" in refused.value.message) == (1, True)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[pause_ms(1, 2) >= 5 \\/ before(1, 2)]", "pause_ms stands by itself only"),
        ("[stop[1] = 3]", "stop is a word of the sequence"),
        ("[befor(1, 2)]", "befor"),
        ("[chosen]; var bool: chosen", "a variable of its own, which nothing in a plan decides"),
    ],
)
def test_what_has_no_meaning_is_refused_with_its_line(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "tried.mzn"
    path.write_text(f"% tried\narray[int] of var bool: tried_holds =\n  {text};\n", encoding="utf-8")
    rule = read_model_rule(path)
    with pytest.raises(InputError, match=said) as refused:
        list(rule.statements(facts(), rule.Options()))
    assert refused.value.line in (2, 3)
    assert str(refused.value.file) == str(path)


def test_the_only_way_to_cut_a_contour_is_taken_for_granted() -> None:
    """A number by which way a contour is cut, that comes to the same whatever the way, asks for nothing."""
    only = ChoiceSum(0, {Lit(Pick(0)): 1}, n=1)
    assert equal(only, 1) is True
    assert equal(only, 2) is False
    assert in_values(ChoiceSum(2, {Lit(Pick(0)): 1, Lit(Pick(1)): 2}, n=1), [3, 4]) is True
