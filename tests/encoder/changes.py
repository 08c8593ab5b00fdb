"""Messages of the readers and the encoder that ask for a change of the file, and the file so changed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from kerfwise.rule_kit import circle, rect
from kerfwise.tests.encoder.advice import LASER, A, Advice, Do, Words, Write, drawn, dxf, given, part, parts
from kerfwise.tests.encoder.readers.drawings import lines, sheet, square


def svg(body: str) -> Write:
    """An SVG file with a part of 50 × 50 mm and this."""

    def write(folder: Path) -> Path:
        rectangle = '<rect x="10" y="10" width="50" height="50" fill="none" stroke="black"/>'
        head = '<svg xmlns="http://www.w3.org/2000/svg" width="200mm" height="100mm" viewBox="0 0 200 100">'
        (file := folder / "drawing.svg").write_text(f"{head}{rectangle}{body}</svg>", encoding="utf-8")
        return file

    return write


def changed(write: Write, old: str, new: str) -> Write:
    """The file with another text in it."""

    def write_changed(folder: Path) -> Path:
        text = (file := write(folder)).read_text(encoding="utf-8")
        assert old in text
        file.write_text(text.replace(old, new, 1), encoding="utf-8")
        return file

    return write_changed


def asks(
    advised: str, source: str, said: str, wrong: Write, right: Write, verb: str = "read", words: Words = ()
) -> Advice:
    """A message that asks for one change."""
    return Advice(source, said, wrong, (Do(advised, words, right),), words, verb)


def bridged(start: Sequence[float], end: Sequence[float], width: float = 4, more: Sequence[Any] = ()) -> Write:
    """Two parts 20 mm apart, the first with a hole, a third above, and bridges."""
    holed = part("A", rect(20, 20, 60, 60), holes=[circle(60, 60, 5)])
    rows = [{"parts": ["A", "B"], "from": list(start), "to": list(end), "width": width}, *more]
    return parts(holed, part("B", rect(100, 20, 60, 60)), part("C", rect(84, 70, 12, 40)), bridges=rows)


def scrapped(*rows: Sequence[Sequence[float]]) -> Write:
    return parts(A, scrap=[list(map(list, row)) for row in rows])


def tabbed(*at: Sequence[float], width: float = 2.0, near: float = 300.0) -> Write:
    tabs = [{"at": list(place), "width": width} for place in at]
    return parts({**A, "tabs": tabs}, part("B", rect(near, 20, 40, 80)))


FLAT, SHEET, MARK = [(0, 0), (90, 0)], {"layer": "Sheet"}, {"layer": "Mark"}
TABS = [*LASER, *given(**{"rules__hold-small-parts": "hard"})]
CLIPPED = '<rect clip-path="url(#c)" x="20" y="20" width="9" height="9" fill="none" stroke="black"/>'
HOLE = '<rect x="100" y="20" width="9" height="9" fill="none" stroke="black"{}/>'
HIGH = {"parts": ["A", "B"], "from": [80, 60], "to": [100, 60], "width": 4}

CHANGES = [
    # bridges
    asks("let it end in the part or on its edge", "let it end in the part or on its edge", "does not reach part A",
         bridged((82, 30), (100, 30)), bridged((80, 30), (100, 30))),
    asks("make it narrower", "or let it end further in the part", "is wider than part A where it ends",
         bridged((80, 22), (100, 22), 6), bridged((80, 22), (100, 22), 3)),
    asks("make it narrower, or move it", "runs along an edge of part", "runs along an edge of part A",
         bridged((70, 22), (110, 22)), bridged((70, 40), (110, 40))),
    asks("move it", "f'meets {hole.id}", r"meets A\.hole1", bridged((60, 60), (100, 60)), bridged((60, 30), (100, 30))),
    asks("lead it past", "lead it past, or join the parts one by one", "meets a third part, C",
         bridged((80, 75), (100, 75)), bridged((80, 30), (100, 30))),
    asks("keep them apart", "keep them apart", "meets bridge 1",
         bridged((80, 62), (100, 62), more=[HIGH]), bridged((80, 30), (100, 30), more=[HIGH])),
    asks("make it wider", "make it wider", "bridge 1 .* is 1 mm wide, less than the kerf of",
         bridged((80, 30), (100, 30), 1), bridged((80, 30), (100, 30)), "facts"),
    # scrap lines
    asks("remove it", "f'{line.id} has no length", "scrap1 has no length",
         scrapped([(250, 150), (250, 150)]), scrapped([(250, 0), (250, 300)])),
    asks("goes from one place to another", "a scrap line goes from one place", "scrap1 is closed",
         scrapped([(250, 150), (300, 150), (300, 200), (250, 150)]), scrapped([(250, 0), (250, 300)])),
    asks("draw it as several lines", "draw it as several lines", "scrap1 crosses itself",
         scrapped([(250, 0), (250, 200), (300, 100), (200, 100)]), scrapped([(250, 0), (250, 200), (300, 100)])),
    asks("end it at the edge", "end it at the edge", "scrap1 runs 10.000 mm off the sheet",
         scrapped([(250, 0), (250, 310)]), scrapped([(250, 0), (250, 300)])),
    asks("end it before the part, or lead it round", "end it before", "scrap1 runs through part A",
         scrapped([(0, 50), (60, 50)]), scrapped([(0, 50), (15, 50)])),
    asks("draw the line once", "draw the line once", "scrap1 and scrap2 run on each other",
         scrapped([(250, 0), (250, 300)], [(250, 100), (250, 200)]), scrapped([(250, 0), (250, 300)])),
    asks("let one of them end at the other", "let one of them end at the other", "scrap1 and scrap2 cross",
         scrapped([(250, 0), (250, 300)], [(200, 150), (400, 150)]),
         scrapped([(250, 0), (250, 300)], [(250, 150), (400, 150)])),
    asks("draw it as two lines that meet there", "lines that meet there", "scrap1 is cut in two by the lines",
         scrapped([(250, 0), (250, 300)], [(0, 150), (250, 150)], [(250, 150), (400, 150)]),
         scrapped([(250, 0), (250, 150)], [(250, 150), (250, 300)], [(0, 150), (250, 150)], [(250, 150), (400, 150)]),
         "facts"),
    asks("keep it a kerf away", "keep it a kerf away", r"scrap1 comes within 1\.000 mm of A\.outer",
         scrapped([(121, 0), (121, 300)]), scrapped([(130, 0), (130, 300)]), "facts"),
    # parts and sheets
    asks("move the part", "move the part or give a larger sheet'", r"A\.outer reaches 20\.000 mm off the sheet",
         parts(part("A", rect(320, 20, 100, 80))), parts(part("A", rect(280, 20, 100, 80)))),
    asks("give a larger sheet", "move the part or give a larger sheet'", r"A\.outer reaches 20\.000 mm off the sheet",
         parts(part("A", rect(320, 20, 100, 80))), parts(part("A", rect(320, 20, 100, 80)), width=440)),
    asks("move the part", "more than half a kerf of which lies beside each part", r"A\.outer: the torch's path runs",
         parts(part("A", rect(0, 20, 100, 80))), parts(part("A", rect(20, 20, 100, 80))), "facts"),
    asks("move the mark", "move the mark or give a larger sheet", r"A\.mark1 runs along the edge of the sheet",
         parts({**A, "outer": rect(0, 20, 100, 80), "marks": [[[0, 30], [0, 60]]]}),
         parts({**A, "marks": [[[30, 30], [30, 60]]]}), "facts"),
    asks("correct the part in CAD", "correct the part in CAD", r"A\.hole1 reaches out of A\.outer",
         parts({**A, "holes": [rect(110, 40, 30, 20)]}), parts({**A, "holes": [rect(60, 40, 30, 20)]})),
    asks("correct it in CAD", ": correct it in CAD{mends}", r"A\.hole1 crosses itself",
         parts({**A, "holes": [[[40, 40], [60, 40], [45, 70], [45, 30]]]}, part("B", rect(60, 60, 100, 80))),
         parts({**A, "holes": [[[40, 40], [60, 40], [45, 70]]]})),
    asks("draw the sheet again", "encloses no area, {place(curve)}: draw the sheet again", "outline encloses no area",
         parts(A, sheet={"outline": [[0, 0], [400, 0]]}), parts(A, sheet={"outline": rect(0, 0, 400, 300)})),
    asks("draw the sheet again", "{_crossing(curve.polygon())}: draw the sheet again", "outline crosses itself",
         parts(A, sheet={"outline": [[0, 0], [400, 300], [400, 0], [0, 300]]}),
         parts(A, sheet={"outline": rect(0, 0, 400, 300)})),
    asks("mend or remove it", "encloses nothing: mend or remove it", "the line of the sheet .* encloses nothing",
         dxf(lambda s: [lines(s, square(10, 10, 50)), s.add_lwpolyline(FLAT, close=True, dxfattribs=SHEET)]),
         dxf(lambda space: [lines(space, square(10, 10, 50)), sheet(space)])),
    # tabs
    asks("give a point on it", "give a point on it", r"the tab at \(70, 30\) is 10\.0 mm from the contour",
         tabbed((70, 30)), tabbed((70, 20)), "facts", TABS),
    asks("make it narrower", "{place} {text}; make it narrower, or move it", "is wider than its edge",
         tabbed((120, 60), width=90), tabbed((120, 60)), "facts", TABS),
    asks("move it to another edge", "move it to another edge", "of waste beside it: no metal would stay",
         tabbed((120, 60), near=120.8), tabbed((70, 20), near=120.8), "facts", TABS),
    asks("move it", "meets another one; move it", r"the tab at \(71, 20\) meets another one",
         tabbed((70, 20), (71, 20)), tabbed((70, 20), (70, 100)), "facts", TABS),
    # files
    asks("leave one of them", "is given twice, first in line", "the key 'id' is given twice",
         changed(parts(A), '"id": "A"', '"id": "A", "id": "B"'), parts(A)),
    asks("give each part its own", "give each part its own", "part number 2 has the id 'A' of part number 1",
         parts(A, part("A", rect(200, 20, 50, 50))), parts(A, part("B", rect(200, 20, 50, 50)))),
    asks("did you mean 'holes'", "unknown key, did you mean", "part 'A', hole: unknown key",
         parts({**A, "hole": [rect(60, 40, 30, 20)]}), parts({**A, "holes": [rect(60, 40, 30, 20)]})),
    asks("expected outer, holes or marks", "unknown key of what looks like contours", "part 'A', inner: unknown key",
         parts({**A, "inner": [rect(60, 40, 30, 20)]}), parts({**A, "holes": [rect(60, 40, 30, 20)]})),
    asks("save it as DXF", "save it as DXF", "this is a DWG file under another name",
         lambda folder: _bytes(folder, b"AC1032\0\0"), drawn()),
    asks("with a point and without spaces", "export the drawing again with such numbers", "'50,5' is no number",
         changed(drawn((square(100, 100, 50.5), "0", True)), "150.5", "50,5"), drawn()),
    asks("explode them in CAD", "explode them in CAD if they are to be cut", "they are not lines one can cut: 1 HATCH",
         dxf(lambda space: [sheet(space), lines(space, square(10, 10, 50)), space.add_hatch()]),
         drawn((square(20, 20, 9), "0", True)), "facts"),
    asks("turn it into lines in CAD", "turn it into lines in CAD", "as the font has no letter",
         dxf(lambda space: [lines(space, square(10, 10, 50)), space.add_text("漢", height=9, dxfattribs=MARK)]),
         dxf(lambda space: [lines(space, square(10, 10, 50)), lines(space, square(20, 20, 9), "Mark")])),
    # SVG
    asks("save it again as plain SVG", "cannot be read: {wrong}", "the <rect> cannot be read: width is '9,5'",
         svg('<rect width="9,5" height="5"/>'), svg(HOLE.format(""))),
    asks("save the drawing as plain SVG, with styles on each shape", "with styles on each shape", ":empty' is not",
         svg(f"<style>:empty{{opacity:0}}</style>{HOLE.format('')}"), svg(HOLE.format(' opacity="0"'))),
    asks("save the drawing as plain SVG", "f'{what}; save the drawing as plain SVG'", "which is not computed",
         svg(HOLE.format(' opacity="calc(1px - 1%)"')), svg(HOLE.format(' opacity="0"'))),
    asks("with transforms", "save the drawing as plain SVG, with transforms", "is moved by its style",
         svg(HOLE.format(' style="translate: 5px"')), svg(HOLE.format(' transform="translate(5)"'))),
    asks("save the drawing as plain SVG", "is turned about its own box", "is turned about its own box",
         svg(HOLE.format(' style="transform: rotate(9deg); transform-origin: 50% 50%; transform-box: fill-box"')),
         svg(HOLE.format(' transform="rotate(9 104.5 24.5)"'))),
    asks("release it in the drawing program", "is clipped by {clip}", r"is clipped by inset\(50%\)",
         svg(HOLE.format(' clip-path="inset(50%)"')), svg("")),
    asks("release it in the drawing program", "is in shares of what it clips", "is in shares of what it clips",
         svg(f'<clipPath id="c" clipPathUnits="objectBoundingBox"><rect width="1" height="1"/></clipPath>{CLIPPED}'),
         svg(HOLE.format(""))),
    asks("release it in the drawing program", "is made of letters", "the clipping path 'c' is made of letters",
         svg(f'<clipPath id="c"><text>A</text></clipPath>{CLIPPED}'), svg(HOLE.format(""))),
    asks("release it in the drawing program", "is clipped itself", "in the clipping path 'c' is clipped itself",
         svg(f'<clipPath id="c"><rect width="9" height="9" clip-path="url(#d)"/></clipPath>{CLIPPED}'),
         svg(HOLE.format(""))),
]  # fmt: skip


def _bytes(folder: Path, data: bytes) -> Path:
    (file := folder / "drawing.dxf").write_bytes(data)
    return file
