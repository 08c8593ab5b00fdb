"""SVG text: exact, well formed, the same every time."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
import shapely

from kerfwise import Nest, Plan
from kerfwise.postproc.report import draw
from kerfwise.postproc.report.legend import Clock, counted
from kerfwise.postproc.report.picture import make_scene
from kerfwise.postproc.report.plot import svg_text
from kerfwise.postproc.report.scene import (
    CAP_HEIGHT,
    MARGIN,
    Dot,
    Scene,
    SceneLayer,
    Shape,
    Style,
    TextLine,
    View,
    text_width,
)
from kerfwise.rule_kit import Curve, circle, nest, part, rect
from kerfwise.tests.postproc.report.plausible import plausible_plan

SVG = "{http://www.w3.org/2000/svg}"


def plate() -> Nest:
    return nest(
        600,
        300,
        part("A", rect(20, 20, 200, 200), [circle(120, 120, 60)], [[(30, 30), (90, 30)]]),
        part("B", circle(120, 120, 40), [circle(120, 120, 8)]),
        part("C", rect(300, 20, 100, 250), [circle(350, 100, 20), circle(350, 200, 5)]),
    )


def numbers(root: ElementTree.Element) -> list[str]:
    group = root.find(f".//{SVG}g[@id='numbers']")
    assert group is not None
    return [text.text or "" for text in group.iter(f"{SVG}text")]


def test_the_text_of_a_small_scene() -> None:
    triangle = np.array([(0, 0), (10, 0.005), (0, 10.126)])
    scene = Scene(
        100,
        50.5,
        (
            SceneLayer("parts", (Shape((triangle,), Style(fill="#ff0000"), cut=2, title="P1 & more"),)),
            SceneLayer("empty", ()),
            SceneLayer("marks", (Shape((triangle,), Style(stroke="#0000ff", width=0.5, dash=(3, 1)), closed=False),)),
            SceneLayer(
                "top", (Dot(1, 2, 3, Style(fill="#00ff00")), TextLine(50, 25, "<7>", 10, halo="#ffffff", turned=True))
            ),
        ),
        "a < b",
    )
    assert svg_text(scene).splitlines() == [
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 50.5" width="100" height="50.5"'
        ' font-family="DejaVu Sans, Verdana, Arial, sans-serif">',
        "<title>a &lt; b</title>",
        '<rect width="100%" height="100%" fill="#ffffff"/>',
        '<g id="parts">',
        '<g fill="#ff0000">',
        '<path d="M0,0 10,0.01 0,10.13Z" data-cut="2"><title>P1 &amp; more</title></path>',
        "</g>",
        "</g>",
        '<g id="empty">',
        "</g>",
        '<g id="marks">',
        '<g fill="none" stroke="#0000ff" stroke-width="0.5" stroke-linejoin="round" stroke-linecap="round"'
        ' stroke-dasharray="3 1">',
        '<path d="M0,0 10,0.01 0,10.13"/>',
        "</g>",
        "</g>",
        '<g id="top">',
        '<g fill="#00ff00">',
        '<circle cx="1" cy="2" r="3"/>',
        "</g>",
        '<g class="text" fill="#212529" text-anchor="middle" stroke="#ffffff" stroke-linejoin="round"'
        ' paint-order="stroke">',
        '<text x="50" y="28.7" font-size="10" stroke-width="2.2" transform="rotate(-90 50 25)">&lt;7&gt;</text>',
        "</g>",
        "</g>",
        "</svg>",
    ]


def test_it_is_well_formed_and_has_every_order_number_once() -> None:
    made = plate()
    root = ElementTree.fromstring(svg_text(make_scene(made, plausible_plan(made))))
    assert Counter(numbers(root)) == Counter(str(k) for k in range(1, len(made.contours) + 1))


def test_the_same_plan_gives_the_same_bytes() -> None:
    first, second = (svg_text(make_scene(plate(), plausible_plan(plate()))) for _ in range(2))
    assert first == second


def test_every_cut_has_its_contour_its_arrow_and_its_pierce() -> None:
    made = plate()
    plan = plausible_plan(made)
    root = ElementTree.fromstring(svg_text(make_scene(made, plan)))
    for layer in ("contours", "directions", "pierces", "numbers"):
        group = root.find(f".//{SVG}g[@id='{layer}']")
        assert group is not None
        found = sorted(int(e.get("data-cut", 0)) for e in group.iter() if e.get("data-cut"))
        assert found == list(range(1, len(plan.cuts) + 1)), layer


def test_without_a_plan_the_parts_have_their_names() -> None:
    root = ElementTree.fromstring(svg_text(make_scene(plate())))
    assert numbers(root) == ["A", "B", "C"]


@pytest.mark.parametrize("name", ["<P&1>", "Деталь 5", "a\x07b", "$x$"])
def test_any_part_name_can_be_written(name: str) -> None:
    root = ElementTree.fromstring(svg_text(make_scene(nest(300, 300, part(name, rect(0, 0, 200, 200))))))
    assert numbers(root) == [name.replace("\x07", " ")]


def test_an_empty_plan_and_an_empty_sheet_can_be_drawn() -> None:
    made = plate()
    plan = plausible_plan(made)
    nothing = Plan(plan.nest, plan.profile, "left", "heat", (), plan.totals, plan.solve)
    assert numbers(ElementTree.fromstring(svg_text(make_scene(made, nothing)))) == ["A", "B", "C"]
    assert numbers(ElementTree.fromstring(svg_text(make_scene(nest(300, 200))))) == []


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


@pytest.mark.parametrize(("number", "said"), [(0, "0 parts"), (1, "1 part"), (2, "2 parts")])
def test_one_of_a_thing_is_no_plural(number: int, said: str) -> None:
    assert counted(number, "part") == said
