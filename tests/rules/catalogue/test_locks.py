"""What locks about order and zones state."""

from __future__ import annotations

from itertools import permutations

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts import FactOptions, compute_facts
from kerfwise.rules.case import in_order, nest, part, rect
from kerfwise.rules.catalogue.locks import Locks, LocksOptions
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.yaml_positions import Place
from kerfwise.rules.statements import AtLeast, Before, Precede, Statement

ROW = nest(
    400, 100, part("A", rect(10, 10, 60, 80)), part("B", rect(80, 10, 60, 80)), part("C", rect(150, 10, 60, 80)),
    part("D", rect(220, 10, 60, 80)),
)  # fmt: skip
LOCKS = [
    Lock(contour="C.outer", before="A.outer"),
    Lock(contour="B.outer", position="first"),
    Lock(contour="B.outer", position="last"),
    *(Lock(contour="B.outer", position=k) for k in (1, 2, 3, 4)),
]


def stated(*locks: Lock) -> list[Statement]:
    return list(Locks().statements(compute_facts(ROW, FactOptions(), ()), LocksOptions(locks=locks)))


def holds(statement: Statement, at: dict[int, int]) -> bool:
    if isinstance(statement, Precede):
        return at[statement.before] < at[statement.after]
    assert isinstance(statement, AtLeast)
    true = [at[x.i] < at[x.j] for x in statement.literals if isinstance(x, Before)]
    return sum(w * t for w, t in zip(statement.weights, true, strict=True)) >= statement.bound


@pytest.mark.parametrize("lock", LOCKS, ids=str)
def test_every_order_is_judged_alike(lock: Lock) -> None:
    statements = stated(lock)
    for order in permutations(range(4)):
        cuts = in_order(ROW, " ".join(ROW.contours[k].id for k in order))
        broken = Locks().violations(ROW, cuts, LocksOptions(locks=(lock,)))
        assert all(holds(s, {c: k for k, c in enumerate(order)}) for s in statements) == (not broken), order


def test_sentences() -> None:
    first = stated(Lock(contour="B.outer", position="first", place=Place("plant.yaml", 9, 5)))
    assert [s.about.sentence for s in first] == [
        f"B.outer is cut before {other}.outer: B.outer is first, locked by the operator (plant.yaml:9:5)"
        for other in "ACD"
    ]
    third = stated(Lock(contour="B.outer", position=3))
    assert [s.about.sentence for s in third] == ["B.outer is cut 3 in order: locked by the operator"] * 2


def test_zone_of_a_part_is_for_the_facts_to_keep() -> None:
    facts = compute_facts(ROW, FactOptions(zone_contours=2, zone_fixed=(("D", 1),)), ())
    assert list(Locks().statements(facts, LocksOptions(locks=(Lock(part="D", zone=1),)))) == []


def test_zone_that_the_sheet_does_not_have() -> None:
    facts = compute_facts(ROW, FactOptions(zone_contours=2, zone_fixed=(("D", 7),)), ())
    lock = Lock(part="D", zone=7, place=Place("plant.yaml", 9, 5))
    with pytest.raises(InputError, match=r"plant.yaml:9:5: lock: part D cannot be in zone 7, only in zone 3 of 1…3"):
        list(Locks().statements(facts, LocksOptions(locks=(lock,))))
