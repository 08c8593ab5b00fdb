"""The closed order, block by block and block in block, is the plain closure of all that blocks ask for."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from kerfwise.models import jit
from kerfwise.models.problem.moves import PairTable
from kerfwise.models.problem.precedence import close, columns_packed, immediate, lawful_followers, unpacked


def plainly(n: int, pairs: list[tuple[int, int]], block: list[int]) -> np.ndarray:
    """Handed on until nothing changes: within a block from contour to contour, else from block to block."""
    before = np.zeros((n, n), dtype=bool)
    for a, b in pairs:
        if block[a] == block[b]:
            before[a, b] = True
        else:
            before |= np.logical_and.outer(np.array(block) == block[a], np.array(block) == block[b])
    known = -1
    while before.sum() > known:
        known = before.sum()
        further = (before.astype(float) @ before.astype(float)) > 0
        same = np.equal.outer(block, block)
        lifted = np.array([[further[i, j] and not same[i, j] for j in range(n)] for i in range(n)], dtype=bool)
        before |= lifted.reshape(n, n) | (further & same)
    return before


@st.composite
def orders(draw: st.DrawFn) -> tuple[int, list[tuple[int, int]], list[int]]:
    """Contours, pairs that follow one order of the blocks and of the contours in them, and the block of each."""
    n = draw(st.integers(1, 8))
    block = sorted(draw(st.lists(st.integers(0, n - 1), min_size=n, max_size=n)))
    block = [block.index(b) for b in block]
    later = draw(st.lists(st.tuples(st.integers(0, n - 1), st.integers(0, n - 1)), max_size=12))
    return n, [(a, b) for a, b in later if a < b], block


@given(orders())
@example((1, [], [0]))
@example((4, [(0, 1), (1, 3)], [0, 1, 1, 3]))
def test_closed_as_it_is_handed_on(given: tuple[int, list[tuple[int, int]], list[int]]) -> None:
    n, pairs, block = given
    assert close(n, pairs, np.array(block)).tolist() == plainly(n, pairs, block).tolist()


def test_nothing_to_close() -> None:
    assert close(0, [], np.zeros(0, dtype=np.int64)).shape == (0, 0)


def test_orders_that_go_round_have_a_true_diagonal() -> None:
    assert close(3, [(0, 1), (1, 0)], np.array([0, 0, 2])).diagonal().tolist() == [True, True, False]
    assert close(4, [(0, 2), (3, 1)], np.array([0, 0, 2, 2])).diagonal().all()


@given(orders(), st.lists(st.tuples(st.integers(0, 7), st.integers(0, 7)), max_size=2))
def test_who_may_follow_whom_is_told_pair_by_pair(
    given: tuple[int, list[tuple[int, int]], list[int]], far: list[tuple[int, int]]
) -> None:
    n, pairs, block = given
    before = plainly(n, pairs, block)
    apart = [(i, j) for i, j in far if i < n and j < n]
    barred = PairTable.of(n + 1, [(np.array([i]), np.array([j]), 1) for i, j in apart[:1]])
    alike = [[k for k in range(n) if block[k] == block[i]] for i in range(n)]

    def between(i: int, j: int) -> bool:
        return any(before[i, k] and before[k, j] for k in range(n))

    def follows(i: int, j: int) -> bool:
        if i == j or before[j, i] or (before[i, j] and between(i, j)) or (i, j) in apart or (j, i) in apart[1:]:
            return False
        left_last = not any(before[i, k] for k in alike[i])
        return block[i] == block[j] or (left_last and not any(before[k, j] for k in alike[j]))

    expected = [[follows(i, j) for j in range(n)] + [not before[i].any()] for i in range(n)]
    expected.append([not before[:, j].any() for j in range(n)] + [False])
    followers = lawful_followers(before, np.array(block), apart[1:], barred)
    assert followers.whole().tolist() == expected
    assert [followers[i].tolist() for i in range(n + 1)] == expected
    assert np.array([followers.ahead_of(j) for j in range(n + 1)]).T.tolist() == expected
    one, other = np.indices((n + 1, n + 1)).reshape(2, -1)
    assert followers.at(one, other).reshape(n + 1, n + 1).tolist() == expected
    near = [[bool(before[i, j]) and not between(i, j) for j in range(n)] for i in range(n)]
    assert immediate(before).tolist() == near


@pytest.mark.parametrize("compiled", [True, False])
def test_of_many_contours(compiled: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Sets of several words, more pairs than there are places at first, and blocks that are not next to each other."""
    monkeypatch.setattr(jit._process, "plain_steps", 0 if compiled else jit.PLAIN_STEPS * 10)
    n, drawn = 150, np.random.default_rng(1)
    for kept in (0.5, 0.05):
        place = drawn.permutation(n)
        block = place // 3
        rows = np.argwhere((drawn.random((n, n)) < kept) & (place[:, None] < place))
        before = close(n, rows, block)
        assert before.tolist() == plainly(n, [(a, b) for a, b in rows.tolist()], block.tolist()).tolist()
        between = (before.astype(float) @ before.astype(float)) > 0
        assert (immediate(before) == (before & ~between)).all()


@pytest.mark.parametrize("count", [0, 1, 7, 64, 511, 512, 1030])
def test_columns_are_packed_in_any_order_of_the_rows(count: int) -> None:
    chance = np.random.default_rng(count)
    relation = chance.random((count, 130)) < 0.5
    order = chance.permutation(count)
    assert (unpacked(columns_packed(relation), count) == relation.T).all()
    assert (unpacked(columns_packed(relation, order), count) == relation[order].T).all()
    assert (unpacked(columns_packed(relation.T), 130) == relation).all()


def test_orders_of_more_pairs_than_there_was_room_for_at_first() -> None:
    half = 40
    before = np.zeros((2 * half, 2 * half), dtype=np.bool_)
    before[:half, half:] = True  # each of one half before each of the other
    assert (immediate(before) == before).all()
