"""The published schema is the one that lists are read by; what it takes and refuses is what the reader does."""

from __future__ import annotations

import json
from dataclasses import replace
from importlib import resources
from pathlib import Path

import ezdxf
import jsonschema
import pytest
import yaml

import kerfwise
from kerfwise import InputError, Nest, load_profile
from kerfwise.apps.nesting.part_list import list_of, list_schema, schema_text
from kerfwise.apps.nesting.placement.layout import nest_dxf
from kerfwise.apps.nesting.placement.nofit import Placed, Pose
from kerfwise.encoder.bevels.bevel import Bevel
from kerfwise.encoder.readers import read_nest
from kerfwise.encoder.readers.json_nest import nest_json
from kerfwise.rule_kit import Sheet
from kerfwise.tests.commands.run_cli import kerfwise as run
from kerfwise.tests.commands.test_bevels import HEAD, PLANT, write

VALIDATOR = jsonschema.Draft202012Validator(list_schema())
DAY = Path(kerfwise.__file__).parent / "examples" / "parts" / "day.yaml"


def test_the_published_schema_is_the_one_that_lists_are_read_by() -> None:
    published = resources.files("kerfwise.apps.nesting") / "parts.schema.json"
    assert published.read_text(encoding="utf-8") == schema_text(), "run python -m kerfwise.apps.nesting.part_list"
    assert run("nest", "--schema").out == schema_text()


@pytest.mark.parametrize(
    ("text", "fine"),
    [
        (DAY.read_text(encoding="utf-8"), True),
        ("parts: [{part: a.dxf, rotations: any, grain: along}]", True),
        ("parts: [{part: a.dxf, rotations: 45}]\nsheets: [{size: 300x200, stock: 2}]", True),
        ("parts: [{quantity: 3}]", False),
        ("parts: [{part: a.dxf, quantity: 0}]", False),
        ("parts: [{part: a.dxf, colour: red}]", False),
        ("parts: [{part: a.dxf}]\nsheets: [{size: 300x200, file: a.json}]", False),
        ("sheets: [{size: 300x200}]", False),
    ],
)
def test_schema_and_reader_agree(text: str, fine: bool) -> None:
    assert VALIDATOR.is_valid(yaml.safe_load(text)) == fine
    if fine:
        assert list_of(text, "day.yaml").parts
    else:
        with pytest.raises(InputError):
            list_of(text, "day.yaml")


def test_a_drawing_has_bevels_on_single_edges(tmp_path: Path) -> None:
    drawing = ezdxf.new()
    drawing.header["$INSUNITS"] = 4
    space = drawing.modelspace()
    corners = [(100, 100), (220, 100), (220, 180), (100, 180)]
    layers = ["V45", "0", "0", "0"]
    for k, layer in enumerate(layers):
        space.add_line(corners[k], corners[(k + 1) % 4], dxfattribs={"layer": layer, "color": 1 if k == 2 else 256})
    for k in range(4):  # all of one layer: the whole contour
        space.add_line(*[(x + 200, y) for x, y in (corners[k], corners[(k + 1) % 4])], dxfattribs={"layer": "V45"})
    drawing.saveas(tmp_path / "plate.dxf")
    (tmp_path / "plant.yaml").write_text(
        PLANT.format("plasma-carbon-steel")
        + "drawing: {layers: {bevel: {'^V45$': V 45 bottom, red: Y 30 land 4}}}\ncuts: {bevel: {}}\n"
    )
    options = load_profile(tmp_path / "plant.yaml").read_options()
    nest = read_nest(tmp_path / "plate.dxf", options)
    found = {
        c.id: {s.start: str(b) for s, b in zip(c.curve.segments, c.bevel_of_edge, strict=True) if b}
        for c in nest.contours
    }
    assert {tuple(map(round, at)) for at in found["P1.outer"]} == {(100, 100), (220, 180)}
    assert sorted(found["P1.outer"].values()) == ["V 45 bottom", "Y 30 land 4 top"]
    assert str(nest.contours[1].bevel) == "V 45 bottom"
    # written again edge by edge, and as JSON by number
    (tmp_path / "again.dxf").write_text(nest_dxf(nest))
    mapped = {"BEVEL_V_45_BOTTOM": "V 45 bottom", "BEVEL_Y_30": "Y 30 land 4"}
    again = read_nest(
        tmp_path / "again.dxf", replace(options, bevels=tuple((k, Bevel.parse(v)) for k, v in mapped.items()))
    )
    assert [c.bevel_of_edge for c in again.contours] == [c.bevel_of_edge for c in nest.contours]
    told = json.loads(nest_json(nest))["parts"][0]["bevel"]
    assert [(row["kind"], row["edges"]) for row in told] == [("V", [1]), ("Y", [3])]
    (tmp_path / "again.json").write_text(nest_json(nest))
    assert read_nest(tmp_path / "again.json").contours[0].bevel_of_edge == nest.contours[0].bevel_of_edge
    over = Placed(0, Pose(0.0, True), 0.0, 0.0).part(nest.parts[0], "M").outer
    assert [str(b) for b in over.bevel_of_edge if b] == ["V 45 top", "Y 30 land 4 bottom"]


def test_parts_of_a_list_keep_their_bevels_turned_over_where_they_are(tmp_path: Path) -> None:
    nest, _ = write(tmp_path, {"kind": "V", "angle": 30}, HEAD)
    part = read_nest(nest).parts[0]
    over = Placed(0, Pose(0.0, True), 0.0, 0.0).part(part, "M")
    assert str(over.outer.bevel) == "V 30 bottom"
    told = json.loads(nest_json(Nest(Sheet.rectangle(400, 300), (over,))))
    assert told["parts"][0]["bevel"] == [{"of": "outer", "kind": "V", "angle": 30, "side": "bottom"}]
    assert "BEVEL_V_30_BOTTOM" in nest_dxf(Nest(Sheet.rectangle(400, 300), (over,)))
