from pathlib import Path

import ezdxf
import pytest

from kerfwise import InputError
from kerfwise.tests.encoder.readers.drawings import read_drawing

LEVELS = 24


def blocks_of_two(file: Path, leaf: bool) -> None:
    document = ezdxf.new()
    block = document.blocks.new("level 0")
    if leaf:
        block.add_circle((0, 0), 1)
    for level in range(1, LEVELS + 1):
        block = document.blocks.new(f"level {level}")
        for x in (0, 3):
            block.add_blockref(f"level {level - 1}", (x, 0))
    document.modelspace().add_blockref(f"level {LEVELS}", (0, 0))
    document.saveas(file)


@pytest.mark.parametrize("leaf", [True, False])
def test_two_dozen_blocks_of_two_are_refused_at_once(tmp_path: Path, leaf: bool) -> None:
    file = tmp_path / "bomb.dxf"
    blocks_of_two(file, leaf)
    with pytest.raises(InputError, match=r"bomb\.dxf: the drawing unfolds to [\d,]{10} copies of") as refused:
        read_drawing(file)
    assert "\n" not in str(refused.value)


def test_rows_of_nothing_are_refused_too(tmp_path: Path) -> None:
    document = ezdxf.new()
    document.blocks.new("nothing")
    rows = {"row_count": 30_000, "column_count": 30_000, "row_spacing": 1, "column_spacing": 1}
    document.modelspace().add_blockref("nothing", (0, 0), dxfattribs=rows)
    document.saveas(tmp_path / "rows.dxf")
    with pytest.raises(InputError, match="unfolds to 900,000,000 copies"):
        read_drawing(tmp_path / "rows.dxf")


def test_clones_of_clones_are_refused_at_once(tmp_path: Path) -> None:
    groups = [f'<g id="u{k}"><use href="#u{k - 1}"/><use href="#u{k - 1}" x="2"/></g>' for k in range(1, LEVELS + 1)]
    body = f'<rect id="u0" width="5" height="5"/>{"".join(groups)}'
    file = tmp_path / "bomb.svg"
    file.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" width="9mm" height="9mm">{body}</svg>')
    with pytest.raises(InputError, match=r"unfolds to 134,217,624 copies of what its clones hold"):
        read_drawing(file)


def test_a_clone_that_contains_itself(tmp_path: Path) -> None:
    file = tmp_path / "snake.svg"
    file.write_text('<svg xmlns="http://www.w3.org/2000/svg"><g id="a"><use href="#a"/></g></svg>')
    with pytest.raises(InputError, match="a clone seems to contain itself"):
        read_drawing(file)
