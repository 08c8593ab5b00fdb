"""Texts, tables and pictures on sheets of A4: nothing is lost, and nothing stands beyond the margins."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import segno
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.apps.work_sheets.paper import BOX, FOOT, HEIGHT, MARGIN, ROOM, WIDTH, Paper, broken, move_item, shortened
from kerfwise.postproc.report.plot import A4, fit_to_a4, pdf_bytes
from kerfwise.postproc.report.scene import Dot, Scene, SceneLayer, Shape, Style, TextLine, text_width
from kerfwise.rule_kit import rect
from kerfwise.tests.apps.work_sheets.test_sheet import plan, solved  # noqa: F401 - fixtures
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.nest_file import nest_file
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


@pytest.mark.full
@pytest.mark.slow
def test_many_cuts_go_on_to_more_pages_and_every_number_can_be_read() -> None:
    small = [{"id": f"P{k}", "outer": rect(20 + 60 * (k % 15), 20 + 60 * (k // 15), 50, 50)} for k in range(75)]
    nest_file("many.json", small, (940, 340))
    Path("loose.yaml").write_text("based_on: plasma-carbon-steel\nrules: {part-rigidity: off, level-ahead: off}\n")
    ended = kerfwise("solve", "many.json", "-p", "loose.yaml", "--work", 0.05, "-o", "m.nc", "--plan", "m.plan.json")
    assert ended.code == 0, ended.err
    assert kerfwise("sheet", "many.json", "m.plan.json", "-p", "loose.yaml", "-o", "m.pdf").code == 0
    pages = pages_of("m.pdf")
    assert len(pages) <= 3
    rows = re.findall(r"\S+\.outer", "".join(page.text for page in pages).partition("in order")[2])
    assert len(rows) == len(set(rows)) == 75

    from kerfwise import read_nest, read_plan
    from kerfwise.apps.work_sheets.paper import ROOM
    from kerfwise.postproc.report.picture import bare_picture
    from kerfwise.postproc.report.scene import TextLine

    drawn = bare_picture(read_nest("many.json"), read_plan("m.plan.json"), (0.0, 0.0), ROOM, 470.0)
    numbers = [item for item in drawn.layer("numbers") if isinstance(item, TextLine)]
    assert sorted(int(item.text) for item in numbers) == list(range(1, 76))
    assert min(item.size for item in numbers) >= 5.0
    assert all(0 <= item.x <= drawn.width and 0 <= item.y <= drawn.height for item in numbers)


def test_several_nests_make_one_paper(plan: Path) -> None:  # noqa: F811 - a fixture
    from kerfwise import read_plan
    from kerfwise.apps.work_sheets.work_sheet import sheets_pdf, work_sheet
    from kerfwise.jobs.nest_job.request import NestRequest, inputs_for

    one = work_sheet(inputs_for("sheet.json", NestRequest()), read_plan(plan))
    Path("both.pdf").write_bytes(sheets_pdf([one, one], "today"))
    texts = [page.text for page in pages_of("both.pdf")]
    assert len(texts) == 2
    assert all("page 1 of 1" in text and "today" in text for text in texts)


def test_the_bars_cover_the_dark_squares_and_no_others() -> None:
    from kerfwise.apps.work_sheets.paper import qr_items

    text, size = "SHA256 " + "0123456789ABCDEF" * 4, 78.0
    matrix = np.array(segno.make_qr(text, error="m").matrix, dtype=bool)
    drawn = np.zeros_like(matrix)
    (shape,) = qr_items(text, 10.0, 20.0, size)
    assert isinstance(shape, Shape)
    module = size / len(matrix)
    for bar in shape.lines:
        (x0, y0), (x1, y1) = bar.min(axis=0), bar.max(axis=0)
        columns = slice(round((x0 - 10) / module), round((x1 - 10) / module))
        rows = slice(round((y0 - 20) / module), round((y1 - 20) / module))
        assert not drawn[rows, columns].any()
        drawn[rows, columns] = True
    assert np.array_equal(drawn, matrix)
