"""Texts, tables and pictures on sheets of A4: nothing is lost, and nothing stands beyond the margins."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.apps.work_sheets.paper import BOX, FOOT, HEIGHT, MARGIN, ROOM, WIDTH, Paper, broken, move_item, shortened
from kerfwise.postproc.report.plot import A4, fit_to_a4, pdf_bytes
from kerfwise.postproc.report.scene import Dot, Scene, SceneLayer, Shape, Style, TextLine, text_width
from kerfwise.tests.paper import pages_of

WORDS = st.text(st.characters(codec="utf-8", categories=("L", "N", "P")), min_size=1, max_size=40)


def texts(paper: Paper) -> list[list[TextLine]]:
    return [[item for item in scene.layers[0].items if isinstance(item, TextLine)] for scene in paper.scenes()]


def expect_inside(paper: Paper) -> None:
    for page in texts(paper):
        for text in page:
            wide = text_width(text.text, text.size, text.bold)
            left = {"start": text.x, "end": text.x - wide, "middle": text.x - wide / 2}[text.anchor]
            assert left >= MARGIN - 0.01, text
            assert left + wide <= WIDTH - MARGIN + 0.01, text
            assert MARGIN <= text.y + text.size / 2 <= HEIGHT, text


@given(st.lists(WORDS, max_size=12), st.floats(40, ROOM))
def test_broken_lines_fit_and_lose_no_letter(words: list[str], width: float) -> None:
    lines = broken(" ".join(words), 8.0, width)
    assert "".join("".join(lines).split()) == "".join("".join(words).split())
    assert all(text_width(line, 8.0) <= width for line in lines)


@given(WORDS, st.floats(10, 300))
def test_a_shortened_text_fits_and_begins_and_ends_alike(text: str, width: float) -> None:
    made = shortened(text, 7.5, width)
    assert text_width(made, 7.5) <= width or made == "…"
    head, _, tail = made.rpartition("…") if made != text and text.endswith(made.rpartition("…")[2]) else (text, "", "")
    assert made == text or (text.startswith(head) and text.endswith(tail) and abs(len(head) - len(tail)) <= 1)


@pytest.mark.parametrize("blocks", [1, 2, 3])
@pytest.mark.parametrize("count", [1, 2, 7, 130, 431])
def test_every_row_of_a_table_stands_once_in_reading_order(blocks: int, count: int) -> None:
    paper = Paper("a table")
    paper.heading("rows")
    paper.table(("", "number"), [(BOX, f"row {k}") for k in range(count)], blocks)
    paper.lines(["after it"])
    told = [text.text for page in texts(paper) for text in page if text.text.startswith("row ")]
    assert told == [f"row {k}" for k in range(count)]
    boxes = [
        item for scene in paper.scenes() for item in scene.layers[0].items if isinstance(item, Shape) and item.closed
    ]
    assert len(boxes) == count
    expect_inside(paper)


def test_no_name_and_no_number_of_a_long_table_is_cut_where_there_is_room() -> None:
    rows = [(BOX, f"Bracket-left-of-the-frame-{k:03d}-1", "120 × 80", f"{k / 7:.3g}") for k in range(120)]
    paper = Paper("parts")
    paper.table(("", "part", "size, mm", "kg"), rows, 3)
    told = [text.text for page in texts(paper) for text in page]
    assert not [text for text in told if "…" in text]
    assert {cell for row in rows for cell in row[1:]} <= set(told)
    expect_inside(paper)


def test_columns_in_which_nothing_stands_are_left_out_and_a_table_without_rows_is_none() -> None:
    paper = Paper("parts")
    paper.table(("", "part", "order", "kg"), [(BOX, "A", "", "1"), (BOX, "B", "", "2")])
    paper.table(("nothing",), [])
    told = [text.text for page in texts(paper) for text in page]
    assert told[:5] == ["part", "kg", "A", "1", "B"]
    assert not {"order", "nothing"} & set(told)


@given(st.lists(st.tuples(st.sampled_from(["lines", "heading", "table"]), WORDS, st.integers(1, 90)), max_size=8))
def test_pages_are_numbered_and_nothing_is_beyond_the_margins(blocks: list[tuple[str, str, int]]) -> None:
    paper = Paper("several things with a title that is long " * 5)
    for kind, word, count in blocks:
        if kind == "lines":
            paper.lines([word] * count, 8.0, BOX)
        elif kind == "heading":
            paper.heading("heading")
        else:
            paper.table(("a", "b"), [(word, str(k)) for k in range(count)], 2)
    pages = texts(paper)
    assert [page[-1].text for page in pages] == [f"page {k} of {len(pages)}" for k in range(1, len(pages) + 1)]
    expect_inside(paper)
    assert all(text.y <= HEIGHT - FOOT + 6 for page in pages for text in page[:-2])


def test_a_heading_is_not_left_at_the_foot() -> None:
    paper = Paper("t")
    paper.skip(paper.left_over - 25)
    paper.heading("cuts")
    assert len(paper.scenes()) == 2


def test_a_picture_larger_than_a_page_is_made_smaller() -> None:
    square = Shape(
        (np.array([(0.0, 0.0), (900.0, 0.0), (900.0, 3000.0), (0.0, 3000.0)]),), Style(stroke="#000000", width=2)
    )
    paper = Paper("t")
    paper.picture(Scene(900, 3000, (SceneLayer("a", (square,)),)))
    (drawn,) = (item for item in paper.scenes()[0].layers[0].items if isinstance(item, Shape))
    low, high = drawn.lines[0].min(axis=0), drawn.lines[0].max(axis=0)
    assert low[0] >= MARGIN
    assert high[0] <= WIDTH - MARGIN
    assert high[1] <= HEIGHT - FOOT
    assert drawn.style.width < 2


def test_what_is_moved_keeps_its_form() -> None:
    assert move_item(Dot(1, 2, 3, Style()), 10, 20, 2.0) == Dot(12, 24, 6, Style())
    assert move_item(TextLine(1, 2, "t", 8), 1, 1) == TextLine(2, 3, "t", 8)


SCENE = Scene(
    300, 200,
    (SceneLayer("a", (TextLine(150, 100, "Träger 7 $x$ <&>", 12), TextLine(20, 50, "12", 9, halo="#ffffff"),
                      Shape((np.array([(10.0, 10.0), (290.0, 10.0)]),), Style(stroke="#ff0000", width=1), False))),),
    "ü",
)  # fmt: skip


@pytest.mark.slow
def test_the_same_scene_gives_the_same_bytes_without_a_date() -> None:
    made = pdf_bytes([SCENE, SCENE], "two")
    assert made == pdf_bytes([SCENE, SCENE], "two")
    assert b"CreationDate" not in made
    assert made.count(b"/Type /Page\n") + made.count(b"/Type /Page ") == 2


def test_a_pdf_is_read_back() -> None:
    (page,) = pages_of(fit_to_a4(SCENE))
    assert page.size == pytest.approx(A4[::-1], abs=0.5)
    assert "Träger 7 $x$ <&>" in page.text
    left, _, right, _ = page.box("Träger")
    assert 0 < left < right < page.size[0]
    red, green, blue = np.moveaxis(page.picture(dpi=72).astype(int), -1, 0)
    assert ((red > 200) & (green < 100) & (blue < 100)).sum(axis=1).max() > page.size[0] / 2, "the red line is drawn"
