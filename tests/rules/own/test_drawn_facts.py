"""Own rules by what a drawing knows: layer, colour, block, writing, quantity, and the attributes of blocks."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from kerfwise import read_nest
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.encoder.readers.drawings import lines, read_drawing, save_dxf, square

PLAIN = """rules: {heat-lag: off, no-islands: off, no-narrow-strips: off, no-tip-travel: off, part-rigidity: off,
        level-ahead: off, hull-before: off, start-side: off, zone-order: off, pierce: {clearance: 2 mm}}
"""


def two_rows(space: Any) -> None:
    """Plates on layers A and B in turn, so that the shortest travel mixes them."""
    space.add_lwpolyline([(0, 0), (900, 0), (900, 200), (0, 200)], close=True, dxfattribs={"layer": "Sheet"})
    for k in range(6):
        lines(space, square(40 + 140 * k, 50, 90), layer="AB"[k % 2])


def solved(folder: Path, nest: Path, rules: str) -> tuple[list[str], Any]:
    """The parts in the order in which their outlines are cut, and how the command ended."""
    profile, plan = folder / "plant.yaml", folder / "a.plan.json"
    profile.write_text(f"{PLAIN}{rules}")
    ended = kerfwise("solve", nest, "-p", profile, "-o", folder / "a.nc", "--plan", plan, "--work", "2", "--no-job")
    cuts = json.loads(plan.read_text())["cuts"] if plan.exists() else []
    return [cut["part"] for cut in cuts if cut["kind"] == "outer"], ended


def test_a_layer_before_another_is_one_line(tmp_path: Path) -> None:
    nest = save_dxf(tmp_path, two_rows)
    order, ended = solved(
        tmp_path, nest, "own_rules:\n  - {name: A before B, select: {layer: A}, before: {layer: B}}\n"
    )
    assert ended.code == 0, ended.err
    assert {*order[:3]} == {"P1", "P3", "P5"}
    assert "holds      hard own:A before B" in ended.out
    other, _ = solved(tmp_path, nest, "own_rules:\n  - {name: B before A, select: {layer: B}, before: {layer: A}}\n")
    assert {*other[:3]} == {"P2", "P4", "P6"}
    why = kerfwise("explain", nest, tmp_path / "a.plan.json", "P1.outer", "-p", tmp_path / "plant.yaml")
    assert "drawn on layer 'A', white" in why.out


def test_a_layer_that_no_contour_has_is_told(tmp_path: Path) -> None:
    nest = save_dxf(tmp_path, two_rows)
    for rule in (
        "{name: r, select: {layer: C}, before: {layer: B}}",
        "{name: r, select: {layer: A}, before: {layer: C}}",
    ):
        _, ended = solved(tmp_path, nest, f"own_rules:\n  - {rule}\n")
        told = (
            "rule own:r has nothing to say here: it selects no contour of this nest: none has the layer 'C'; there is"
        )
        assert f"warning: {told} 'A', 'B'" in ended.out + ended.err
        assert "not judged hard own:r" in ended.out
        judged = kerfwise("check", nest, tmp_path / "a.nc", "-p", tmp_path / "plant.yaml")
        assert told in judged.out + judged.err


def test_a_model_file_speaks_of_layers(tmp_path: Path) -> None:
    (tmp_path / "a_before_b.mzn").write_text(
        "% a-before-b: layer A before layer B\n"
        "array[int] of var bool: a_before_b_holds = [before(i, j) | i, j in CONTOUR where\n"
        '  contour_layer[i] = "A" /\\ contour_layer[j] = "B"];\n'
    )
    order, ended = solved(tmp_path, save_dxf(tmp_path, two_rows), "models: [a_before_b.mzn]\n")
    assert ended.code == 0, ended.err
    assert {*order[:3]} == {"P1", "P3", "P5"}


def test_a_model_file_that_names_a_layer_of_no_contour_is_told(tmp_path: Path) -> None:
    (tmp_path / "c_first.mzn").write_text(
        '% c-first: layer C first, not contour_layer[1] = "X"\n'
        "array[int] of var bool: c_first_holds = [before(i, j) | i, j in CONTOUR where\n"
        '  contour_layer[i] = "C" /\\ contour_layer[j] = "B"];\n'
    )
    _, ended = solved(tmp_path, save_dxf(tmp_path, two_rows), "models: [c_first.mzn]\n")
    told = "it compares with the layer of no contour: none has the layer 'C'; there is 'A', 'B'"
    assert told in ended.out + ended.err


def blocks(space: Any) -> None:
    space.add_lwpolyline([(0, 0), (900, 0), (900, 200), (0, 200)], close=True, dxfattribs={"layer": "Sheet"})
    inner = space.doc.blocks.new("HOLE")
    inner.add_circle((0, 0), 15, dxfattribs={"color": 1})
    block = space.doc.blocks.new("HINGE_x4")
    lines(block, square(0, 0, 90))
    block.add_blockref("HOLE", (45, 45))
    for k, order in enumerate(("17", "18", "A-1")):
        insert = space.add_blockref("HINGE_x4", (40 + 140 * k, 50))
        insert.add_attrib("ORDER", order, dxfattribs={"layer": "DIM"})
    lines(space, square(600, 50, 90))


def test_blocks_and_their_attributes(tmp_path: Path) -> None:
    nest = read_nest(save_dxf(tmp_path, blocks), answers={"colour:red": "cut"})
    assert [c.source.block for c in nest.contours] == ["HINGE_x4/HOLE", "HINGE_x4"] * 3 + [""]
    assert [c.source.colour for c in nest.contours][:2] == ["red", "white"]
    assert [part.attributes for part in nest.parts] == [
        {"ORDER": 17, "quantity": 4},
        {"ORDER": 18, "quantity": 4},
        {"ORDER": "A-1", "quantity": 4},
        {},
    ]
    rules = """drawing: {answers: {"colour:red": cut}}
own_rules:
  - {name: red ones first, select: {colour: red}, before: {kind: outer}, scope: part}
  - name: order 18 last of the hinges
    select: {attribute.order: 18, kind: outer}
    after: {block: HINGE_x4, not: {attribute.order: 18}}
  - {name: single parts last, select: {block: "HINGE*", kind: outer}, before: {not: {block: "HINGE*"}}}
  - {name: many of one, select: {quantity: "> 3", kind: outer}, direction: cw}
"""
    order, ended = solved(tmp_path, tmp_path / "drawing.dxf", rules)
    assert ended.code == 0, ended.err
    assert order[2:] == ["P2", "P4"]
    data = json.loads(kerfwise("facts", tmp_path / "drawing.dxf", "-p", tmp_path / "plant.yaml").out)
    assert {key: data["contours"][0][key] for key in ("layer", "colour", "block")} == {
        "layer": "0", "colour": "red", "block": "HINGE_x4/HOLE",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("name", "quantity"),
    [("LV8_02049_50db_REV7", 50), ("plate 12pcs", 12), ("Winkel_3Stück", 3), ("деталь 7шт", 7), ("hinge x4", 4),
     ("SHEET_001_QTY_1", 1), ("M8x20", None), ("L200", None), ("4711", None)],
)  # fmt: skip
def test_the_quantity_in_the_name_of_a_file(tmp_path: Path, name: str, quantity: int | None) -> None:
    path = save_dxf(tmp_path, two_rows).rename(tmp_path / f"{name}.dxf")
    assert {part.attributes.get("quantity") for part in read_nest(path).parts} == {quantity}


def test_a_plant_has_a_pattern_of_its_own(tmp_path: Path) -> None:
    path = save_dxf(tmp_path, two_rows).rename(tmp_path / "7-off bracket.dxf")
    assert read_drawing(path, quantity=r"^(\d+)-off").parts[0].attributes == {"quantity": 7}
    (tmp_path / "p.yaml").write_text("drawing: {quantity: 'off'}\n")
    ended = kerfwise("profile", "check", tmp_path / "p.yaml")
    assert ended.code == 2
    assert "p.yaml:1:21: drawing.quantity: expected a regular expression with a group" in ended.err


def test_nests_in_json_say_the_same_of_their_parts(tmp_path: Path) -> None:
    nest = tmp_path / "a.json"
    parts = [
        {
            "id": f"P{k}",
            "layer": "AB"[k % 2],
            "colour": "red",
            "block": "X",
            "quantity": k + 1,
            "outer": square(40 + 140 * k, 50, 90),
        }
        for k in range(4)
    ]
    sheet = {"width": 900, "height": 200}
    nest.write_text(json.dumps({"format": "kerfwise-nest/1", "units": "mm", "sheet": sheet, "parts": parts}))
    rule = 'own_rules:\n  - {name: r, select: {layer: B, colour: red, block: X, quantity: "> 1"}, before: {layer: A}}\n'
    order, ended = solved(tmp_path, nest, rule)
    assert ended.code == 0, ended.err
    assert {*order[:2]} == {"P1", "P3"}


def test_svg_groups_are_layers_of_rules_too(tmp_path: Path) -> None:
    nest = tmp_path / "a.svg"
    rows = "".join(
        f'<g id="{"AB"[k % 2]}{k}" stroke="red"><rect x="{40 + 140 * k}" y="50" width="90" height="90"/></g>'
        for k in range(4)
    )
    nest.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="900mm" height="200mm" viewBox="0 0 900 200">{rows}</svg>'
    )
    rule = 'own_rules:\n  - {name: r, select: {layer: "B*", colour: red}, before: {layer: "A*"}}\n'
    order, ended = solved(tmp_path, nest, rule)
    assert ended.code == 0, ended.err
    assert {*order[:2]} == {"P2", "P4"}
