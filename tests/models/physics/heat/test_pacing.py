"""Waits for metal to cool: found where they help, none where they cannot, and no longer than needed."""

from __future__ import annotations

import numpy as np
import pytest

from kerfwise.models.physics.heat import TimedPath
from kerfwise.models.physics.heat.pacing import Pacing, delay_burn, hot_spots, pace
from kerfwise.models.physics.heat.timed_path import in_order, make_grid, torch_on
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.plant_sections import Heat

PLATE = nest(400, 200, part("A", rect(50, 50, 60, 100)), part("B", rect(135, 50, 60, 100)))
HEAT = Heat(absorbed_power_w=1500.0, limit_c=115.0)
GRID = make_grid(PLATE, HEAT.grid_mm)
THICK_MM = 6.0


def line(name: str, x: float, begin_s: float) -> tuple[str, np.ndarray, float, float]:
    return name, np.array([[x, 60.0], [x, 140.0]]), begin_s, begin_s + 2.0


def lines(*starts: float, apart: float = 22.0) -> TimedPath:
    """Parallel cuts, each `apart` mm from the one before it: what is between them is heated from both sides."""
    burns = [torch_on(*line(f"L{k}", 110.0 + apart * k, s)) for k, s in enumerate(starts)]
    return in_order(burns, starts[-1] + 2.0)


def paced(path: TimedPath, limit_c: float, longest_s: float = 3600.0) -> Pacing:
    return pace(PLATE, path, HEAT, THICK_MM, limit_c, longest_s, GRID)


def peaks(path: TimedPath, limit_c: float = 1000.0) -> list[float]:
    return [spot.peak_c for spot in hot_spots(PLATE, path, HEAT, THICK_MM, limit_c)]


def test_a_cool_program_needs_no_waits() -> None:
    found = paced(lines(1.0, 200.0), 1000.0)
    assert (found.heated, found.waits, found.possible, found.wait_s) == ((), {}, True, 0)
    assert found.peak_c == pytest.approx(max(peaks(lines(1.0, 200.0))), abs=0.5)


def test_a_wait_is_found_and_is_no_longer_than_needed() -> None:
    close, spread = lines(1.0, 3.5), lines(1.0, 400.0)
    hot_c, cool_c = max(peaks(close)), max(peaks(spread))
    limit_c = (hot_c + cool_c) / 2
    assert cool_c < limit_c < hot_c
    found = paced(close, limit_c)
    (heated,) = found.heated
    assert (heated.contour, heated.spot.peak_c) == ("L1", pytest.approx(hot_c, abs=0.5))
    wait_s = found.waits["L1"]
    assert heated.wait_s == wait_s > 0
    burns = close.burns

    def waiting(seconds: float) -> float:
        return max(peaks(in_order([burns[0], delay_burn(burns[1], seconds)], 0.0)))

    assert waiting(wait_s) <= limit_c + 0.2
    assert waiting(wait_s - 1.5) > limit_c


def test_where_a_burn_is_too_hot_by_itself_no_wait_is_proposed() -> None:
    alone = peaks(lines(1.0))[0]
    found = paced(lines(1.0, 300.0), alone - 5.0)
    assert not found.possible
    assert found.waits == {}
    assert found.heated[0].wait_s is None
    assert found.heated[0].least_c == pytest.approx(alone, abs=0.5)
    assert found.peak_c >= alone - 0.5


def test_a_wait_that_is_too_long_is_not_taken_for_enough() -> None:
    close = lines(1.0, 3.5)
    limit_c = max(peaks(lines(1.0, 400.0))) + 1.0
    needed_s = paced(close, limit_c).wait_s
    short = paced(close, limit_c, longest_s=needed_s / 4)
    assert not short.possible
    assert short.waits == {"L1": needed_s / 4}
    assert short.heated[0].least_c > limit_c


def test_a_place_that_is_too_hot_is_told_once() -> None:
    close = lines(1.0, 3.5, 6.0, apart=30.0)
    limit_c = min(peaks(close)) + 1.0
    spots = hot_spots(PLATE, close, HEAT, THICK_MM, limit_c)
    hot = [spot.at for spot in spots if spot.peak_c > limit_c]
    assert len(hot) == len(set(hot)) > 0
    assert [spot.at_s for spot in spots] == [1.0, 3.5, 6.0]


def test_no_program_no_spots() -> None:
    assert hot_spots(PLATE, TimedPath((), 0.0), HEAT, THICK_MM, 100.0) == ()
    assert paced(TimedPath((), 0.0), 100.0).heated == ()
