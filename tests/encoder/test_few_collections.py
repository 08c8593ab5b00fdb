"""No look through all objects within a block, the usual ones after it; what others put aside stays there."""

from __future__ import annotations

import gc
from collections.abc import Iterator

import pytest

from kerfwise.encoder.few_collections import NEVER, few_collections


@pytest.fixture(autouse=True)
def usual() -> Iterator[tuple[int, int, int]]:
    before = gc.get_threshold()
    yield before
    gc.set_threshold(*before)


def test_blocks_in_blocks_end_with_the_outermost(usual: tuple[int, int, int]) -> None:
    with few_collections():
        with few_collections():
            assert gc.get_threshold() == (*usual[:2], NEVER)
        assert gc.get_threshold() == (*usual[:2], NEVER)
    assert gc.get_threshold() == usual


def test_what_is_switched_off_stays_off() -> None:
    gc.set_threshold(0)
    with few_collections():
        assert gc.get_threshold()[0] == 0
    assert gc.get_threshold()[0] == 0


@pytest.mark.slow
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


class Circle:
    """An object that nobody but itself holds."""

    def __init__(self) -> None:
        self.own = self


def circles() -> int:
    return sum(isinstance(found, Circle) for found in gc.get_objects())


@pytest.mark.slow
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


def test_what_others_have_put_aside_stays_there() -> None:
    gc.freeze()
    try:
        aside = gc.get_freeze_count()
        with few_collections():
            pass
        assert gc.get_freeze_count() == pytest.approx(aside, rel=0.01)
    finally:
        gc.unfreeze()
