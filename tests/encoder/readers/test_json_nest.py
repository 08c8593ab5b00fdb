import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from kerfwise import InputError, Nest
from kerfwise.tests.encoder.readers.drawings import areas, read_drawing, texts

Document = dict[str, Any]


def document() -> Document:
    return {
        "format": "kerfwise-nest/1",
        "units": "mm",
        "sheet": {"width": 100, "height": 50},
        "parts": [
            {
                "id": "P1",
                "outer": [[5, 5], [45, 5], [45, 45], [5, 45]],
                "holes": [[[10, 10], [20, 10], [20, 20]]],
                "marks": [[[30, 30], [40, 30]], [[30, 35], [40, 35], [40, 40], [30, 35]]],
                "priority": 3,
                "order": {"customer": "A"},
            },
            {"id": "P2", "outer": [[60, 20, 1], [80, 20, 1]]},
        ],
    }


def read(folder: Path, given: object, **options: Any) -> Nest:
    path = folder / "nest.json"
    path.write_text(given if isinstance(given, str) else json.dumps(given, indent=1), encoding="utf-8")
    return read_drawing(path, **options)


def test_everything_of_the_format(tmp_path: Path) -> None:
    nest = read(tmp_path, document())
    assert [c.id for c in nest.contours] == ["P1.mark1", "P1.mark2", "P1.hole1", "P1.outer", "P2.outer"]
    assert [c.curve.closed for c in nest.contours] == [False, True, True, True, True]
    assert areas(nest) == {"P1.hole1": 50, "P1.outer": 1600, "P2.outer": 314.159}
    assert nest.part_of["P1"].attributes == {"priority": 3, "order": {"customer": "A"}}
    assert nest.sheet.bounds == (0, 0, 100, 50)
    assert nest.notes == ()


def test_a_remnant_with_a_hole(tmp_path: Path) -> None:
    given = document()
    given["sheet"] = {"outline": [[0, 0], [120, 0], [120, 60], [0, 50]], "holes": [[[90, 10], [110, 10], [100, 20]]]}
    assert read(tmp_path, given).sheet.polygon.area == 120 * 55 - 100


def test_a_closed_ring_may_repeat_its_first_vertex(tmp_path: Path) -> None:
    given = document()
    given["parts"][0]["outer"].append([5, 5])
    assert len(read(tmp_path, given).contour("P1.outer").curve.vertices) == 4


@pytest.mark.parametrize(("units", "options", "factor"), [("in", {}, 25.4), ("mm", {"units": "cm"}, 10)])
def test_units(tmp_path: Path, units: str, options: dict[str, str], factor: float) -> None:
    nest = read(tmp_path, document() | {"units": units}, **options)
    assert nest.sheet.bounds[2] == pytest.approx(100 * factor)
    assert nest.contour("P2.outer").curve.vertices[:, 2].tolist() == [1, 1]


def test_a_sheet_too_small_to_be_one_is_doubted(tmp_path: Path) -> None:
    text = json.dumps(document()).replace("100", "10.0").replace("50}", "5}")
    given = json.loads(text)
    given["parts"] = [{"id": "A", "outer": [[1, 1], [4, 1], [4, 4]]}]
    assert texts(read(tmp_path, given).notes)[0].startswith("the sheet is 10 × 5 mm, too small to be one")


def test_keys_that_nothing_reads_are_told(tmp_path: Path) -> None:
    given = document() | {"author": "A"}
    given["sheet"]["grade"] = "S235"
    given["parts"][0]["customer"] = "B"
    told = ["nothing reads the key 'author' of the file", "nothing reads the key 'grade' of the sheet"]
    assert texts(read(tmp_path, given).notes) == told


@pytest.mark.parametrize("key", ["rotation", "X", "qty", "circles", "units", "mirrored", "rotation_deg", "scale-x"])
def test_a_part_is_not_placed_or_repeated_by_attributes_which_is_told(tmp_path: Path, key: str) -> None:
    given = document()
    given["parts"][0] |= {key: [{"x": 4, "y": 4, "r": 1}] if key == "circles" else 90}
    told = (
        f"of parts, '{key}' (1) are attributes for rules alone: vertices say what is cut and where, quantity how many"
    )
    assert [text.startswith(told) for text in texts(read(tmp_path, given).notes)] == [True]


def put(*path: str | int, value: object) -> Callable[[Document], None]:
    def change(given: Any) -> None:
        for step in path[:-1]:
            given = given[step]
        given[path[-1]] = value

    return change


def drop(*path: str | int) -> Callable[[Document], None]:
    def change(given: Any) -> None:
        for step in path[:-1]:
            given = given[step]
        del given[path[-1]]

    return change


RING = [[1, 1], [2, 1], [2, 2]]
REFUSED = "not a kerfwise-nest/1 file: "


@pytest.mark.parametrize(
    ("change", "said", "line"),
    [
        (put("format", value="nest/9"), "format: \"nest/9\" given, expected 'kerfwise-nest/1'", 2),
        (drop("format"), "the file: 'format' missing", 1),
        (put("units", value="px"), 'units: "px" given, expected one of mm, cm, m, in, ft', 3),
        (drop("sheet"), "the file: 'sheet' missing", 1),
        (put("sheet", value={}), "the sheet: expected either 'width' and 'height', or 'outline'", 4),
        (put("sheet", "width", value=0), "the sheet, width: 0 given, expected over 0", 5),
        (put("sheet", "height", value="50"), 'the sheet, height: "50" given, expected a number', 6),
        (put("parts", value={}), "parts: an object given, expected a list", 8),
        (drop("parts", 1, "id"), "part number 2: 'id' missing", 80),
        (put("parts", 1, "id", value=""), "part number 2, id: nothing in it", 81),
        (drop("parts", 0, "outer"), "part 'P1': 'outer' missing", 9),
        (put("parts", 0, "outer", value=[[1, 1]]), "part 'P1', outer: a list of 1 given, expected at least 2", 11),
        (
            put("parts", 0, "outer", 1, value=[1, 2, 3, 4]),
            "part 'P1', outer, vertex 2: a list of 4 given, expected at most 3",
            16,
        ),
        (
            put("parts", 0, "holes", 0, 2, 1, value=None),
            "part 'P1', hole 1, vertex 3, y: null given, expected a number",
            41,
        ),
        (
            put("parts", 0, "holes", 0, 2, 1, value=True),
            "part 'P1', hole 1, vertex 3, y: true given, expected a number",
            41,
        ),
        (put("parts", 0, "marks", 1, 0, 0, value=float("nan")), "part 'P1', mark 2, vertex 1, x: \"NaN\" given", 58),
        (put("unit", value="in"), "unit: unknown key, did you mean 'units'?", 96),
        (put("Sheet", value={}), "Sheet: unknown key, did you mean 'sheet'?", 96),
        (put("scarp", value=[]), "scarp: unknown key, did you mean 'scrap'?", 96),
        (put("sheet", "widht", value=4), "the sheet, widht: unknown key, did you mean 'width'?", 7),
        (put("sheet", "hole", value=[RING]), "the sheet, hole: unknown key, did you mean 'holes'?", 7),
        (put("parts", 1, "hole", value=[RING]), "part 'P2', hole: unknown key, did you mean 'holes'?", 94),
        (put("parts", 1, "Marks", value=[]), "part 'P2', Marks: unknown key, did you mean 'marks'?", 94),
        (put("parts", 1, "colur", value="red"), "part 'P2', colur: unknown key, did you mean 'colour'?", 94),
        (put("parts", 1, "inside", value=[RING]), "part 'P2', inside: unknown key of what looks like contours", 94),
        (put("parts", 1, "shape", value=RING), "part 'P2', shape: unknown key of what looks like contours", 94),
        (put("parts", 1, "priority", value=-1), "part 'P2', priority: -1 given, expected at least 0", 94),
        (put("parts", 1, "priority", value="high"), "part 'P2', priority: \"high\" given, expected a number", 94),
        (put("parts", 1, "quantity", value=1.5), "part 'P2', quantity: 1.5 given, expected a whole number", 94),
        (put("parts", 1, "quantity", value=0), "part 'P2', quantity: 0 given, expected at least 1", 94),
        (put("parts", 1, "thickness", value=-3), "part 'P2', thickness: -3 given, expected over 0", 94),
        (put("parts", 1, "due", value="24.12.2026"), "part 'P2', due: \"24.12.2026\" given, expected a day as 20", 94),
        (put("parts", 1, "layer", value=5), "part 'P2', layer: 5 given, expected a text", 94),
        (put("parts", 1, "order", value=float("nan")), "part 'P2', order: NaN given, expected a number", 94),
        (put("parts", 1, "lot", value={"kg": [float("inf")]}), "part 'P2', lot: Infinity given, expected a num", 94),
        (
            put("parts", 1, "tabs", value=[{"at": [70, 10], "widht": 1}]),
            "part 'P2', tab 1: unknown key 'widht': did you mean 'width'?",
            100,
        ),
        (
            put("parts", 1, "outer", 0, 2, value=2e6),
            "part 'P2', outer, vertex 1, bulge: 2000000.0 given, expected at most",
            86,
        ),
    ],
)
def test_a_mistake_is_placed(tmp_path: Path, change: Callable[[Document], None], said: str, line: int) -> None:
    given = document()
    change(given)
    with pytest.raises(InputError) as error:
        read(tmp_path, given)
    assert error.value.message.startswith(REFUSED + said)
    assert error.value.line == line
    assert error.value.file == tmp_path / "nest.json"


def test_several_mistakes_are_one_error_in_the_order_of_the_file(tmp_path: Path) -> None:
    given = document()
    given["parts"][1]["outer"][0] = ["a", "b"]
    given["units"] = 7
    with pytest.raises(InputError) as error:
        read(tmp_path, given)
    assert error.value.details == (
        "units (line 3): 7 given, expected one of mm, cm, m, in, ft",
        "part 'P2', outer, vertex 1, x (line 84): \"a\" given, expected a number",
        "part 'P2', outer, vertex 1, y (line 85): \"b\" given, expected a number",
    )
    assert error.value.line == 3


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('{"format": ', "not JSON: Expecting value"),
        ("[]", "the file: [] given, expected an object"),
        ("null", "the file: null given, expected an object"),
        ("[" * 100_000, "not a nest: "),
        (json.dumps(document()).replace("45", "9" * 5000), "not a nest: "),
        (json.dumps(document()).replace("45", "1e999"), "not a kerfwise-nest/1 file"),
    ],
)
def test_what_is_no_nest(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(InputError) as error:
        read(tmp_path, text)
    assert said in error.value.message


def test_bytes_that_are_no_text(tmp_path: Path) -> None:
    path = tmp_path / "nest.json"
    path.write_bytes(b'{"format": "\xff\xfe"}')
    with pytest.raises(InputError, match=r"not JSON: the file is not UTF-8 text \(byte 13: invalid start byte"):
        read_drawing(path)
    text = json.dumps(document())
    path.write_bytes(text.encode("utf-16"))
    with pytest.raises(InputError, match=r"\(it is UTF-16: save it as UTF-8\)"):
        read_drawing(path)
    path.write_bytes(text.encode())
    assert read_drawing(path).contours


def test_a_byte_order_mark_is_no_mistake(tmp_path: Path) -> None:
    path = tmp_path / "nest.json"
    path.write_bytes(b"\xef\xbb\xbf" + json.dumps(document()).encode())
    assert len(read_drawing(path).parts) == 2


def test_two_parts_of_one_name(tmp_path: Path) -> None:
    given = document()
    given["parts"][1]["id"] = "P1"
    with pytest.raises(InputError, match="part number 2 has the id 'P1' of part number 1") as error:
        read(tmp_path, given)
    assert error.value.line == 81


def test_a_ring_of_two_vertices_encloses_nothing(tmp_path: Path) -> None:
    given = document()
    given["parts"][1]["outer"] = [[60, 20], [80, 20]]
    with pytest.raises(InputError) as error:
        read(tmp_path, given)
    assert error.value.details == (
        "P2.outer encloses no area, at (60.000, 20.000): remove it, or try --repair (in Python: repair=True), which "
        "removes it",
    )
    assert [c.part for c in read(tmp_path, given, repair=True).contours] == ["P1"] * 4


def test_an_arc_wider_than_the_world_names_its_contour(tmp_path: Path) -> None:
    given = document()
    given["parts"][1]["outer"][0][2] = 1e6
    with pytest.raises(InputError, match=r"P2\.outer: an arc of bulge 1e\+06 is wider than a kilometre$"):
        read(tmp_path, given)
