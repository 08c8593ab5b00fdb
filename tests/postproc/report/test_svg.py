"""SVG text: exact, well formed, the same every time."""

from __future__ import annotations

from collections import Counter
from xml.etree import ElementTree

import numpy as np
import pytest

from kerfwise.encoder.nest import Nest
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.report.picture import make_scene
from kerfwise.postproc.report.plot import svg_text
from kerfwise.postproc.report.scene import Dot, Scene, SceneLayer, Shape, Style, TextLine
from kerfwise.rules.case import circle, nest, part, rect
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
