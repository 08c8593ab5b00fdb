"""One rectangle around everything: the sheet or a part is not guessed."""

from pathlib import Path
from typing import Any

import pytest

from kerfwise import InputError, Questions
from kerfwise.tests.encoder.readers.drawings import areas, lines, read_drawing, read_dxf, save_dxf, square, texts

ASKED = (
    "a rectangle of 200 × 200 mm is drawn around everything, at (0.000, 0.000) on layer '0', and no layer says whether "
    "it is the sheet or a part: what is it?"
)


def framed(space: Any, layer: str = "0") -> None:
    lines(space, square(0, 0, 200), layer)
    lines(space, square(50, 60, 20))


def asked(folder: Path, draw: Any, **options: Any) -> Any:
    with pytest.raises(Questions) as error:
        read_dxf(folder, draw, **options)
    [question] = error.value.questions
    return question


def test_it_is_asked_about_with_what_each_choice_gives(tmp_path: Path) -> None:
    question = asked(tmp_path, framed)
    assert (question.id, question.text) == ("frame", ASKED)
    assert [(choice.value, choice.gives) for choice in question.choices] == [
        ("part", "1 part, 1 hole (200 × 200 mm), sheet 220 × 220 mm assumed"),
        ("sheet", "1 part (20 × 20 mm), sheet 200 × 200 mm"),
    ]


def test_its_layer_is_named(tmp_path: Path) -> None:
    assert asked(tmp_path, lambda space: framed(space, "Rahmen")).text == ASKED.replace("'0'", "'Rahmen'")


def test_parts_with_holes_make_it_the_sheet_most_likely(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        framed(space)
        space.add_circle((60, 70), 5)

    assert [choice.value for choice in asked(tmp_path, draw).choices] == ["sheet", "part"]


def test_an_answer_is_taken(tmp_path: Path) -> None:
    assert areas(read_dxf(tmp_path, framed, answers=(("frame", "sheet"),))) == {"P1.outer": 400}
    assert areas(read_dxf(tmp_path, framed, answers=(("frame", "part"),))) == {"P1.outer": 40_000, "P1.hole1": 400}
    with pytest.raises(InputError, match="the answer frame=board is none of the choices: expected sheet, part"):
        read_dxf(tmp_path, framed, answers=(("frame", "board"),))


def test_it_is_what_the_options_say(tmp_path: Path) -> None:
    path = save_dxf(tmp_path, framed)
    nest = read_drawing(path, frame="sheet")
    assert (areas(nest), nest.sheet.bounds) == ({"P1.outer": 400}, (0, 0, 200, 200))
    assert texts(nest.notes) == [
        "the rectangle around everything, 200 × 200 mm, at (0.000, 0.000) on layer '0', is the sheet"
    ]
    assert areas(read_drawing(path, frame="part")) == {"P1.outer": 40_000, "P1.hole1": 400}


@pytest.mark.parametrize(
    ("size", "found"),
    [((200, 200), {"P1.outer": 400}), ((1000, 500), {"P1.outer": 40_000, "P1.hole1": 400})],
)
def test_the_size_of_the_sheet_may_make_it_plain(tmp_path: Path, size: tuple[float, float], found: Any) -> None:
    assert areas(read_dxf(tmp_path, framed, sheet_mm=size)) == found


def test_a_rectangle_a_little_smaller_than_the_sheet_may_be_its_margin(tmp_path: Path) -> None:
    assert asked(tmp_path, framed, sheet_mm=(220, 220)).text == ASKED


def test_a_frame_drawn_twice_is_one(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        framed(space)
        space.add_lwpolyline(square(0, 0, 200)[::-1], close=True)

    assert areas(read_dxf(tmp_path, draw, frame="sheet")) == {"P1.outer": 400}


@pytest.mark.parametrize("around", ["round", "beside", "alone"])
def test_what_is_no_frame_is_not_asked_about(tmp_path: Path, around: str) -> None:
    def draw(space: Any) -> None:
        if around == "round":
            space.add_circle((100, 100), 100)
        else:
            lines(space, square(0, 0, 200))
        if around == "beside":
            lines(space, square(210, 0, 20))
        elif around == "round":
            lines(space, square(50, 60, 20))

    assert "P1.outer" in areas(read_dxf(tmp_path, draw))


def test_rings_that_enclose_nothing_are_no_frame(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        space.add_lwpolyline([(0, 0), (50, 0)], close=True)
        space.add_lwpolyline([(0, 20), (50, 20)], close=True)

    with pytest.raises(InputError, match="encloses no area"):
        read_dxf(tmp_path, draw)


def test_a_rectangle_as_large_as_the_page_is_asked_about(tmp_path: Path) -> None:
    path = tmp_path / "page.svg"
    path.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="200mm" height="100mm" viewBox="0 0 200 100">'
        '<rect width="200" height="100"/><rect x="20" y="20" width="40" height="40"/></svg>'
    )
    with pytest.raises(Questions) as error:
        read_drawing(path)
    assert "as large as the page" in error.value.questions[0].text
    assert areas(read_drawing(path, answers=(("frame", "sheet"),))) == {"P1.outer": 1600}
