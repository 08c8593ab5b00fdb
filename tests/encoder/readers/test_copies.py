from pathlib import Path

import ezdxf
import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.readers import read_nest
from kerfwise.encoder.readers.drawing import DEEPEST, MOST_COPIES, check_copies

LEVELS = 24


def test_as_many_copies_as_may_be_and_one_more() -> None:
    def drawing(copies: int) -> None:
        check_copies("sheet", {"sheet": (7, [("part", copies // 2)]), "part": (1, [])}.__getitem__, "block")

    drawing(MOST_COPIES)
    with pytest.raises(InputError, match=f"unfolds to {MOST_COPIES + 2:,} copies"):
        drawing(MOST_COPIES + 2)


def test_blocks_within_blocks_are_counted_once_however_often_they_are_used() -> None:
    asked = []

    def made_of(level: int) -> tuple[int, list[tuple[int, int]]]:
        asked.append(level)
        return 1, [(level + 1, 1), (level + 1, 1)] if level < LEVELS else []

    with pytest.raises(InputError, match=f"unfolds to {2 ** (LEVELS + 2) - 4:,} copies"):
        check_copies(0, made_of, "block")
    assert len(asked) <= LEVELS + 2


def test_a_block_that_contains_itself() -> None:
    with pytest.raises(InputError, match=f"over {DEEPEST} deep: a block seems to contain itself"):
        check_copies("a", {"a": (0, [("b", 2)]), "b": (0, [("a", 2)])}.__getitem__, "block")


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
        read_nest(file)
    assert "\n" not in str(refused.value)


def test_rows_of_nothing_are_refused_too(tmp_path: Path) -> None:
    document = ezdxf.new()
    document.blocks.new("nothing")
    rows = {"row_count": 30_000, "column_count": 30_000, "row_spacing": 1, "column_spacing": 1}
    document.modelspace().add_blockref("nothing", (0, 0), dxfattribs=rows)
    document.saveas(tmp_path / "rows.dxf")
    with pytest.raises(InputError, match="unfolds to 900,000,000 copies"):
        read_nest(tmp_path / "rows.dxf")


def test_clones_of_clones_are_refused_at_once(tmp_path: Path) -> None:
    groups = [f'<g id="u{k}"><use href="#u{k - 1}"/><use href="#u{k - 1}" x="2"/></g>' for k in range(1, LEVELS + 1)]
    body = f'<rect id="u0" width="5" height="5"/>{"".join(groups)}'
    file = tmp_path / "bomb.svg"
    file.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" width="9mm" height="9mm">{body}</svg>')
    with pytest.raises(InputError, match=r"unfolds to 134,217,624 copies of what its clones hold"):
        read_nest(file)


def test_a_clone_that_contains_itself(tmp_path: Path) -> None:
    file = tmp_path / "snake.svg"
    file.write_text('<svg xmlns="http://www.w3.org/2000/svg"><g id="a"><use href="#a"/></g></svg>')
    with pytest.raises(InputError, match="a clone seems to contain itself"):
        read_nest(file)
