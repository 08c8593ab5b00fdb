"""Few looks for circles within a block, the usual ones after it, and nothing that others put aside is taken back."""

from __future__ import annotations

import gc
from collections.abc import Iterator

import pytest

from kerfwise.encoder import few_collections as block
from kerfwise.encoder.few_collections import MANY, NEVER, SELDOM, few_collections


@pytest.fixture(autouse=True)
def usual() -> Iterator[tuple[int, int, int]]:
    before = gc.get_threshold()
    yield before
    gc.set_threshold(*before)


def looks() -> int:
    """How often objects have been looked through so far, of any age."""
    return sum(generation["collections"] for generation in gc.get_stats())


def test_many_objects_are_made_without_a_look() -> None:
    before = looks()
    many = [[k] for k in range(20_000)]
    without = looks() - before
    assert without >= 5
    with few_collections():
        before = looks()
        more = [[k] for k in range(2 * MANY)]
        assert looks() == before
    assert looks() == before
    assert gc.get_count()[0] < 2_000  # they count as old, so that none is due
    assert len(many) < len(more)


def test_blocks_in_blocks_end_with_the_outermost(usual: tuple[int, int, int]) -> None:
    with few_collections():
        with few_collections(seldom=0):
            assert gc.get_threshold() == (SELDOM, usual[1], NEVER)
        assert gc.get_threshold() == (SELDOM, usual[1], NEVER)
    assert gc.get_threshold() == usual
    with few_collections(seldom=0):
        assert gc.get_threshold() == (usual[0], usual[1], NEVER)
    assert gc.get_threshold() == usual


def test_what_is_switched_off_stays_off() -> None:
    gc.set_threshold(0)
    with few_collections():
        assert gc.get_threshold()[0] == 0
    assert gc.get_threshold()[0] == 0


def test_circles_of_a_block_are_found_afterwards() -> None:
    class Circle:
        own: Circle

    with few_collections():
        circle = Circle()
        circle.own = circle
        del circle
    assert any(isinstance(found, Circle) for found in gc.get_objects())
    gc.collect()
    assert not any(isinstance(found, Circle) for found in gc.get_objects())


def test_what_others_have_put_aside_stays_there() -> None:
    gc.freeze()
    try:
        aside = gc.get_freeze_count()
        with few_collections():
            pass
        assert gc.get_freeze_count() == pytest.approx(aside, rel=0.01)
    finally:
        gc.unfreeze()


class Circle:
    """An object that nobody but itself holds."""

    def __init__(self) -> None:
        self.own = self


def circles() -> int:
    return sum(isinstance(found, Circle) for found in gc.get_objects())


def test_blocks_that_make_little_leave_it_to_the_usual_looks() -> None:
    gc.collect()
    before = circles()
    for _ in range(30):
        for _ in range(20):
            with few_collections():
                kept = [Circle() for _ in range(50)]
                del kept
    assert circles() < before + 15_000
    gc.collect()


def test_blocks_that_make_much_are_looked_through_at_the_latest_when_there_is_twice_as_much(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(block, "MANY", 1_000)
    monkeypatch.setattr(block, "SELDOM", 5_000)
    monkeypatch.setattr(block, "_all", 0)
    monkeypatch.setattr(block, "_unseen", 0)
    most = 0
    for _ in range(10):
        with few_collections(SELDOM):
            for _ in range(2_000):
                Circle()
        most = max(most, circles())
        if block._all:
            monkeypatch.setattr(block, "_all", 0)  # the objects of the whole test run are many more
    assert 2_000 <= most <= 6_000
    gc.collect()
