from kerfwise.encoder.readers.trim import trim_overlaps
from kerfwise.tests.encoder.readers.drawings import pieces


def test_the_later_line_is_cut_back() -> None:
    left, shared = trim_overlaps(pieces([(0, 0), (6, 0)], [(9, 0), (4, 0)]), 0.1)
    assert [p.curve.as_rows() for p in left] == [[[0, 0], [6, 0]], [[9, 0], [6, 0]]]
    assert [p.curve.as_rows() for p in shared] == [[[6, 0], [4, 0]]]


def test_one_chain_may_overlap_itself() -> None:
    ring = [(6, 0), (0, 0), (0, 10), (10, 10), (10, 0), (4, 0)]
    left, shared = trim_overlaps(pieces(ring), 0.1)
    assert left[0].curve.as_rows()[-1] == [6, 0]
    assert len(shared) == 1


def test_lines_that_only_meet_are_left_alone() -> None:
    for other in ([(6, 0), (9, 0)], [(6, 0), (6, 5)], [(3, 0), (3, 5)]):
        left, shared = trim_overlaps(pieces([(0, 0), (6, 0)], other), 0.1)
        assert shared == []
        assert left[1].curve.as_rows() == [list(p) for p in other]


def test_arcs_are_left_alone() -> None:
    assert trim_overlaps(pieces([(0, 0, 0.001), (6, 0)], [(4, 0), (9, 0)]), 0.1)[1] == []


def test_nothing_overlaps_nothing() -> None:
    assert trim_overlaps([], 0.1) == ([], [])
