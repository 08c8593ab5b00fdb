import math
from pathlib import Path

import pytest

from kerfwise import InputError, Nest, Questions
from kerfwise.tests.encoder.readers.drawings import areas, read_drawing, texts

NAMESPACES = 'xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
PAGE = 'width="200mm" height="100mm" viewBox="0 0 400 200"'
SHEET = '<g inkscape:label="Sheet"><rect width="400" height="200"/></g>'


def read(folder: Path, body: str, page: str = PAGE, **options: object) -> Nest:
    path = folder / "drawing.svg"
    path.write_text(f"<svg {NAMESPACES} {page}>{body}</svg>", encoding="utf-8")
    return read_drawing(path, **options)  # type: ignore[arg-type]


def test_sheet_marks_and_cuts_by_group(tmp_path: Path) -> None:
    body = f"""{SHEET}<g inkscape:label="cut"><rect x="20" y="20" width="100" height="80"/>
    <circle cx="50" cy="50" r="20"/></g><g id="Engraving"><line x1="80" y1="80" x2="100" y2="80"/></g>"""
    nest = read(tmp_path, body)
    assert nest.sheet.bounds == (0, 0, 200, 100)
    assert areas(nest) == {"P1.outer": 2000, "P1.hole1": round(math.pi * 100, 3)}
    assert [c.id for c in nest.contours] == ["P1.mark1", "P1.hole1", "P1.outer"]
    assert nest.notes == ()


def test_y_points_up(tmp_path: Path) -> None:
    nest = read(tmp_path, SHEET + '<rect x="20" y="20" width="100" height="80"/>')
    assert nest.contour("P1.outer").polygon.bounds == (10, 50, 60, 90)


def test_arcs_turn_the_way_they_are_drawn(tmp_path: Path) -> None:
    # a D with its round side to the right: the sweep flag is clockwise on the page, so clockwise with y up
    nest = read(tmp_path, SHEET + '<path d="M100 50 A 40 40 0 0 1 100 130 Z"/>')
    curve = nest.contour("P1.outer").curve
    assert nest.contour("P1.outer").polygon.bounds == pytest.approx((50, 35, 70, 75), abs=0.02)
    assert not curve.is_ccw
    assert [s.is_arc for s in curve.segments] == [True, False]
    assert abs(curve.signed_area_mm2) == pytest.approx(math.pi * 200)


def test_an_arc_over_a_half_circle_is_halved(tmp_path: Path) -> None:
    nest = read(tmp_path, SHEET + '<path d="M100 60 A 40 40 0 1 1 60 100 L 100 100 Z"/>')
    curve = nest.contour("P1.outer").curve
    assert [s.is_arc for s in curve.segments] == [True, True, False, False]
    assert abs(curve.signed_area_mm2) == pytest.approx(0.75 * math.pi * 400)


@pytest.mark.parametrize(
    ("transform", "factor"),
    [("rotate(30)", 1), ("scale(2)", 4), ("scale(-1 1)", 1), ("matrix(0 2 -2 0 10 0)", 4), ("translate(3 4)", 1)],
)
def test_circles_stay_circles_when_turned_scaled_and_mirrored(tmp_path: Path, transform: str, factor: float) -> None:
    body = f'<g transform="translate(200 100)"><circle transform="{transform}" r="20"/></g>'
    curve = read(tmp_path, SHEET + body).contour("P1.outer").curve
    assert len(curve.segments) == 4
    assert all(s.is_arc for s in curve.segments)
    assert abs(curve.signed_area_mm2) == pytest.approx(factor * math.pi * 100)


def test_a_circle_stretched_is_an_ellipse_of_few_arcs(tmp_path: Path) -> None:
    curve = read(tmp_path, SHEET + '<circle cx="100" cy="50" r="20" transform="scale(2 1)"/>').contours[0].curve
    assert abs(curve.signed_area_mm2) == pytest.approx(math.pi * 20 * 10, rel=1e-3)
    assert 4 < len(curve.segments) < 40


def test_beziers_stay_within_a_hundredth(tmp_path: Path) -> None:
    curve = read(tmp_path, SHEET + '<path d="M 20 100 C 20 20 380 20 380 100 Q 200 190 20 100"/>').contours[0].curve
    for t in (k / 97 for k in range(98)):
        x = 20 * (1 - t) ** 3 + 3 * 20 * t * (1 - t) ** 2 + 3 * 380 * t**2 * (1 - t) + 380 * t**3
        y = 100 * (1 - t) ** 3 + 3 * 20 * t * (1 - t) ** 2 + 3 * 20 * t**2 * (1 - t) + 100 * t**3
        assert curve.project((x / 2, 100 - y / 2))[1] <= 0.0101
    assert len(curve.segments) < 60


def test_polygons_rounded_rectangles_and_clones(tmp_path: Path) -> None:
    body = """<polygon points="20,20 60,20 60,60"/><rect x="100" y="20" width="60" height="40" rx="10"/>
    <defs><rect id="tile" width="40" height="40"/></defs><use href="#tile" x="200" y="20"/>
    <path d="M 300 20 h 60 v 60 h -60 z m 10 10 h 20 v 20 h -20 z"/>"""
    found = areas(read(tmp_path, SHEET + body))
    rounded = round((60 * 40 - 400 + math.pi * 100) / 4, 3)
    assert found == {"P1.outer": 200, "P2.outer": rounded, "P3.outer": 400, "P4.outer": 900, "P4.hole1": 100}


def test_loose_lines_join(tmp_path: Path) -> None:
    body = '<line x1="20" y1="20" x2="60" y2="20"/><polyline points="60,20 60,60 20,20"/>'
    assert areas(read(tmp_path, SHEET + body)) == {"P1.outer": 200}


def test_hidden_shapes_writing_and_patterns_are_passed_over(tmp_path: Path) -> None:
    body = """<rect x="20" y="20" width="40" height="40"/><text x="5" y="5">A</text>
    <g style="display:none"><rect x="100" width="40" height="40"/></g>
    <rect x="200" width="40" height="40" visibility="hidden"/>
    <clipPath id="c"><rect x="300" width="40" height="40"/></clipPath>
    <mask id="m"><rect x="310" width="4" height="4"/></mask><pattern id="p"><circle cx="320" r="4"/></pattern>
    <marker id="a"><path d="M0 0 5 0 0 5z"/></marker>"""
    assert list(areas(read(tmp_path, SHEET + body))) == ["P1.outer"]


@pytest.mark.parametrize(
    ("page", "options", "side"),
    [
        ('width="400mm" height="200mm" viewBox="0 0 400 200"', {}, 40),
        ('width="40cm" height="20cm" viewBox="0 0 400 200"', {}, 40),
        ('width="400" height="200"', {"units": "px"}, 40 * 25.4 / 96),
        ('width="400" height="200"', {"answers": (("units", "pt"),)}, 40 * 25.4 / 72),
        ('viewBox="0 0 400 200"', {"units": "90dpi"}, 40 * 25.4 / 90),
        ('width="400mm" height="200mm"', {}, 40 * 25.4 / 96),
        ('inkscape:version="0.48.5 r10040" width="400" height="200"', {}, 40 * 25.4 / 90),
        ('inkscape:version="0.92.3" width="400" height="200"', {}, 40 * 25.4 / 96),
        ('width="4in" height="2in" viewBox="0 0 400 200"', {}, 40 * 25.4 / 100),
        ('viewBox="0 0 400 200"', {"units": "mm"}, 40),
        ('width="400" height="200" viewBox="0 0 400 200"', {"units": "cm"}, 400),
        ('width="7mm" height="3.5mm" viewBox="0 0 400 200"', {"units": "mm"}, 40),
        ("", {"units": "in"}, 1016),
    ],
)
def test_units_come_from_the_page_or_the_reader(
    tmp_path: Path, page: str, options: dict[str, object], side: float
) -> None:
    nest = read(tmp_path, SHEET + '<rect x="20" y="20" width="40" height="40"/>', page, **options)
    x0, y0, x1, y1 = nest.contour("P1.outer").polygon.bounds
    assert (x1 - x0, y1 - y0) == pytest.approx((side, side), rel=1e-9)


def test_the_page_is_the_sheet_where_none_is_drawn(tmp_path: Path) -> None:
    nest = read(tmp_path, '<rect x="20" y="20" width="40" height="40"/>')
    assert nest.sheet.bounds == (0, 0, 200, 100)
    assert texts(nest.notes) == ["no layer is the sheet's: the page, 200 × 100 mm, is taken for it"]


def test_an_offset_view_box(tmp_path: Path) -> None:
    nest = read(tmp_path, '<rect x="-80" y="-80" width="40" height="40"/>', 'width="200mm" viewBox="-100 -100 200 200"')
    assert nest.contour("P1.outer").polygon.bounds == (20, 140, 60, 180)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("<svg", "not an SVG file that can be read"),
        ("<html/>", "its root is no <svg> element"),
        (f"<svg {NAMESPACES}/>", "nothing to cut"),
        (f'<svg {NAMESPACES}><symbol id="s"><rect width="1" height="1"/></symbol></svg>', "nothing to cut"),
        (f'<svg {NAMESPACES}><path d="M 0 0 C 1e300 0 0 1e300 5 5 Z"/></svg>', "kilometre"),
        (f'<svg {NAMESPACES}><rect width="1e9" height="1e9"/></svg>', "kilometre"),
        (f'<svg {NAMESPACES}><path id="p7" d="M1 1 Q zz"/></svg>', "the <path> 'p7' cannot be read: Q is followed by"),
        (f'<svg {NAMESPACES}><path d="M1 1 L5 5 7"/></svg>', "the <path> cannot be read: L is followed by '5 5 7'"),
        (f'<svg {NAMESPACES}><path d="L1 1 5 5"/></svg>', "begins with 'L1 1 5 5', expected M"),
        (f'<svg {NAMESPACES}><path d="M1 1 h5 x3"/></svg>', "h is followed by '5 x3', expected 1 numbers"),
        (f'<svg {NAMESPACES}><path d="M1 1 a5 5 0 2 0 1 1"/></svg>', "expected 7 numbers or a multiple"),
        (f'<svg {NAMESPACES}><rect x="NaN" width="5" height="5"/></svg>', "x is 'NaN', expected a length"),
        (f'<svg {NAMESPACES}><circle r="wide"/></svg>', "the <circle> cannot be read: r is 'wide'"),
        (f'<svg {NAMESPACES}><polygon points="1,1 5;1 5,5"/></svg>', "its points '1,1 5;1 5,5' are no list of numbers"),
        ("plain text", "not an SVG file that can be read"),
    ],
)
def test_what_is_no_drawing(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "broken.svg"
    path.write_text(text)
    with pytest.raises(InputError, match=said):
        read_drawing(path)


def test_a_page_of_another_shape_than_its_view_box(tmp_path: Path) -> None:
    page = 'width="200mm" height="200mm" viewBox="0 0 400 200"'
    rectangle = SHEET + '<rect x="20" y="20" width="100" height="80"/>'
    assert areas(read(tmp_path, rectangle, page)) == {"P1.outer": 2000}
    stretched = read(tmp_path, rectangle, page + ' preserveAspectRatio="none"')
    assert areas(stretched) == {"P1.outer": 4000}
    assert stretched.sheet.bounds == (0, 0, 200, 200)
    assert areas(read(tmp_path, rectangle, page + ' preserveAspectRatio="xMinYMin slice"')) == {"P1.outer": 8000}


def test_the_innermost_label_says_what_a_shape_is_for(tmp_path: Path) -> None:
    body = f"""{SHEET}<g inkscape:label="Sheet parts" id="layer2"><g inkscape:label="Kontur" id="g10">
    <rect id="cut" x="20" y="20" width="100" height="80"/></g></g>
    <g inkscape:label="job" id="layer3"><rect id="rect7" x="200" y="20" width="40" height="40"/>
    <g inkscape:label="Bemaßung"><line x1="0" y1="0" x2="9" y2="9"/></g>
    <g inkscape:label="Scrap"><line x1="300" y1="0" x2="300" y2="200"/></g>
    <line inkscape:label="Gravur" id="cut2" x1="210" y1="30" x2="230" y2="30"/></g>"""
    nest = read(tmp_path, body, layers={"cut": "^(cut|job)$"}, scrap_lines="cut")
    assert [c.curve.as_rows() for c in nest.scrap] == [[[150, 100], [150, 0]]]
    nest = read(tmp_path, body, layers={"cut": "^(cut|job)$"})
    assert [c.id for c in nest.contours] == ["P1.outer", "P2.mark1", "P2.outer"]
    assert texts(nest.notes) == [
        "left out, as drawing.layers.ignore matches their layers: 1 on 'job/Bemaßung'",
        "left out, as lines that cut up scrap: 1 on 'job/Scrap'; drawing: {scrap_lines: cut} has them cut",
    ]


@pytest.mark.parametrize("name", ["text12", "layer3", "g7-1"])
def test_an_id_that_a_program_numbered_says_nothing(tmp_path: Path, name: str) -> None:
    nest = read(tmp_path, f'{SHEET}<g id="{name}"><rect id="{name}-5" x="20" y="20" width="40" height="40"/></g>')
    assert list(areas(nest)) == ["P1.outer"]


def test_writing_is_said(tmp_path: Path) -> None:
    body = f"""{SHEET}<rect x="20" y="20" width="40" height="40"/>
    <g inkscape:label="Gravur"><text x="5" y="5">A-101</text><text x="5" y="9"><tspan>A-102</tspan></text></g>
    <image href="photo.png" width="9" height="9"/><g inkscape:label="notes"><text>left out anyway</text></g>"""
    assert texts(read(tmp_path, body).notes) == [
        "1 image is left out: trace to paths what is to be cut",
        "left out, as they are on no part: 2 texts on layer 'Gravur', the first the text 'A-101' at (2.500, 97.500) on "
        "layer 'Gravur'",
    ]


def test_open_lines_beside_closed_ones_name_their_group(tmp_path: Path) -> None:
    body = f"""{SHEET}<g inkscape:label="Ebene"><rect x="20" y="20" width="100" height="80"/>
    <line id="slot" x1="40" y1="40" x2="60" y2="40"/></g>"""
    for repair in (False, True):
        with pytest.raises(Questions) as error:
            read(tmp_path, body, repair=repair)
        [question] = error.value.questions
        assert question.id == "layer:Ebene"
        assert question.text.startswith("layer 'Ebene' holds 1 open line beside 1 closed one")
