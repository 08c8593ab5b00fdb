"""A dialect is tried before anything is planned: a program of one cut and one mark is written in it and read back.

A file of a plant's own may be sound as YAML and yet name words that the control does not know, or knows as something
else. Then every plan would fail in the check. So each word is looked at by what the check's own reader makes of it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import zip_longest

import numpy as np

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point, Segment
from kerfwise.postproc.check.reader.controls import Control, Setup
from kerfwise.postproc.check.reader.own_words import control_for
from kerfwise.postproc.check.reader.program import Burn, NcProgram
from kerfwise.postproc.check.reader.rs274 import read_nc
from kerfwise.postproc.dialects import Dialect, fitting_dialect, own_wait_s, plant_words
from kerfwise.postproc.nc.gcode import GcodeWriter, comment, number_blocks, pieces_of_arc, with_subprograms
from kerfwise.postproc.nc.program import NEWLINES, header_blocks, opening
from kerfwise.rules.options.yaml_positions import place_in, wrong_at
from kerfwise.rules.profile.plant_sections import ENDINGS
from kerfwise.rules.profile.technique import Technique

_CUT = Curve.of([(20.0, 10.0, 0.0), (30.0, 10.0, 0.3), (40.0, 20.0, -0.4), (55.0, 25.0, 0.0)], closed=False)
_MARK = Curve.of([(60.0, 5.0, 0.0), (70.0, 5.0, 0.0)], closed=False)
_FEED_MM_S, _DWELL_S = 12.5, 1.5
_NEAR_MM, _SHARE = 0.02, 1e-3
_INCH_MM = 25.4
_SAID = "KERFWISE READS THIS BACK"
_HOME = (0.0, 0.0)
_WAY_OUT = (
    "a word that touches neither the path nor the torch is named under also, one of the control's own under reads"
)


@dataclass(frozen=True, slots=True)
class _Line:
    """A block, and the key of the dialect that it comes of."""

    key: str
    block: str


def trusted_dialect(profile: Technique) -> Dialect:
    """The dialect of the profile's machine, once a small program in it has been read back as it was meant.

    Raises InputError as `fitting_dialect`; and where a word does not do on the control what it is there for: with the
    key, and its place in the dialect's file.
    """
    dialect = fitting_dialect(profile)
    read_back(dialect, profile.machine.dialect, plant_words(dialect, profile))
    return dialect


def read_back(dialect: Dialect, name: str, plant: Mapping[str, str] | None = None) -> None:
    """Write the small program in a dialect and read it; `name` is what a profile calls the dialect by.

    `plant` is what the profile says of the material, for blocks that say it too. Raises InputError for the first word
    that the control does not know, or knows as something else.

    Examples
    --------
    >>> from kerfwise.postproc.dialects import dialect_names, load_dialect
    >>> for name in dialect_names():
    ...     read_back(load_dialect(name), name)
    """
    plant = plant_words(dialect) if plant is None else plant
    control = control_for(dialect, name)
    pen = GcodeWriter(dialect, _HOME, plant=plant)
    lines = [*_header(dialect, plant), *_run("torch", _CUT, pen)]
    if dialect.marks:
        lines += _run("mark", _MARK, pen)
    lines += [_Line("rapid", pen.rapid(_HOME)), *(_Line("footer", block) for block in dialect.footer)]
    lines = [line for line in lines if line.block]

    def wrong(key: str, what: str) -> InputError:
        place = place_in(name, (key,)) if name.endswith(ENDINGS) else None
        text = f"{key}: {what} (the dialect {dialect.name} says that its control is {control.title})"
        return wrong_at(place, text) if place is not None else InputError(f"dialect {name}: {text}")

    blocks: list[str] = []
    numbers = number_blocks([line.block for line in lines], dialect)
    for line in lines:
        try:
            blocks.append(next(numbers))
        except InputError:
            raise wrong(line.key, f"{line.block[:60]!r}… is longer than max_line, {dialect.max_line}") from None
    text = NEWLINES[dialect.newline].join([*blocks, ""])
    try:
        program = read_nc(text, control=control, setup=Setup(home=_HOME))
    except InputError as error:
        line = lines[min(error.line or len(lines), len(lines)) - 1]
        raise wrong(line.key, f"{line.block!r} cannot be read: {error.message}; {_WAY_OUT}") from None
    for key, what in _misread(program, lines, dialect, control):
        raise wrong(key, what)
    if dialect.subprogram is not None and (what := _called_wrong(dialect, control, plant)):
        raise wrong("subprogram", what)
    if dialect.kerf is not None and (what := _beside_wrong(dialect, control, plant)):
        raise wrong("kerf", what)


def _beside_wrong(dialect: Dialect, control: Control, plant: Mapping[str, str]) -> str:
    """What is wrong with paths beside which the control keeps the torch, left and right; "" for nothing."""
    kerf_mm = float(plant["kerf"] or 1.0) * (_INCH_MM if dialect.inch else 1.0)
    pen = GcodeWriter(dialect, _HOME, plant=plant)
    pen.kerf_mm = kerf_mm
    body, paths = list(header_blocks(dialect, plant)), []
    for left, ends in (
        (True, ((20.0, 40.0), (60.0, 40.0), (60.0, 80.0))),
        (False, ((20, 80.0), (60, 80.0), (60, 40.0))),
    ):
        paths.append(path := Curve.of(ends, closed=False))
        body += [*pen.select(False), *pen.beside(path, left), *pen.start(False, 0.0, _FEED_MM_S)]
        body += [*pen.path(path, _FEED_MM_S, left=left), *pen.stop(False)]
        body += pen.others([dialect.kerf.off] if dialect.kerf is not None else [])
    text = "\n".join([*number_blocks([*body, pen.rapid(_HOME), *dialect.footer], dialect), ""])
    try:
        program = read_nc(text, control=replace(control, kerf_mm=kerf_mm), setup=Setup(home=_HOME))
    except InputError as error:
        return f"a path beside which the control keeps the torch cannot be read: {error.message}"
    for path, burn in zip_longest(paths, program.burns):
        if path is None or burn is None or _apart_mm(path, burn.path) > 2 * (_NEAR_MM + dialect.step_mm):
            return "the torch is read to be elsewhere than half the kerf beside the path: left and right are its sides"
    return "; ".join(fault.text for fault in program.faults)


def _apart_mm(one: Curve, other: Curve) -> float:
    """How far the corners of two paths are from the other path, and their ends from each other."""
    ends = zip(one.vertices[[0, -1], :2], other.vertices[[0, -1], :2], strict=True)
    corners = [path.project((x, y))[1] for path, of in ((one, other), (other, one)) for x, y, _ in of.vertices.tolist()]
    return max(*corners, *(float(np.hypot(*(a - b))) for a, b in ends))


def _called_wrong(dialect: Dialect, control: Control, plant: Mapping[str, str]) -> str:
    """What is wrong with a path that is written once and called at two places; "" for nothing."""
    pen, places = GcodeWriter(dialect, _HOME, plant=plant), ((0.0, 0.0), (100.0, 50.0))
    body = list(header_blocks(dialect, plant))
    for x, y in places:
        path = _CUT.moved(x, y)
        body += [*pen.select(False), pen.rapid(path.point_at(0.0)), *pen.start(False, 0.0, _FEED_MM_S)]
        body += [*pen.called_path(path, _FEED_MM_S, None, ()), *pen.stop(False)]
    text = "\n".join(
        [*number_blocks([*with_subprograms([*body, pen.rapid(_HOME), *dialect.footer], dialect)], dialect), ""]
    )
    try:
        burns = read_nc(text, control=control, setup=Setup(home=_HOME)).burns
    except InputError as error:
        return f"a path that is called cannot be read: {error.message}"
    off_mm = [
        burn.path.project((px + x, py + y))[1]
        for burn, (x, y) in zip(burns, places, strict=False)
        for px, py in _CUT.flatten(_NEAR_MM).tolist()
    ]
    if len(burns) != len(places) or max(off_mm, default=1.0) > _NEAR_MM * 2 + dialect.step_mm + dialect.chord_mm:
        return "a path that is called twice is read as another one"
    return ""


def _header(dialect: Dialect, plant: Mapping[str, str]) -> Iterator[_Line]:
    lines, first = [_Line("header", block) for block in header_blocks(dialect, plant)], opening(dialect)
    return iter([*lines[:first], _Line("comment", comment(dialect, _SAID)), *lines[first:]])


def _run(tool: str, path: Curve, pen: GcodeWriter) -> Iterator[_Line]:
    """Travel to a path, the tool on, a wait, the path, the tool off."""
    marks, wait = tool == "mark", pen.wait(_DWELL_S)
    dwell_s = _DWELL_S if marks else _DWELL_S + own_wait_s(pen.dialect)
    yield from (_Line(f"{tool}_station", block) for block in pen.select(marks))
    yield _Line("rapid", pen.rapid(path.point_at(0.0)))
    yield from (
        _Line("dwell" if block in wait else f"{tool}_on", block) for block in pen.start(marks, dwell_s, _FEED_MM_S)
    )
    blocks = pen.path(path, _FEED_MM_S)
    if pen.dialect.feed_alone and blocks[0] == pen.feed_word(_FEED_MM_S):
        yield _Line("feed", blocks.pop(0))
    words = ["line", "arc_ccw", "arc_cw", "line"] if tool == "torch" else ["line"]
    yield from (_Line(word, block) for word, block in zip(_spread(words, len(blocks)), blocks, strict=True))
    yield from (_Line(f"{tool}_off", block) for block in pen.stop(marks))


def _spread(words: list[str], blocks: int) -> list[str]:
    """A word a block; where arcs come in pieces, all blocks between the first and the last are taken for arcs."""
    if len(words) == blocks:
        return words
    return [words[0], *["arc_ccw"] * (blocks - 2), words[-1]]


def _misread(program: NcProgram, lines: list[_Line], dialect: Dialect, control: Control) -> Iterator[tuple[str, str]]:
    """Keys whose words are read as something else, and what is read."""
    if dialect.comment is not None and not any(_SAID in comment for comment in program.comments):
        yield "comment", f"{lines[0].block!r} is not read as a comment"
    near_mm = _NEAR_MM + max(control.step_mm, dialect.step_mm)
    begun = {_started_by(burn, lines): burn for burn in reversed(program.burns)}
    tools = [("torch", 0, _CUT), *([("mark", 1, _MARK)] if dialect.marks else [])]
    for tool, number_of, path in tools:
        on, off = (" and ".join(line.block for line in lines if line.key == f"{tool}_{way}") for way in ("on", "off"))
        burn = begun.get(f"{tool}_on")
        if burn is None:
            yield f"{tool}_on", f"{on!r} does not start the {_spoken(tool)}"
        elif (burn.tool == 0) != (number_of == 0):
            yield f"{tool}_on", f"{on!r} starts what {'cuts' if burn.tool == 0 else 'marks'}"
        elif (moves := _after(program, lines, f"{tool}_off")) is not None:
            yield f"{tool}_off", f"{off!r} does not stop the {_spoken(tool)}: it is still on at {moves!r}"
        else:
            yield from _moved_wrong(burn, path, dialect, near_mm)
    for stretch in program.slow_travel:
        line = lines[stretch.line - 1]
        if line.key == "rapid" and dialect.travels_as_line:
            continue
        yield line.key, f"{line.block!r} moves at the feed of a cut with nothing on"
    for fault in program.faults:
        at = lines[min(max(fault.line, 1), len(lines)) - 1]
        key = "header" if fault.rule == "program-state" and "before it has said" in fault.text else at.key
        yield key, f"of {at.block!r} the check says: {fault.text}"
    if np.hypot(program.end[0] - _HOME[0], program.end[1] - _HOME[1]) > near_mm:
        yield "footer", "the program ends elsewhere than it is sent to"


def _started_by(burn: Burn, lines: list[_Line]) -> str:
    """The key of the last block that switches something on, up to where a burn begins."""
    return next((line.key for line in lines[burn.line - 1 :: -1] if line.key.endswith("_on")), "")


def _after(program: NcProgram, lines: list[_Line], off: str) -> str | None:
    """The block after the word `off` that moves with a tool on, None where none does."""
    at = next(k for k, line in enumerate(lines, 1) if line.key == off)
    following = next((k for k in range(at + 1, len(lines) + 1) if lines[k - 1].key == "rapid"), len(lines))
    hot = any(stretch.line == following for stretch in program.hot_rapids)
    return lines[following - 1].block if hot else None


def _moved_wrong(burn: Burn, path: Curve, dialect: Dialect, near_mm: float) -> Iterator[tuple[str, str]]:
    """What is wrong with one burn's wait, feed and path."""
    if abs(burn.path.length_mm - _INCH_MM * path.length_mm) < _NEAR_MM * _INCH_MM and not dialect.inch:
        yield "header", "it leaves the control in inches: say units: inch, or have it say millimetres"
    if dialect.inch and abs(burn.path.length_mm - path.length_mm / _INCH_MM) < _NEAR_MM:
        yield "header", "it leaves the control in millimetres, and the dialect says units: inch"
    dwell_s = _DWELL_S if burn.tool else _DWELL_S + own_wait_s(dialect)
    if abs(burn.pierce_s - dwell_s) > _SHARE:
        yield "dwell", f"a wait of {dwell_s:g} s is read as one of {burn.pierce_s:g} s"
    if any(abs(feed - _FEED_MM_S) > _SHARE * _FEED_MM_S for feed in burn.feeds_mm_s):
        feeds = ", ".join(f"{feed * 60:g}" for feed in burn.feeds_mm_s)
        yield "feed", f"a feed of {_FEED_MM_S * 60:g} mm/min is read as {feeds} mm/min"
    most_mm = dialect.greatest_radius_mm
    too_large = most_mm is not None and any(s.is_arc and s.radius_mm > most_mm for s in path.segments)
    if dialect.arc_centre == "none" or too_large:
        far = [
            p for p in map(tuple, burn.path.vertices[:, :2].tolist()) if path.project(p)[1] > near_mm + dialect.chord_mm
        ]
        if far or abs(burn.path.length_mm - path.length_mm) > _SHARE * path.length_mm + near_mm:
            yield "line", f"a path of {path.length_mm:.2f} mm is read as one of {burn.path.length_mm:.2f} mm"
        return
    words = {0.0: "line", 1.0: "arc_ccw", -1.0: "arc_cw"}
    counted = [(segment, pieces_of_arc(segment, dialect)) for segment in path.segments]
    meant = [segment.between(k / count, (k + 1) / count) for segment, count in counted for k in range(count)]
    for asked, read in zip(meant, burn.path.segments, strict=False):
        word = words[float(np.sign(asked.bulge))]
        if (
            _bent_otherwise(asked, read, near_mm)
            or _far(asked.end, read.end, near_mm)
            or _far(asked.start, read.start, near_mm)
        ):
            spelt = getattr(dialect, word)
            what = "a line" if not read.bulge else f"an arc {'counter-clockwise' if read.bulge > 0 else 'clockwise'}"
            yield word, f"{spelt!r} makes {what} from {_at(read.start)} to {_at(read.end)}, not what was meant"
    if len(burn.path.segments) != len(meant):
        yield "line", f"a path of {len(meant)} lines and arcs is read as one of {len(burn.path.segments)}"


def _far(one: Point, other: Point, near_mm: float) -> bool:
    return float(np.hypot(one[0] - other[0], one[1] - other[1])) > near_mm


def _bent_otherwise(segment: Segment, read: Segment, near_mm: float) -> bool:
    slack = _SHARE + (near_mm - _NEAR_MM) * 4 / segment.chord_mm
    return abs(segment.bulge - read.bulge) > slack


def _at(point: Point) -> str:
    return f"({point[0]:.2f}, {point[1]:.2f})"


def _spoken(tool: str) -> str:
    return "torch" if tool == "torch" else "marking tool"
