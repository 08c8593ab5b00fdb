"""Which orders lie on cycles, contours that are cut together counting as one."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.graphs import components, contracted, path
from kerfwise.tests.tools.amount import examples


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


@examples(100)
@given(st.lists(st.tuples(st.integers(0, 5), st.integers(0, 5)), max_size=14), st.sets(st.integers(0, 5), max_size=3))
def test_links_on_cycles_are_those_from_whose_end_one_comes_back(pairs: list[tuple[int, int]], run: set[int]) -> None:
    """By walks over single links: contours of a run count as one, but for orders among themselves."""
    node = {k: min(run) if k in run else k for k in range(6)}
    links = [(node[a], node[b]) if node[a] != node[b] else (6 + a, 6 + b) for a, b in pairs]

    def reached(start: int) -> set[int]:
        found = {start}
        while more := {b for a, b in links if a in found} - found:
            found |= more
        return found

    found = components(contracted(6, pairs, [sorted(run)]))
    assert sorted(k for of in found for k in of) == [k for k, (a, b) in enumerate(links) if a in reached(b)]
    assert all(links[one][0] in reached(links[other][0]) for of in found for one in of for other in of)
    assert found == sorted(found)
    assert all(of == sorted(of) for of in found)
