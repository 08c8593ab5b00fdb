"""Drawings in cutting order: the libraries of others read the same geometry, in the order of the plan."""

from __future__ import annotations

import io
import json
import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import ezdxf
import pytest
import svgelements
from ezdxf.document import Drawing
from hypothesis import HealthCheck, given
from hypothesis import strategies as st

from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import read_nest
from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.jobs.nest_job.request import NestRequest, inputs_for
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.read_plan import read_plan
from kerfwise.postproc.nc.ordered_drawings import reordered_dxf, reordered_svg
from kerfwise.rules.case import rect
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.nest_file import nest_file
from kerfwise.tests.tools.amount import examples


def drawn() -> Drawing:
    """Loose lines and arcs, a circle, a polyline with a bulge, a turned block, colours, and words."""
    document = ezdxf.new("R2010", units=4)
    for name in ("SHEET", "CUT", "HOLES"):
        document.layers.add(name)
    space, cut = document.modelspace(), {"layer": "CUT", "color": 1}
    space.add_lwpolyline([(0, 0), (500, 0), (500, 200), (0, 200)], close=True, dxfattribs={"layer": "SHEET"})
    space.add_line((20, 20), (80, 20), dxfattribs=cut)
    space.add_circle((60, 60), 15, dxfattribs={"layer": "HOLES", "color": 3})
    space.add_line((100, 40), (100, 100), dxfattribs=cut)
    space.add_text("PLATE", dxfattribs={"layer": "SHEET"})
    bulged = [(150, 20, 0.3), (240, 20, 0), (240, 120, 0), (150, 120, 0)]
    space.add_lwpolyline(bulged, "xyb", close=True, dxfattribs={"layer": "CUT", "color": 5})
    block = document.blocks.new("TILE")
    tile = [(0, 0), (60, 0), (60, 60), (0, 60)]
    block.add_lwpolyline(tile, close=True, dxfattribs={"layer": "0", "color": 2})
    space.add_blockref("TILE", (380, 60), dxfattribs={"layer": "CUT", "rotation": 30})
    # the first part is closed by lines that are drawn in no order at all
    space.add_line((100, 100), (20, 100), dxfattribs=cut)
    space.add_arc((80, 40), 20, 270, 360, dxfattribs=cut)
    space.add_line((20, 100), (20, 20), dxfattribs=cut)
    return document


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@cache
def solved(name: str, content: bytes) -> str:
    """The plan of a drawing, as text."""
    Path(name).write_bytes(content)
    ended = kerfwise("solve", name, "--work", 1, "--plan", "made.plan.json")
    assert ended.code == 0, ended.err
    return Path("made.plan.json").read_text()


def planned(name: str, content: bytes) -> tuple[Plan, Nest]:
    text = solved(name, content)
    Path(name).write_bytes(content)
    Path("made.plan.json").write_text(text)
    return read_plan("made.plan.json"), read_nest(name)


def dxf() -> bytes:
    stream = io.StringIO()
    ezdxf.options.write_fixed_meta_data_for_testing = True
    drawn().write(stream)
    ezdxf.options.write_fixed_meta_data_for_testing = False
    return stream.getvalue().encode()


def read(content: bytes) -> list[Any]:
    return list(ezdxf.read(io.StringIO(content.decode())).modelspace())


def seen(entities: list[Any]) -> Iterator[tuple[Any, ...]]:
    """What an entity is, whatever its place in the file: blocks as what they hold."""
    for entity in entities:
        if entity.dxftype() == "INSERT":
            for one in entity.virtual_entities():
                one.dxf.layer = entity.dxf.layer
                yield from seen([one])
            continue
        kind = entity.dxftype()
        geometry: Any = ()
        if kind == "LINE":
            geometry = (*entity.dxf.start.round(5).xy, *entity.dxf.end.round(5).xy)
        elif kind in ("CIRCLE", "ARC"):
            angles = (entity.dxf.start_angle, entity.dxf.end_angle) if kind == "ARC" else ()
            geometry = (*entity.dxf.center.round(5).xy, entity.dxf.radius, *angles)
        elif kind == "LWPOLYLINE":
            geometry = tuple((round(x, 5), round(y, 5), round(b, 6)) for x, y, b in entity.get_points("xyb"))
        yield kind, entity.dxf.layer, entity.dxf.color, geometry


def contours_of(nest: Nest, entities: list[Any]) -> list[str]:
    """The contour that each entity lies on, runs of one contour told once."""
    names: list[str] = []
    for entity in entities:
        if entity.dxf.layer == "SHEET":
            continue
        point = middle_of(entity)
        name = min(nest.contours, key=lambda contour, at=point: contour.curve.project(at)[1]).id
        names += [name] if names[-1:] != [name] else []
    return names


def middle_of(entity: Any) -> tuple[float, float]:
    """A point of an entity: the middle of a line or an arc."""
    match entity.dxftype():
        case "LINE":
            point = entity.dxf.start.lerp(entity.dxf.end)
        case "ARC":
            point = next(entity.vertices([(entity.dxf.start_angle + entity.dxf.end_angle) / 2]))
        case "CIRCLE":
            point = next(entity.vertices([0.0]))
        case _:
            return tuple(entity.get_points("xy")[-1])
    return point.x, point.y


def areas(nest: Nest) -> list[float]:
    return sorted(round(abs(contour.curve.signed_area_mm2), 4) for contour in nest.contours)


def test_a_dxf_keeps_all_that_it_holds_in_cutting_order() -> None:
    content = dxf()
    plan, nest = planned("a.dxf", content)
    made = reordered_dxf(plan, nest, "a.dxf", ReadOptions())
    assert made.notes == ()
    before, after = read(content), read(made.content)
    assert Counter(seen(before)) == Counter(seen(after))
    assert contours_of(nest, after) == [cut.cut.contour for cut in plan.cuts]
    assert contours_of(nest, [e for e in before if e.dxftype() != "INSERT"]) != contours_of(nest, after)
    assert [e.dxftype() for e in after[:2]] == ["LWPOLYLINE", "TEXT"], "what is not cut stays in front"
    assert made.content == reordered_dxf(plan, nest, "a.dxf", ReadOptions()).content
    Path("b.dxf").write_bytes(made.content)
    again = read_nest("b.dxf")
    assert areas(again) == areas(nest)


@examples(15, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.randoms(use_true_random=False))
def test_any_order_of_cuts_is_the_order_of_both_drawings(rnd: Any) -> None:
    plan, nest = planned("a.dxf", dxf())
    cuts = list(plan.cuts)
    rnd.shuffle(cuts)
    turned = replace(plan, cuts=tuple(cuts))
    order = [cut.cut.contour for cut in cuts]
    assert contours_of(nest, read(reordered_dxf(turned, nest, "a.dxf", ReadOptions()).content)) == order
    Path("c.svg").write_bytes(reordered_svg(turned, nest, "a.dxf", ReadOptions()).content)
    paths = shapes(Path("c.svg").read_bytes())[1:]  # after the sheet
    assert [round(svgelements.Path(path).length(error=1e-6), 2) for path in paths] == [
        round(nest.contour(name).curve.length_mm, 2) for name in order
    ]


def test_lines_of_one_contour_follow_each_other_from_its_entry_on() -> None:
    plan, nest = planned("a.dxf", dxf())
    cut = min((p.cut for p in plan.cuts), key=lambda cut: nest.contour(cut.contour).curve.project((60, 20))[1])
    ring = nest.contour(cut.contour).curve.towards(cut.direction)
    made = read(reordered_dxf(plan, nest, "a.dxf", ReadOptions()).content)
    middles = [ring.project(middle_of(entity))[0] for entity in made if entity.dxftype() in ("LINE", "ARC")]
    entry_mm = ring.project(cut.entry)[0]
    along = [(s - entry_mm) % ring.length_mm for s in middles]
    assert along == sorted(along)
    assert len(along) == 5


SVG = b"""<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"
 width="400mm" height="200mm" viewBox="0 0 400 200"><g inkscape:label="sheet"><rect width="400" height="200" fill="none"
 stroke="#00ff00"/></g><g inkscape:label="cut" transform="translate(5 3)"><path stroke="#ff0000" fill="none"
 d="M 20 20 H 180 A 20 20 0 0 1 200 40 V 80 H 60 V 180 H 20 Z
 M 90 100 C 90 120 130 120 130 100 C 130 80 90 80 90 100 Z"/>
 <circle cx="160" cy="50" r="12" stroke="#0000ff" fill="none"/><ellipse cx="300" cy="120" rx="60" ry="40" fill="none"
 stroke="#ff0000"/></g></svg>"""


def shapes(content: bytes) -> list[Any]:
    svg = svgelements.SVG.parse(io.BytesIO(content), ppi=25.4)
    return [element for element in svg.elements() if isinstance(element, svgelements.Shape)]


def figures(content: bytes) -> Counter[tuple[Any, ...]]:
    """Of every subpath its box and length, and the colour of its line."""
    found: list[tuple[Any, ...]] = []
    for shape in shapes(content):
        for subpath in abs(svgelements.Path(shape)).as_subpaths():
            path = svgelements.Path(subpath)
            box = tuple(round(value, 3) + 0.0 for value in path.bbox())
            found.append((box, round(path.length(error=1e-7), 2), shape.stroke.hex))
    return Counter(found)


def test_an_svg_keeps_curves_colours_and_layers() -> None:
    plan, nest = planned("a.svg", SVG)
    made = reordered_svg(plan, nest, "a.svg", ReadOptions())
    assert figures(made.content) == figures(SVG)
    text = made.content.decode()
    assert text.count("C") == 2
    assert text.count("A") >= 5
    assert text.count('inkscape:label="cut"') == 1
    assert text.index('label="sheet"') < text.index('label="cut"')
    paths = shapes(made.content)[1:]
    lengths = [round(svgelements.Path(path).length(error=1e-7), 1) for path in paths]
    assert lengths == [round(nest.contour(cut.cut.contour).curve.length_mm, 1) for cut in plan.cuts]
    Path("b.svg").write_bytes(made.content)
    again = read_nest("b.svg")
    assert areas(again) == pytest.approx(areas(nest), abs=0.05)
    assert made.content == reordered_svg(plan, nest, "a.svg", ReadOptions()).content


@pytest.mark.parametrize("suffix", ["svg", "dxf"])
def test_a_json_nest_is_drawn_from_its_contours(suffix: str) -> None:
    circle = [[300, 70, 1], [340, 70, 1]]
    nest_file("a.json", [{"id": "A", "outer": rect(20, 20, 100, 100)}, {"id": "B", "outer": circle}])
    option = {"svg": "--svg", "dxf": "--reordered-dxf"}[suffix]
    ended = kerfwise("solve", "a.json", "--work", 1, "--plan", "a.plan.json", option, f"o.{suffix}")
    assert (ended.code, ended.out.splitlines()[-1]) == (0, f"written: a.plan.json, o.{suffix}")
    plan, nest, again = read_plan("a.plan.json"), read_nest("a.json"), read_nest(f"o.{suffix}")
    assert areas(again) == pytest.approx(areas(nest), abs=1e-3)
    assert again.sheet.bounds == pytest.approx(nest.sheet.bounds)
    if suffix == "dxf":
        first, *rest = read(Path("o.dxf").read_bytes())
        assert first.dxf.layer == "SHEET"
        for entity, cut in zip(rest, plan.cuts, strict=True):
            start = entity.vertices[0].dxf.location
            assert math.dist((start.x, start.y), cut.cut.entry) < 1e-4, "from its entry on"
            assert entity.is_closed


def test_a_colour_by_block_is_that_of_the_block() -> None:
    document = ezdxf.new("R2010", units=4)
    document.modelspace().add_lwpolyline([(0, 0), (300, 0), (300, 200), (0, 200)], close=True,
                                         dxfattribs={"layer": "SHEET"})  # fmt: skip
    block = document.blocks.new("TILE")
    block.add_lwpolyline([(0, 0), (60, 0), (60, 60)], close=True, dxfattribs={"color": 0})
    document.modelspace().add_blockref("TILE", (50, 60), dxfattribs={"layer": "CUT", "color": 4})
    text = io.StringIO()
    document.write(text)
    plan, nest = planned("block.dxf", text.getvalue().encode())
    *_, made = read(reordered_dxf(plan, nest, "block.dxf", ReadOptions()).content)
    assert (made.dxftype(), made.dxf.layer, made.dxf.color) == ("LWPOLYLINE", "CUT", 4)


def test_bridges_are_not_in_the_drawing() -> None:
    squares = [{"id": name, "outer": rect(x, 20, 100, 100)} for name, x in (("A", 20), ("B", 140))]
    nest_file("a.json", squares)
    text = json.loads(Path("a.json").read_text())
    text["bridges"] = [{"parts": ["A", "B"], "from": [120, 70], "to": [140, 70], "width": 8}]
    Path("a.json").write_text(json.dumps(text))
    ended = kerfwise("solve", "a.json", "--work", 1, "--svg", "a.svg")
    assert (ended.code, "--svg: bridges join parts" in ended.err) == (2, True), ended.err


def test_what_the_plan_does_not_cut_is_left_out_and_said() -> None:
    Path("skip.yaml").write_text(
        "based_on: plasma-carbon-steel\nsmall_holes: {min_hole: 40 mm, full_feed_hole: 40 mm, under: skip}\n"
    )
    Path("a.dxf").write_bytes(dxf())
    ended = kerfwise(
        "solve", "a.dxf", "-p", "skip.yaml", "--work", 1, "--reordered-dxf", "b.dxf", "--plan", "b.plan.json"
    )
    assert ended.code == 0, ended.err
    assert "note: b.dxf: the plan does not cut" in ended.err
    assert not [entity for entity in read(Path("b.dxf").read_bytes()) if entity.dxftype() == "CIRCLE"]


def test_names_that_do_not_fit() -> None:
    nest_file("a.json", [{"id": "A", "outer": rect(20, 20, 100, 100)}])
    for words in (["--svg", "a.dxf"], ["--reordered-dxf", "a.svg"]):
        ended = kerfwise("solve", "a.json", *words)
        assert (ended.code, "the reordered drawing is written as" in ended.err) == (2, True)


def test_refit_arcs_on_the_command_line() -> None:
    ring = [[60 + 40 * math.cos(2 * math.pi * k / 90), 60 + 40 * math.sin(2 * math.pi * k / 90)] for k in range(90)]
    nest_file("a.json", [{"id": "A", "outer": ring}])
    ended = kerfwise("solve", "a.json", "--work", 1, "--refit-arcs", "0.05 mm", "--svg", "a.svg", "-o", "a.nc",
                     "--plan", "a.plan.json")  # fmt: skip
    assert ended.code == 0, ended.err
    assert "repaired: 90 lines became 2 arcs in 1 contour, at most 0.0244 mm off (0.05 mm allowed)" in ended.err
    assert Path("a.svg").read_text().count("A") >= 2
    lines = Path("a.nc").read_text().splitlines()
    assert kerfwise("solve", "a.json", "--work", 1, "-o", "b.nc").code == 0
    assert len(lines) < len(Path("b.nc").read_text().splitlines()) - 60
    Path("refit.yaml").write_text("based_on: plasma-carbon-steel\ndrawing: {refit_arcs: 0.05 mm}\n")
    assert "2 arcs" in kerfwise("check", "a.json", "a.nc", "-p", "refit.yaml").err
    for made in ("a.nc", "a.plan.json"):
        ended = kerfwise("check", "a.json", made)
        assert ended.code == 0, ended.err
        assert f"note: arcs are refitted within 0.05 mm (--refit-arcs), as they were for {made}" in ended.err
        assert "2 arcs" in ended.err
        assert inputs_for("a.json", NestRequest(last=made)).nest.refit_arcs_mm == 0.05
        told = "note: arcs are refitted within 0.04 mm (--refit-arcs); for"
        ended = kerfwise("check", "a.json", made, "--refit-arcs", "0.04 mm")
        assert f"{told} {made} they were within 0.05 mm" in ended.err
        assert "note: arcs" not in kerfwise("check", "a.json", made, "--refit-arcs", "0.05 mm").err
    assert "arcs" not in kerfwise("check", "a.json", "b.nc").err
    ended = kerfwise("check", "a.json", "b.nc", "--refit-arcs", "0.05 mm")
    assert "note: arcs are refitted within 0.05 mm (--refit-arcs); b.nc does not say that they were for it" in ended.err
    for given_length in ("0", "-1 mm", "much", "nan"):
        ended = kerfwise("solve", "a.json", "-o", "c.nc", "--refit-arcs", given_length)
        assert (ended.code, "--refit-arcs" in ended.err) == (2, True), ended.err
