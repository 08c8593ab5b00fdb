"""Millimetres on the page."""

from __future__ import annotations

import numpy as np
import pytest

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.postproc.report.legend import Clock
from kerfwise.postproc.report.scene import MARGIN, View
from kerfwise.rules.case import circle


@pytest.mark.parametrize("window", [(0, 0, 6000, 1500), (-10, -20, 700, 3000), (0, 0, 1, 1)])
def test_the_window_fits_on_the_page_and_up_is_up(window: tuple[float, float, float, float]) -> None:
    view = View.of(window, 10, 100.0)
    (left, bottom), (right, top) = view.xy([window[:2], window[2:]]).tolist()
    assert MARGIN - 1e-9 <= left < right <= view.width - MARGIN + 1e-9
    assert 0 < top < bottom < view.height
    assert (right - left) / (window[2] - window[0]) == pytest.approx((bottom - top) / (window[3] - window[1]))


def test_denser_nests_have_finer_pens_within_limits() -> None:
    views = [View.of((0, 0, 6000, 1500), n, 6000 * 1500) for n in (1, 16, 300, 1000, 100_000)]
    for name in ("line_width", "number_size", "dot_radius", "arrow_size"):
        sizes = [getattr(v, name) for v in views]
        assert sizes == sorted(sizes, reverse=True)
        assert sizes[-1] > 0


def test_a_circle_stays_round_and_closed_curves_do_not_repeat_their_first_point() -> None:
    view = View.of((0, 0, 200, 200), 1, 40_000)
    points = view.path(Curve.of(circle(100, 100, 50)))
    radii = np.hypot(*(points - view.point((100, 100))).T)
    assert radii == pytest.approx(50 * view.scale, abs=0.1)
    assert not np.allclose(points[0], points[-1])


@pytest.mark.parametrize(
    ("clock", "labels"),
    [
        (Clock(160.0, True), ["0", "50", "100", "150 s"]),
        (Clock(3600.0, True), ["0", "10", "20", "30", "40", "50", "60 min"]),
        (Clock(3.0, False), ["0", "1", "2", "3 cuts"]),
    ],
)
def test_ticks_of_the_colour_bar(clock: Clock, labels: list[str]) -> None:
    ticks = clock.ticks()
    assert [label for _, label in ticks] == labels
    assert all(0 <= place <= 1 for place, _ in ticks)
