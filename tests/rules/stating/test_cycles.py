"""Which orders lie on cycles, contours that are cut together counting as one."""

from __future__ import annotations

from kerfwise.rules.stating.cycles import components, contracted, path


def test_links_off_the_cycle_are_none() -> None:
    assert components([(0, 1), (1, 2), (2, 0), (2, 3)]) == [[0, 1, 2]]
    assert components([(0, 1), (1, 2)]) == []
    assert components([]) == []


def test_contours_cut_together_are_one_node() -> None:
    # 1 after 0 and before 3, where 0 and 3 belong to one run: no contour can come between them.
    pairs = [(0, 1), (1, 3)]
    assert components(contracted(4, pairs, [])) == []
    assert components(contracted(4, pairs, [(0, 3)])) == [[0, 1]]


def test_runs_that_share_a_contour_are_one_run() -> None:
    assert components(contracted(4, [(0, 1), (1, 3)], [(0, 2), (2, 3)])) == [[0, 1]]


def test_cycle_within_a_run_is_found() -> None:
    assert components(contracted(2, [(0, 1), (1, 0)], [(0, 1)])) == [[0, 1]]


def test_path_is_the_shortest() -> None:
    links = [(0, 1), (1, 2), (2, 3), (0, 3)]
    assert path(links, range(4), 0, 3) == [3]
    assert path(links, range(3), 0, 3) == [0, 1, 2]
    assert path(links, range(4), 3, 0) is None
