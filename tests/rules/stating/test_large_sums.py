"""Sums of orders that are too many for the integer program: what gives way so that they hold, against all orders."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

from kerfwise.postproc.check import hard_orders
from kerfwise.postproc.check.hard_orders import SumsRoom
from kerfwise.rules.statements import About, AtLeast, Before
from kerfwise.rules.stating import feasible_sums
from kerfwise.rules.stating.feasible_sums import links_to_drop_for_sums, shown_impossible

N = 6
ABOUT = About("r", (), "")


def drawn(seed: int) -> tuple[list[tuple[int, int]], list[int | None], list[AtLeast]]:
    """Orders, some of which give way, and contours that are to be out before much else is."""
    random = np.random.default_rng(seed)
    links = sorted({tuple(sorted(random.choice(N, 2, replace=False).tolist())) for _ in range(8)})
    weights = [None if random.random() < 0.3 else 1 for _ in links]
    sums = []
    for contour in random.choice(N, 2, replace=False).tolist():
        others = [k for k in range(N) if k != contour]
        lengths = random.integers(1, 9, N - 1).tolist()
        bound = -int(random.integers(0, 12))
        sums.append(AtLeast(tuple(Before(k, contour) for k in others), tuple(-w for w in lengths), bound, ABOUT))
    return [(int(a), int(b)) for a, b in links], weights, sums


def can_hold(links: list[tuple[int, int]], sums: list[AtLeast]) -> bool:
    def holds(place: tuple[int, ...]) -> bool:
        kept = all(place[a] < place[b] for a, b in links)
        return kept and all(
            sum(
                weight
                for x, weight in zip(s.literals, s.weights, strict=True)
                if isinstance(x, Before) and place[x.i] < place[x.j]
            )
            >= s.bound
            for s in sums
        )

    return any(map(holds, permutations(range(N))))


def after(s: AtLeast) -> tuple[tuple[tuple[tuple[int, int], int], ...], int]:
    """A sum that wants a contour early, as what comes after it."""
    terms = [(x.j, x.i, -w) for x, w in zip(s.literals, s.weights, strict=True) if isinstance(x, Before)]
    return tuple(((a, b), w) for a, b, w in terms), s.bound + sum(w for _, _, w in terms)


def test_what_is_dropped_lets_the_sums_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing was dropped, and nothing shown, where the program had too many rows."""
    monkeypatch.setattr(feasible_sums, "MOST_ROWS", 0)
    monkeypatch.setattr(hard_orders, "MOST_CELLS", -1)
    helped = shown = checked = 0
    for seed in range(60):
        links, weights, sums = drawn(seed)
        impossible = not can_hold(links, sums)
        assert not shown_impossible(N, links, [], sums) or impossible
        shown += shown_impossible(N, links, [], sums)
        found = links_to_drop_for_sums(N, links, weights, [], sums)
        assert found is None or can_hold([link for k, link in enumerate(links) if k not in found[0]], sums)
        assert found is None or all(weights[k] is not None for k in found[0])
        helped += bool(found and found[0] and impossible)
        kept = [link for k, link in enumerate(links) if found is None or k not in found[0]]
        room = SumsRoom(N, [], [after(s) for s in sums])
        for k in found[0] if found else ():
            refused = room.none(kept, links[k])
            assert not refused or not can_hold([*kept, links[k]], sums)
            checked += refused
    assert helped > 5
    assert shown > 5
    assert checked > 5
