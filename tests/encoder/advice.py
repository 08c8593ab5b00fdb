"""Messages of the readers and the encoder that name an option: what provokes each, and what it says to do."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kerfwise.rule_kit import circle, rect
from kerfwise.tests.encoder.readers.drawings import lines, save_dxf, sheet, square

Write = Callable[[Path], Path]
Words = Sequence[str]


# Small drawings.


def dxf(draw: Callable[[Any], object], units: int = 4) -> Write:
    """A DXF file with what `draw` draws."""
    return lambda folder: save_dxf(folder, draw, units)


def parts(*drawn: dict[str, Any], width: float = 400, height: float = 300, **more: Any) -> Write:
    """A nest file with these parts."""

    def write(folder: Path) -> Path:
        nest = {"format": "kerfwise-nest/1", "units": "mm", "sheet": {"width": width, "height": height}, **more}
        (file := folder / "nest.json").write_text(json.dumps({**nest, "parts": list(drawn)}), encoding="utf-8")
        return file

    return write


def part(name: str, outer: Any, **more: Any) -> dict[str, Any]:
    return {"id": name, "outer": outer, **more}


def drawn(*shapes: tuple[Sequence[tuple[float, float]], str, bool], stock: bool = True) -> Write:
    """A sheet, a part of 50 × 50 mm at (10, 10) on layer 0, and these lines: points, layer, whether they close."""

    def draw(space: Any) -> None:
        if stock:
            sheet(space)
        lines(space, square(10, 10, 50))
        for points, layer, closed in shapes:
            lines(space, points, layer, closed=closed)

    return dxf(draw)


A = part("A", rect(20, 20, 100, 80))
GAP = ([(100, 100), (200, 100), (200, 160), (100, 160), (100, 100.4)], "0", False)
BRIDGE = [(60, 30), (100, 30), (100, 36), (60, 36)]
STRAY = ([(100, 250), (140, 250)], "0", False)
BOW_TIE = [(200, 20), (300, 100), (300, 20), (200, 100)]
DENTED = [(200, 20), (300, 20), (300, 100), (251, 100), (249, 102), (249, 100), (251, 102), (251, 100), (200, 100)]
SLOTTED = [(20, 20), (200, 20), (200, 200), (111, 200), (111, 150), (110, 150), (110, 200), (20, 200)]
HOUSE = [(20, 20), (200, 20), (200, 200), (20, 200)]
HOLE_45 = {"holes": [[(60, 60), (160, 60), (60, 160)]]}
STAR = [(250 + 40 * math.cos(3.121 * k), 150 + 40 * math.sin(3.121 * k)) for k in range(401)]


def broken_off(folder: Path) -> Path:
    file = drawn()(folder)
    text = file.read_text(encoding="utf-8")
    file.write_text(text[: text.rindex("EOF")].rstrip().rsplit("  0", 1)[0], encoding="utf-8")
    return file


def two_sheets(space: Any) -> None:
    lines(space, square(0, 0, 200), "Sheet")
    lines(space, square(300, 0, 200), "Sheet old")
    lines(space, square(10, 10, 50))


def with_round(space: Any, circle: bool) -> None:
    sheet(space)
    lines(space, square(10, 10, 50))
    _ = space.add_circle((200, 150), 20) if circle else space.add_arc((200, 150), 20, 30, 30)


# What is advised, and done.


@dataclass(frozen=True)
class Do:
    """One thing that a message advises: other words on the command line, or another file.

    `advised` are the words by which the message names it. The message is gone then, the exit code is `code`, and
    `shows` is in what is printed.
    """

    advised: str
    words: Words = ()
    file: Write | None = None
    shows: str = ""
    code: int = 0


@dataclass(frozen=True)
class Advice:
    """A message: words of its source, how it begins, what provokes it, and what it says to do."""

    source: str
    said: str
    file: Write
    does: tuple[Do, ...]
    words: Words = ()
    verb: str = "read"


def given(**settings: str) -> list[str]:
    """`--set KEY=VALUE` for each, `__` for a point."""
    return [word for key, value in settings.items() for word in ("--set", f"{key.replace('__', '.')}={value}")]


BEVELS = given(cuts__bevel__head="tilting", machine__dialect="linuxcnc")
LOOPS = [*BEVELS, *given(cuts__bevel__corner="loop")]
V_45 = {**A, "bevel": {"kind": "V", "angle": 45}}
SCRAP = ([(250, 150), (250, 290)], "Scrap cuts", False)
SHARED = ["--answer", "layer:0=open:shared"]
LASER = ["-p", "laser-st10kp-2mm"]

ADVICE = [
    Advice(
        "draw circles, or delete them",
        "arcs with two angles that are one, read as once round",
        dxf(lambda space: with_round(space, circle=False)),
        (
            Do("draw circles", file=dxf(lambda space: with_round(space, circle=True))),
            Do("delete them", file=drawn()),
        ),
        verb="facts",
    ),
    Advice(
        "where its line begins",
        r"\(2e\+06, 0\) mm lies more than a kilometre from where its line begins",
        dxf(lambda space: space.add_lwpolyline([(0, 0), (2000, 0), (2000, 1000), (0, 1000)], close=True), units=6),
        (Do("--units", ["--units", "mm"], shows="units: mm: as given"),),
    ),
    Advice(
        "take it out if it is a stray one",
        r"the line farthest from the others lies at .* on layer 'STRAY'",
        drawn((square(5e6, 0, 5), "STRAY", True)),
        (Do("take it out", file=drawn(), shows="sheet: 400 × 300 mm"),),
    ),
    Advice(
        "to cut one, say so in the profile",
        r"nothing to cut: every line is on a layer that is not cut \('DIM' is left out\)",
        dxf(lambda space: lines(space, square(10, 10, 50), "DIM")),
        (Do("drawing: {layers: {cut: '^DIM$'}}", given(drawing__layers__cut="^DIM$"), shows="layer 'DIM': cut"),),
    ),
    Advice(
        "match less",
        r"nothing to cut: .*let drawing\.layers\.mark match less",
        drawn(),
        (Do("let drawing.layers.mark match less", given(drawing__layers__mark="^ENGRAVE"), shows="layer '0': cut"),),
        given(drawing__layers__mark="0"),
    ),
    Advice(
        "drawing.layers says nothing of some lines",
        r"drawing\.layers says nothing of some lines: 4 on 'G2'",
        drawn((square(20, 20, 5), "G2", True)),
        (
            Do("mark", given(drawing__layers__cut="^0$", drawing__layers__mark="^G2$"), shows="'G2': marked"),
            Do("ignore", given(drawing__layers__cut="^0$", drawing__layers__ignore="^G2$"), shows="'G2': left out"),
            Do("cut", given(drawing__layers__cut="^(0|G2)$"), shows="'G2': cut"),
        ),
        given(drawing__layers__cut="^0$"),
    ),
    Advice(
        "though it sounds like",
        r"layer 'Notes' is cut, though it sounds like something not to be cut: drawing\.layers\.ignore does not",
        drawn((square(100, 100, 50), "Notes", True)),
        (Do("drawing.layers.ignore", given(drawing__layers__ignore="notes"), shows="4 on 'Notes'"),),
        given(drawing__layers__ignore="^DIM$"),
        "facts",
    ),
    Advice(
        "{scrap_lines: cut}} has them cut",
        r"as lines that cut up scrap: 1 on 'Scrap cuts'",
        drawn(SCRAP),
        (Do("drawing: {scrap_lines: cut}", given(drawing__scrap_lines="cut"), shows="'Scrap cuts': scrap lines"),),
    ),
    Advice(
        "a tab is a short line on one, or across it",
        r"the tab at \(200\.000, 200\.000\) on layer 'tab' lies on no outer contour of a part",
        drawn(([(200, 200), (205, 200)], "tab", False)),
        (
            Do("drawing: {layers: {cut: '^(0|tab)$'}}", given(drawing__layers__cut="^(0|tab)$"), shows="'tab'"),
            Do("a short line on one", file=drawn(([(30, 10), (35, 10)], "tab", False)), shows="layer 'tab': tabs"),
        ),
    ),
    Advice(
        "a bridge is drawn as a rectangle from part to part",
        r"the bridge at \(100\.000, 100\.000\) on layer 'bridge' does not go from one part to another",
        drawn((square(100, 100, 20), "bridge", True)),
        (
            Do("drawing: {layers: {cut: '^(0|bridge)$'}}", given(drawing__layers__cut="^(0|bridge)$")),
            Do(
                "a rectangle from part to part",
                file=drawn((square(100, 10, 50), "0", True), (BRIDGE, "bridge", True)),
                shows="layer 'bridge': bridges",
            ),
        ),
    ),
    Advice(
        "and drawing.open_lines is refuse",
        r"layer '0' holds 1 open line, and drawing\.open_lines is refuse; with mark or ignore they are not refused",
        drawn(STRAY),
        tuple(
            Do(how, given(drawing__layers__cut="^0$", drawing__open_lines=how), shows="left out")
            for how in ("mark", "ignore")
        ),
        given(drawing__layers__cut="^0$", drawing__open_lines="refuse"),
    ),
    Advice(
        "raise drawing.join_tolerance over",
        r"the end at \(100\.000, 100\.000\) is 0\.400 mm from any other: close the line in CAD",
        drawn(GAP),
        (
            Do("raise drawing.join_tolerance over 0.400 mm", given(drawing__join_tolerance="0.41 mm"), shows="'0'"),
            Do("--repair", ["--repair", *given(drawing__open_lines="refuse")], shows="a gap of 0.400 mm"),
            Do("close the line in CAD", file=drawn((GAP[0][:4], "0", True)), shows="layer '0': cut"),
        ),
        given(drawing__open_lines="refuse"),
    ),
    Advice(
        "which would be cut through. Say in",
        r"layer '0' holds 1 open line beside 1 closed one, which would be cut through",
        drawn(STRAY),
        (
            Do("drawing: {layers: {cut: '^0$'}} cuts what is closed", given(drawing__layers__cut="^0$")),
        ),
        given(drawing__open_lines="refuse"),
    ),
    Advice(
        "and nothing closed. If they are no contours",
        r"layer 'G2' holds 1 open line and nothing closed",
        drawn(([(20, 20), (40, 40)], "G2", False)),
        tuple(
            Do(use, given(drawing__open_lines="refuse", **{f"drawing__layers__{use}": "^G2$"}), shows="layer 'G2'")
            for use in ("mark", "ignore", "scrap")
        ),
        given(drawing__open_lines="refuse"),
    ),
    Advice(
        "is taken for it; pass --sheet WxH",
        r"the parts' bounding box and 10 mm around it, 70 × 70 mm, is taken for it",
        drawn(stock=False),
        (
            Do("--sheet WxH", ["--sheet", "500x400"]),
            Do("drawing.layers.sheet", given(drawing__layers__sheet="^STOCK$"),
               drawn((square(0, 0, 200), "STOCK", True), stock=False)),
        ),
        verb="facts",
    ),
    Advice(
        "takes the place of the file's sheet",
        r"--sheet \(in Python: sheet_mm\) takes the place of the file's sheet of 400 × 300 mm: 500 × 400 mm",
        drawn(),
        (Do("--sheet", []),),
        ["--sheet", "500x400"],
        "facts",
    ),
    Advice(
        "sheets are drawn; one nest at a time can be read",
        r"2 sheets are drawn; one nest at a time can be read",
        dxf(two_sheets),
        (
            Do("drawing.layers.sheet", given(drawing__layers__sheet="^Sheet$", drawing__layers__ignore="old")),
            Do("Keep one", file=drawn((square(0, 0, 200), "Sheet", True), stock=False), shows="the sheet"),
        ),
    ),
    Advice(
        "--units (in Python: units=) {' or '",
        r"the sheet is 4 × 3 mm, too small to be one: if mm is the wrong unit, pass --units",
        parts(part("A", rect(0.5, 0.5, 2, 2)), width=4, height=3),
        (Do("cm", ["--units", "cm"]), Do("m", ["--units", "m"]), Do("in", ["--units", "in"])),
        verb="facts",
        words=["-p", "laser-amg3m-1mm"],
    ),
    Advice(
        "the DXF file breaks off",
        r"the DXF file breaks off: its end mark EOF is missing",
        broken_off,
        (
            Do("--repair", ["--repair"], shows="read as far as it goes"),
            Do("export it again", file=drawn(), shows="layer '0': cut"),
        ),
    ),
    Advice(
        "has no length",
        r"A\.mark1 has no length, at \(30\.000, 30\.000\): remove it, or try --repair",
        parts({**A, "marks": [[[30, 30], [30, 30]]]}),
        (Do("--repair", ["--repair"], shows="A.mark1 encloses nothing"), Do("remove it", file=parts(A))),
    ),
    Advice(
        "encloses no area",
        r"A\.hole1 encloses no area, at \(30\.000, 30\.000\): remove it, or try --repair",
        parts({**A, "holes": [[[30, 30], [60, 30]]]}),
        (Do("--repair", ["--repair"], shows="A.hole1 encloses nothing"), Do("remove it", file=parts(A))),
    ),
    Advice(
        ", or try {REPAIR}'",
        r"B\.outer (crosses|touches) itself at \(2\d\d\.\d+, \d+\.\d+\): correct it in CAD, or try --repair",
        parts(A, part("B", DENTED), part("C", rect(60, 60, 100, 80))),
        (Do("--repair", ["--repair"], shows="A.outer and C.outer overlap", code=2),),
    ),
    Advice(
        "leave its layer out (drawing.layers.ignore)",
        r"the ring that starts at .* crosses or touches itself more than 10000 times",
        drawn((STAR, "STAR", True)),
        (Do("drawing.layers.ignore", given(drawing__layers__ignore="^STAR$"), shows="layer 'STAR': left out"),),
    ),
    Advice(
        "expected QUESTION=CHOICE, such as frame=sheet",
        r"--answer 'frame': expected QUESTION=CHOICE, such as frame=sheet",
        dxf(lambda space: [lines(space, square(0, 0, 200)), lines(space, square(10, 10, 50))]),
        (Do("frame=sheet", ["--answer", "frame=sheet"], shows="answered: frame=sheet"),),
        ["--answer", "frame"],
    ),
    # what cannot be cut
    Advice(
        "from which mass on a loose part lies still (cuts.bevel.lies_still)",
        r"A\.outer, bevel X 30: the first of its 2 passes sets loose what the others cut: A weighs 0\.377 kg",
        parts({**A, "bevel": {"kind": "X", "angle": 30}}),
        (
            Do("cuts.bevel.lies_still", [*BEVELS, *given(cuts__bevel__lies_still="0.2 kg")]),
            Do("a bevel V has one pass", BEVELS, parts({**A, "bevel": {"kind": "V", "angle": 30}})),
        ),
        BEVELS,
        "facts",
    ),
    Advice(
        "no loop has room at the corner",
        r"bevel V 45 top: no loop has room at the corner \(120\.0, 20\.0\): the torch would come within 1\.53 mm of B",
        parts(V_45, part("B", rect(132, 20, 200, 80))),
        (
            Do("leave more web", LOOPS, parts(V_45, part("B", rect(160, 20, 200, 80)))),
            Do("shorten cuts.bevel.run", [*LOOPS, *given(cuts__bevel__run="1 mm")]),
            Do("say cuts.bevel.corner: either", [*BEVELS, *given(cuts__bevel__corner="either")]),
        ),
        LOOPS,
        "facts",
    ),
    Advice(
        "`{IN_PROFILE[self.key]}: ",
        r"A\.hole1 is 4\.00 mm across, less than small_holes\.min_hole, 6 mm",
        parts({**A, "holes": [circle(60, 60, 2)]}),
        (
            Do("`small_holes.under: spot`", given(small_holes__under="spot")),
            Do("`small_holes.min_hole: 4 mm`", given(small_holes__min_hole="4 mm")),
        ),
        given(small_holes__under="refuse"),
        "facts",
    ),
    Advice(
        "asks for {clearance_mm:g} mm",
        r"the best spot for a pierce near it is 1\.48 mm from A\.hole1, rules\.pierce\.clearance asks for 1\.5 mm",
        parts({**A, "holes": [circle(60, 60, 1.48)]}),
        (
            Do("`rules.pierce.clearance: 1.48 mm`",
               given(small_holes__min_hole="2 mm", small_holes__under="refuse", rules__pierce__clearance="1.48 mm")),
            Do("`small_holes.under: spot`", given(small_holes__min_hole="2 mm", small_holes__under="spot")),
        ),
        given(small_holes__min_hole="2 mm", small_holes__under="refuse"),
        "facts",
    ),
    Advice(
        "(the torch cuts straight across)",
        r"A\.outer: a kerf of 1\.5 mm does not enter the slot, notch or neck at \(110\.5, 200\.0\)",
        parts(part("A", SLOTTED)),
        (
            Do("`cuts.narrow: leave`", given(cuts__narrow="leave")),
            Do("(cuts.narrow: slit)", given(cuts__narrow="slit")),
            Do("change the drawing", given(cuts__narrow="refuse"), parts(part("A", HOUSE))),
        ),
        given(cuts__narrow="refuse"),
        "facts",
    ),
    Advice(
        "allows {options.corner_mm:g} mm",
        r"the corner of 45° at .*, which keeps 1\.21 mm; corners\.leave allows 0\.5 mm",
        parts(part("A", HOUSE, **HOLE_45)),
        (Do("`corners.leave: 1.21 mm`", given(corners__leave="1.21 mm")),),
        given(corners__leave="0.5 mm"),
        "facts",
    ),
    Advice(
        "out of the machine's travel: move the part, or correct machine.travel_x and machine.travel_y",
        r"A\.outer at .* is 19\.8 mm out of the machine's travel",
        parts(part("A", rect(200, 20, 100, 80))),
        (
            Do("correct machine.travel_x", given(machine__travel_x="[0 mm, 9 m]", machine__travel_y="[0 mm, 9 m]")),
            Do("move the part", given(machine__travel_x="[0 mm, 281 mm]", machine__travel_y="[0 mm, 400 mm]"),
               parts(part("A", rect(150, 20, 100, 80)))),
        ),
        given(machine__travel_x="[0 mm, 281 mm]", machine__travel_y="[0 mm, 400 mm]"),
        "facts",
    ),
    Advice(
        "its tab has no room beside the lead-in",
        r"T\.outer: its tab has no room beside the lead-in of any entry",
        parts(part("T", rect(20, 20, 5, 5)), width=200, height=120),
        (
            Do("make the tab narrower, lower corner of rules.hold-small-parts",
               given(**{"rules__hold-small-parts": "{strength: hard, width: 0.3 mm, corner: 0.2 mm}"})),
            Do("lock the part to have none (tab: off)",
               [*given(**{"rules__hold-small-parts": "hard"}), "--lock", "T.outer tab off"]),
        ),
        given(**{"rules__hold-small-parts": "hard"}),
        "facts",
    ),
    Advice(
        "draw its tabs in the nest, or lock it to have none (tab: off)",
        r"T\.outer: no room for a tab: each needs a straight of 7 mm and a kerf",
        parts(part("T", rect(20, 20, 5, 5)), width=200, height=120),
        (
            Do("lower width or corner",
               [*LASER, *given(**{"rules__hold-small-parts": "{strength: hard, width: 0.5 mm, corner: 0.5 mm}"})]),
            Do("lock it to have none (tab: off)",
               [*LASER, *given(**{"rules__hold-small-parts": "hard"}), "--lock", "T.outer tab off"]),
        ),
        [*LASER, *given(**{"rules__hold-small-parts": "hard"})],
        "facts",
    ),
    Advice(
        "move it along its edge, or lower corner of",
        r"A\.outer: the tab at \(21, 20\) lies in a corner, or less than 3 mm from one",
        parts({**A, "tabs": [{"at": [21, 20]}]}),
        (
            Do("move it along its edge", [*LASER, *given(**{"rules__hold-small-parts": "hard"})],
               parts({**A, "tabs": [{"at": [60, 20]}]})),
            Do("lower corner", [*LASER, *given(**{"rules__hold-small-parts": "{strength: hard, corner: 0.2 mm}"})]),
        ),
        [*LASER, *given(**{"rules__hold-small-parts": "hard"})],
        "facts",
    ),
    Advice(
        "pieces, expected {MOST_PIECES:,} at the most: give a larger grid",
        r"cuts\.scrap\.grid: 20 mm cuts a sheet of 4000 x 3000 mm into 30,000 pieces",
        parts(A, width=4000, height=3000),
        (Do("a larger grid", given(cuts__scrap__grid="500 mm")),),
        given(cuts__scrap__grid="20 mm"),
        "facts",
    ),
    Advice(
        "the nest has scrap lines of its own, and the profile asks for others (cuts.scrap)",
        r"the nest has scrap lines of its own, and the profile asks for others",
        drawn(SCRAP),
        (
            Do("leave one of them out", given(drawing__scrap_lines="cut")),
            Do("leave one of them out", given(drawing__scrap_lines="ignore", cuts__scrap__grid="100 mm")),
        ),
        given(drawing__scrap_lines="cut", cuts__scrap__grid="100 mm"),
        "facts",
    ),
    Advice(
        "(cuts.common.accept_loss): leave a web there",
        r"an edge that touches another part cannot lose half a kerf, 0\.75 mm",
        parts(part("A", rect(20, 20, 80, 60), holes=[circle(95, 50, 4.5)]), part("B", rect(100, 20, 80, 60))),
        (
            Do("leave a web there", given(cuts__common="{shortest: 20 mm, accept_loss: true, good_side: any}"),
               parts(part("A", rect(20, 20, 80, 60), holes=[circle(95, 50, 4.5)]), part("B", rect(110, 20, 80, 60)))),
        ),
        given(cuts__common="{shortest: 20 mm, accept_loss: true, good_side: any}"),
        "facts",
    ),
    Advice(
        "cuts.common: {shortest: 20 mm, accept_loss: true}",
        r"cut: 1 part that shares an edge with another, which one cut makes",
        drawn(([(60, 20), (100, 20), (100, 50), (60, 50)], "0", False)),
        (
            Do(
                "cuts.common: {shortest: 20 mm, accept_loss: true}",
                [*LASER, *SHARED, *given(cuts__common="{shortest: 20 mm, accept_loss: true}")],
                shows="ok: every hard rule holds",
            ),
        ),
        [*LASER],
        "solve",
    ),
]  # fmt: skip
