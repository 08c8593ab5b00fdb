"""The page of the large nests, tried on a small one."""

from __future__ import annotations

from kerfwise.benchmarks.scale import Job, page, row, run


def test_a_small_plate_is_proven_and_told() -> None:
    job = Job(20, True, (0.5, 2.0))
    seen = run(job)
    assert seen.proven_s is not None
    assert seen.first_s is not None
    assert seen.posed_s <= seen.first_s
    first, last = seen.costs_m
    assert last == seen.bound_m
    assert first is None or first >= last
    text = page([job], [seen])
    assert row(job, seen) in text
    assert "| plate | facts to problem, s | first plan, s | after 0.5 s | after 2 s | bound after 2 s |" in text
