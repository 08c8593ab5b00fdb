"""Where the torch waits is in every picture: a ring on the pierce, and for how long."""

from __future__ import annotations

from dataclasses import replace

import pytest
import shapely

from kerfwise.encoder.nest import Nest
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.report import draw
from kerfwise.postproc.report.picture import make_scene
from kerfwise.postproc.report.scene import CAP_HEIGHT, Dot, TextLine, View, text_width
from kerfwise.rules.case import nest, part, rect
from kerfwise.tests.postproc.report.plausible import plausible_plan

PLATE = nest(700, 400, *(part(f"P{x}{y}", rect(20 + 90 * x, 20 + 90 * y, 80, 80)) for x in range(7) for y in range(4)))


def waiting(made: Nest, *waits: tuple[int, float]) -> Plan:
    """A plan in which the torch waits so many seconds before the cuts at these places."""
    plan = plausible_plan(made)
    before = dict(waits)
    cuts = [replace(planned, dwell_s=before.get(k, 0.0)) for k, planned in enumerate(plan.cuts, 1)]
    return replace(plan, cuts=tuple(cuts))


def test_a_ring_on_the_pierce_and_the_time_beside_it() -> None:
    plan = waiting(PLATE, (3, 12.5), (20, 75.0))
    scene = make_scene(PLATE, plan)
    rings = [item for item in scene.layer("waits") if isinstance(item, Dot)]
    times = [item for item in scene.layer("waits") if isinstance(item, TextLine)]
    view = View.of(PLATE.sheet.bounds, len(PLATE.contours), 700 * 400)
    assert [(ring.cut, time.cut) for ring, time in zip(rings, times, strict=True)] == [(3, 3), (20, 20)]
    assert [time.text for time in times] == ["wait 12.5 s", "wait 1 min 15 s"]
    for ring, time in zip(rings, times, strict=True):
        assert (ring.x, ring.y) == pytest.approx(view.point(plan.cuts[ring.cut - 1].cut.pierce), abs=2)
        assert abs(time.x - ring.x) < text_width(time.text, time.size, bold=True)
        assert abs(time.y - ring.y) < 4 * time.size


def box(text: TextLine) -> shapely.Polygon:
    wide, high = text_width(text.text, text.size, text.bold) / 2, text.size * CAP_HEIGHT / 2
    return shapely.box(text.x - wide, text.y - high, text.x + wide, text.y + high)


def test_times_cover_neither_each_other_nor_the_numbers() -> None:
    scene = make_scene(PLATE, waiting(PLATE, *((k, 30.0 + k) for k in range(1, 29, 2))))
    times = [box(item) for item in scene.layer("waits") if isinstance(item, TextLine)]
    numbers = [box(item) for item in scene.layer("numbers") if isinstance(item, TextLine)]
    assert len(times) == 14
    assert all(a.intersection(b).area < 1e-6 for k, a in enumerate(times) for b in [*times[:k], *numbers])


def test_the_key_and_the_totals_tell_of_waits_where_there_are_any() -> None:
    texts = {
        waits: {item.text for layer in ("header", "footer") for item in make_scene(PLATE, plan).layer(layer)
                if isinstance(item, TextLine)}
        for waits, plan in ((0, plausible_plan(PLATE)), (2, waiting(PLATE, (3, 12.5), (20, 75.0))))
    }  # fmt: skip
    assert ["waits for metal to cool" in texts[k] for k in (0, 2)] == [False, True]
    assert [any("1 min 28 s of it waiting" in text for text in texts[k]) for k in (0, 2)] == [False, True]


def test_every_type_of_picture_has_them() -> None:
    plan = waiting(PLATE, (3, 12.5))
    assert ">wait 12.5 s</text>" in draw(PLATE, plan, ".svg").decode()
    assert '"wait_s":12.5' in draw(PLATE, plan, ".html").decode()
    assert draw(PLATE, plan, ".png") != draw(PLATE, plausible_plan(PLATE), ".png")
