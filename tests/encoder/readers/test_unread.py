"""What a DXF file holds beside lines: it is read around, and said."""

from pathlib import Path
from typing import Any

import pytest

from kerfwise import read_nest
from kerfwise.tests.encoder.readers.drawings import areas, lines, read_dxf, save_dxf, sheet, square, texts


def one_part(space: Any) -> None:
    sheet(space)
    lines(space, square(10, 10, 50))


def test_texts_are_counted_by_layer_with_the_first_of_them(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        one_part(space)
        for word in ("A-101", "A-102", "a line of writing that goes on and on", "A-104"):
            space.add_text(word, dxfattribs={"layer": "Gravur"})
        space.add_mtext("{\\fArial;20 mm}\\Pplate", dxfattribs={"layer": "0"})
        space.add_text("not told twice", dxfattribs={"layer": "DIM"})

    assert texts(read_dxf(tmp_path, draw).notes) == [
        "left out, as layer '0' is not for marks: 1 text ('20 mm plate'); --answer text:0=mark engraves it",
        "left out, as they are on no part: 4 texts on layer 'Gravur', the first the text 'A-101' at (0.000, 0.000) on "
        "layer 'Gravur'",
    ]


def test_the_writing_of_a_block_counts_too(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        one_part(space)
        block = space.doc.blocks.new("tag")
        block.add_text("fixed", dxfattribs={"layer": "Mark"})
        insert = space.add_blockref("tag", (20, 20))
        insert.add_attrib("NO", "4711", (20, 25), dxfattribs={"layer": "Mark"})

    nest = read_dxf(tmp_path, draw)
    assert nest.reading is not None
    assert [(w.text, w.at) for w in nest.reading.writings] == [("fixed", (20.0, 20.0)), ("4711", (20.0, 25.0))]


def disc(space: Any, **insert: Any) -> None:
    one_part(space)
    block = space.doc.blocks.new("disc")
    block.add_circle((0, 0), 5)
    block.add_lwpolyline([(-2, 0, 0, 0, 1), (2, 0, 0, 0, 1)], close=True)
    space.add_blockref("disc", (150, 150), dxfattribs=insert)


def in_a_block(space: Any, **insert: Any) -> None:
    """As `disc`, its insertion in another block."""
    disc(space.doc.blocks.new("outer"), **insert)
    space.add_blockref("outer", (0, 0))


def with_scales(folder: Path, x: str, y: str, z: str, draw: Any = disc) -> Path:
    """A file with scales that the library would not write."""
    path = save_dxf(folder, lambda space: draw(space, xscale=3, yscale=3, zscale=3, rotation=30))
    text = path.read_text()
    assert " 41\n3.0\n 42\n3.0\n 43\n3.0\n" in text
    path.write_text(text.replace(" 41\n3.0\n 42\n3.0\n 43\n3.0\n", f" 41\n{x}\n 42\n{y}\n 43\n{z}\n"))
    return path


@pytest.mark.parametrize("draw", [disc, in_a_block])
@pytest.mark.parametrize(("x", "y", "area"), [("3.0", "3.0", 706.858), ("2.0", "1.0", 157.08)])
def test_a_block_whose_height_is_scaled_by_0_is_flat(tmp_path: Path, x: str, y: str, area: float, draw: Any) -> None:
    nest = read_nest(with_scales(tmp_path, x, y, "0.0", draw))
    assert areas(nest)["P2.outer"] == pytest.approx(area, rel=1e-3)
    assert texts(nest.notes) == ["1 block is inserted with a height scale of 0: read as flat"]


@pytest.mark.parametrize("draw", [disc, in_a_block])
@pytest.mark.parametrize("x", ["0.0", "1e-12"])
def test_a_block_scaled_to_nothing_is_left_out(tmp_path: Path, x: str, draw: Any) -> None:
    nest = read_nest(with_scales(tmp_path, x, "3.0", "3.0", draw))
    assert areas(nest) == {"P1.outer": 2500}
    assert "1 INSERT of a block at scale 0" in texts(nest.notes)[0]


def with_entity(folder: Path, *tags: str) -> Path:
    """A file with one more entity, as raw tags."""
    path = save_dxf(folder, one_part)
    text = path.read_text()
    at = text.index("ENTITIES\n") + len("ENTITIES\n")
    path.write_text(text[:at] + "".join(f"{tag}\n" for tag in tags) + text[at:])
    return path


HEAD = ("  5", "ABCD", "330", "1F", "100", "AcDbEntity", "  8", "Extras")


@pytest.mark.parametrize(
    ("tags", "said"),
    [
        (("  0", "ACME_WELD", *HEAD, "100", "AcmeWeld", " 10", "1.0", " 20", "2.0"), "1 ACME_WELD"),
        (("  0", "ACAD_PROXY_ENTITY", *HEAD, "100", "AcDbProxyEntity", " 90", "498"), "1 ACAD_PROXY_ENTITY"),
        (("  0", "REGION", *HEAD, "100", "AcDbModelerGeometry"), "1 REGION"),
        (
            ("  0", "INSERT", *HEAD, "100", "AcDbBlockReference", "  2", "gone", " 10", "0.0", " 20", "0.0"),
            "1 INSERT of a block that the file does not hold",
        ),
    ],
)
def test_what_nobody_knows_is_read_around(tmp_path: Path, tags: tuple[str, ...], said: str) -> None:
    nest = read_nest(with_entity(tmp_path, *tags))
    assert areas(nest) == {"P1.outer": 2500}
    assert texts(nest.notes) == [
        f"left out, as they are not lines one can cut: {said}; explode them in CAD if they are to be cut"
    ]


def test_an_unknown_entity_in_a_block_is_counted(tmp_path: Path) -> None:
    path = save_dxf(tmp_path, disc)
    text = path.read_text()
    at = text.index("  0\nCIRCLE\n")
    weld = "".join(f"{tag}\n" for tag in ("  0", "ACME_WELD", *HEAD, "100", "AcmeWeld", " 10", "1.0", " 20", "2.0"))
    path.write_text(text[:at] + weld + text[at:])
    nest = read_nest(path)
    assert len(nest.parts) == 2
    assert "1 ACME_WELD" in texts(nest.notes)[0]
