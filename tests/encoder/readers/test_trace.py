import numpy as np

from kerfwise.encoder.readers.join import Trail, trace


def traced(nodes: list[tuple[int, int]], twin: dict[int, int] | None = None) -> list[Trail]:
    group = list(range(len(nodes)))
    return trace(group, np.array(nodes), twin or {k: k for k in group})


def test_a_ring_drawn_in_any_direction_closes() -> None:
    assert traced([(0, 1), (2, 1), (2, 0)]) == [Trail(((0, True), (1, False), (2, True)), closed=True)]


def test_a_piece_that_returns_to_its_start_is_a_ring() -> None:
    assert traced([(4, 4)]) == [Trail(((0, True),), closed=True)]


def test_a_chain_is_followed_from_its_loose_end() -> None:
    assert traced([(1, 2), (0, 1), (3, 2)]) == [Trail(((1, True), (0, True), (2, False)), closed=False)]


def test_two_rings_that_share_a_corner_come_apart() -> None:
    # squares 0-1-2-3 and 2-4-5-6, drawn one after the other
    found = traced([(0, 1), (1, 2), (2, 3), (3, 0), (2, 4), (4, 5), (5, 6), (6, 2)])
    assert [sorted(k for k, _ in t.steps) for t in found] == [[0, 1, 2, 3], [4, 5, 6, 7]]
    assert all(t.closed for t in found)


def test_a_figure_eight_drawn_in_one_go_comes_apart_at_its_waist() -> None:
    found = traced([(0, 1), (1, 2), (2, 3), (3, 1), (1, 4), (4, 0)])
    assert sorted(sorted(k for k, _ in t.steps) for t in found) == [[0, 4, 5], [1, 2, 3]]


def test_a_line_drawn_twice_is_no_ring_of_two() -> None:
    found = traced([(0, 1), (0, 1), (1, 2), (2, 0)], twin={0: 0, 1: 0, 2: 2, 3: 3})
    assert [(len(t.steps), t.closed) for t in found] == [(3, True), (1, False)]


def test_every_piece_is_followed_once() -> None:
    nodes = [(0, 1), (1, 2), (2, 0), (2, 3), (3, 4), (4, 2), (4, 5), (6, 7)]
    steps = sorted(k for t in traced(nodes) for k, _ in t.steps)
    assert steps == list(range(len(nodes)))
