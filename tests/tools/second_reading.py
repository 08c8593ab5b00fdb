"""Drawings read by programs that share nothing with kerfwise, against what kerfwise takes them for.

Usage: python -m kerfwise.tests.tools.second_reading FOLDER|FILE… [-p PROFILE]… [--svg PROFILE] [--plan [--alone]]

SVG is rendered by resvg, DXF is read by GDAL. Every line that they show has to be cut, marked or said (left out, the
sheet, a question), and every line that is cut has to be shown. Questions are answered by their likeliest choices. With
`--plan` each file is planned, too, as `kerfwise solve` does it, by a little work: with the first profile of those given
that a plan is found with. With `--alone` files are planned and not compared.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import os
import re
import resource
import shlex
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import shapely

from kerfwise import InputError, Questions
from kerfwise.arrays import Bools
from kerfwise.cli import main as kerfwise
from kerfwise.encoder.readers.options import ReadOptions, mm_of
from kerfwise.encoder.readers.read import Seen, seen
from kerfwise.rule_kit import Curve
from kerfwise.rules.profile.load import load_profile

PIXELS = 2400
"""Longer side of a rendered SVG."""
NEAR_PX = 2.5
"""How far a line may lie off what is rendered, pixels, half the pen's width included."""
NEAR_MM = 0.25
"""How far a line of a DXF may lie off what is known of it: gaps are joined, flattened arcs are made again."""
ARC_STEP_DEG = 0.5
"""GDAL gives arcs as chords; those of its own, of 4°, lie 0.27 mm off an arc of 450 mm radius."""
SHARE = 0.002
"""Less than this share of the length of all lines is noise of pixels and of joined gaps."""


@dataclass(frozen=True, slots=True)
class Judged:
    """How a file came out: planned, asked or refused; mm of lines shown and not known, and cut and not shown."""

    file: Path
    ended: str
    unseen_mm: float = 0.0
    unshown_mm: float = 0.0
    why: str = ""

    @property
    def differs(self) -> bool:
        """Whether the two readings differ by more than noise."""
        return self.unseen_mm > 0 or self.unshown_mm > 0


def answered(file: Path, options: ReadOptions) -> tuple[Seen, int]:
    """The file with the likeliest answer to each question, and how many questions that took."""
    count = 0
    for _ in range(6):
        found = seen(file, options)
        if not isinstance(found.error, Questions):
            return found, count
        answers = {q.id: q.choices[0].value for q in found.error.questions}
        count += len(answers)
        options = replace(options, answers=(*options.answers, *answers.items()))
    return found, count


def judged(file: Path, options: ReadOptions) -> Judged:
    """One file, read twice."""
    try:
        found, questions = answered(file, options)
    except InputError as error:
        return Judged(file, "refused", why=str(error).splitlines()[0])
    if found.error is not None or found.nest is None:
        return Judged(file, "refused", why=str(found.error).splitlines()[0])
    ended = f"asked ({questions})" if questions else "planned"
    known = [curve for _, curve in found.lines]
    cut = [curve for kind, curve in found.lines if kind in ("cut", "mark")]
    if found.reading is not None and file.suffix.lower() == ".dxf":  # GDAL gives texts as points
        written = {name for text in found.reading.writings for name in text.marks}
        strokes = {id(c.curve) for c in found.nest.contours if c.id in written}
        cut = [curve for curve in cut if id(curve) not in strokes]
    if file.suffix.lower() == ".json":
        return Judged(file, ended)
    if file.suffix.lower() == ".svg":
        unseen, unshown = by_raster(file, found, known, cut)
    else:
        unseen, unshown = by_lines(file, found, known, cut, options)
    total = sum(curve.length_mm for curve in known)
    return Judged(file, ended, *(mm if mm > SHARE * total else 0.0 for mm in (unseen, unshown)))


WORK = 0.05
"""The work of a plan, unless `--work` says another: enough for the first good one."""
MOST_CPU_S = 60
"""A plan that takes more processor time than this is none, unless `--cpu` says another limit."""
ASKS = 3
ENDS = {0: "planned", 1: "no plan", 2: "refused", ASKS: "asked on and on"}
MOST_ANSWERS = 20
_FLAG = re.compile(r"^ +--answer (\S.*?)(?:   |$)")


@dataclass(frozen=True, slots=True)
class Planned:
    """How `kerfwise solve` ended, with how many answers, what it said, under which profile, in how much CPU time."""

    ended: str
    answers: int
    said: str
    profile: str
    cpu_s: float

    def told(self) -> str:
        """The end of a row."""
        return f"{self.ended} ({self.answers} answered, {self.profile}, {self.cpu_s:.0f} s): {self.said}"


def best_planned(file: Path, profiles: Sequence[str], most_cpu_s: int, work: float = WORK) -> Planned:
    """The plan with the first profile that there is one with, else what the first profile led to."""
    tries = []
    for profile in profiles:
        tries.append(planned(file, profile, most_cpu_s, work))
        if tries[-1].ended == "planned":
            return tries[-1]
    return tries[0]


def planned(file: Path, profile: str, most_cpu_s: int = MOST_CPU_S, work: float = WORK) -> Planned:
    """How `kerfwise solve` ends with the likeliest answer to each question, how many these are, and what it says.

    Each try runs in a copy of this process, which has loaded all that planning needs.
    """
    answers: list[str] = []
    began = resource.getrusage(resource.RUSAGE_CHILDREN)
    with tempfile.TemporaryDirectory() as folder:
        while True:
            words = ["solve", str(file.resolve()), "-p", profile, "--no-job", "--work", str(work), "-o", "out.nc"]
            words += [word for answer in answers for word in ("--answer", answer)]
            run = get_context("fork").Process(target=_solve, args=(words, Path(folder), most_cpu_s))
            run.start()
            run.join()
            out, err = (Path(folder, name).read_text(encoding="utf-8") for name in ("out", "err"))
            if run.exitcode != ASKS or len(answers) > MOST_ANSWERS:
                break
            answers += likeliest(err)
    ended = ENDS.get(run.exitcode or 0, f"ended by {run.exitcode}")
    now = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu_s = now.ru_utime + now.ru_stime - began.ru_utime - began.ru_stime
    if ended == "planned":
        said = next((line for line in reversed(out.splitlines()) if line[:2] == "ok"), "")
    else:
        said = " | ".join(line[-160:] for line in err.splitlines()[-3:])
    return Planned(ended, len(answers), said, profile, cpu_s)


def _load() -> None:
    """Plan a small nest in this process, so that its copies find everything loaded."""
    rings = [
        [[x, y], [x + 20, y], [x + 20, y + 20], [x, y + 20]] for x in range(10, 310, 40) for y in range(10, 310, 40)
    ]
    nest = {"format": "kerfwise-nest/1", "sheet": {"width": 330, "height": 330}}
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "nest.json")
        file.write_text(json.dumps({**nest, "parts": [{"id": f"P{k}", "outer": ring} for k, ring in enumerate(rings)]}))
        words = ["solve", str(file), "--no-job", "--work", str(WORK), "-o", str(Path(folder, "out.nc"))]
        with contextlib.suppress(SystemExit), contextlib.redirect_stdout(io.StringIO()):
            kerfwise(words)


def _solve(words: list[str], folder: Path, most_cpu_s: int) -> None:
    """Run the command in a folder, with what it prints in the files `out` and `err` there."""
    resource.setrlimit(resource.RLIMIT_CPU, (most_cpu_s, most_cpu_s))
    os.chdir(folder)
    with open("out", "w", encoding="utf-8") as sys.stdout, open("err", "w", encoding="utf-8") as sys.stderr:
        kerfwise(words)


def likeliest(told: str) -> list[str]:
    """The first flag of each question in what a command has printed."""
    found: list[str] = []
    first = False
    for line in told.splitlines():
        if re.match(r" +\d+\. ", line):
            first = True
        elif first and (flag := _FLAG.match(line)):
            found += shlex.split(flag[1])
            first = False
    return found


def by_lines(
    file: Path, found: Seen, known: Sequence[Curve], cut: Sequence[Curve], options: ReadOptions
) -> tuple[float, float]:
    """What GDAL shows and is not known, and what is cut and GDAL does not show, mm.

    GDAL draws dimensions and leaders, too. These are said, by their types or as on a layer that is left out.
    """
    import pyogrio

    pyogrio.set_gdal_config_options({"OGR_ARC_STEPSIZE": ARC_STEP_DEG})
    data = file.read_bytes()
    if b"HEADER" not in data[:2000]:  # by which GDAL knows the format
        data = b"  0\nSECTION\n  2\nHEADER\n  0\nENDSEC\n" + data
    with tempfile.TemporaryDirectory() as folder:
        (copy := Path(folder, "drawing.dxf")).write_bytes(data)
        meta, _, wkb, columns = pyogrio.raw.read(str(copy))
    row = dict(zip(meta["fields"], columns, strict=True))
    nothing = [None] * len(wkb)
    kinds = _kinds(data)
    said_of, hidden = _said(found), _hidden(found)
    types = [kinds.get(str(handle), "") for handle in row.get("EntityHandle", nothing)]
    said = [
        text is not None
        or kind in said_of
        or str(layer) in hidden
        or (kind in ANNOTATIONS and options.layers.use([str(layer)]).purpose == "ignore")
        for text, kind, layer in zip(row.get("Text", nothing), types, row.get("Layer", nothing), strict=True)
    ]
    scale = 1.0 if found.reading is None else mm_of(found.reading.units) or 1.0
    shown = [
        (line, kind)
        for shape, kind, is_said in zip(shapely.from_wkb(wkb), types, said, strict=True)
        if shape is not None and not is_said
        for line in _lines_of(shapely.transform(shapely.force_2d(shape), lambda points: points * scale))
    ]
    lines = [curve.line(0.01) for curve in known]
    bands = [_chords_mm(line) for line, kind in shown if kind == "SPLINE"]
    unseen = _off([line for line, kind in shown if kind != "SPLINE"], lines, NEAR_MM)
    unseen += sum(
        _off([line], lines, band) for (line, _), band in zip((s for s in shown if s[1] == "SPLINE"), bands, strict=True)
    )
    others = [shapely.buffer(line, _chords_mm(line)) if kind == "SPLINE" else line for line, kind in shown]
    return unseen, _off([curve.line(0.01) for curve in cut], others, NEAR_MM)


def _chords_mm(line: shapely.Geometry) -> float:
    """How far the chords of a spline, as GDAL gives them at even steps, may lie off its corners."""
    steps = np.hypot(*np.diff(shapely.get_coordinates(line), axis=0).T)
    return NEAR_MM + float(steps.max(initial=0.0)) / 2


ANNOTATIONS = frozenset({"DIMENSION", "LEADER", "MULTILEADER", "MLEADER"})
"""Types of a DXF file that are drawn by lines, and are none."""


def _kinds(data: bytes) -> dict[str, str]:
    """The type of each entity of an ASCII file by its handle, by the file's own words."""
    lines = [line.strip() for line in data.decode("utf-8", "replace").splitlines()]
    found: dict[str, str] = {}
    kind = ""
    for code, value in zip(lines[::2], lines[1::2], strict=False):
        if code == "0":
            kind = value
        elif code == "5":
            found.setdefault(value, kind)
    return found


def _hidden(found: Seen) -> set[str]:
    """The layers of which the reader says that what is on them is not shown."""
    notes = [] if found.nest is None else [note.text for note in found.nest.notes]
    told = (text for text in notes if text.startswith("left out, as they are invisible"))
    return {layer for text in told for layer in re.findall(r"on '([^']+)'", text)}


def _said(found: Seen) -> set[str]:
    """The types of entities that the reader says are left out."""
    notes = [] if found.nest is None else [note.text for note in found.nest.notes]
    return {kind for kind in ANNOTATIONS for text in notes if "left out" in text and f" {kind}" in text}


def _lines_of(shape: shapely.Geometry) -> Iterator[shapely.Geometry]:
    for one in shapely.get_parts(shape):
        if one.geom_type in ("LineString", "LinearRing"):
            yield one
        elif one.geom_type == "Polygon":  # a filling
            continue
        elif one.geom_type.startswith(("Multi", "Geometry")):
            yield from _lines_of(one)


def _off(lines: Sequence[shapely.Geometry], others: Sequence[shapely.Geometry], near: float) -> float:
    """Length of lines that lie further from all others."""
    if not lines:
        return 0.0
    tree = shapely.STRtree(others)
    off = 0.0
    for line in lines:
        count = max(2, min(2000, int(line.length / 1.0)))
        points = shapely.line_interpolate_point(line, np.linspace(0.0, 1.0, count), normalized=True)
        close = np.zeros(count, dtype=bool)
        if len(others):
            close[np.unique(tree.query(points, predicate="dwithin", distance=near)[0])] = True
        off += line.length * float((~close).mean())
    return off


def by_raster(file: Path, found: Seen, known: Sequence[Curve], cut: Sequence[Curve]) -> tuple[float, float]:
    """What resvg shows and is not known, and what is cut and resvg does not show, mm."""
    from scipy import ndimage

    text = _sized(_with_box(file.read_text(encoding="utf-8", errors="replace"), found, known))
    ink = _inked(text)
    assert found.nest is not None
    page = _page(file, found, known)
    mm = page[2] / ink.shape[1]
    edges = ink & ~ndimage.binary_erosion(ink, iterations=2, border_value=1)
    pen = ink & ~ndimage.binary_opening(ink, iterations=4)
    drawn = edges | pen
    lines = shapely.union_all([shapely.LineString(_pixels(curve, page, mm)) for curve in known])
    ys, xs = np.nonzero(drawn)
    tree = shapely.STRtree(shapely.get_parts(lines))
    points = shapely.points(xs + 0.5, ys + 0.5)
    near = np.unique(tree.query(points, predicate="dwithin", distance=NEAR_PX + 3.0 + _pen_px(text, mm))[0])
    unseen = (len(points) - len(near)) * mm
    if found.reading is not None and found.reading.answers.get("clip") == "clipped":  # closed along what clips
        ink = ink | _inked(_with_clips(text))
    away = ndimage.distance_transform_edt(~ink)
    unshown = 0.0
    for curve in cut:
        line = shapely.LineString(_pixels(curve, page, mm))
        count = max(2, min(4000, int(line.length)))
        at = shapely.get_coordinates(shapely.line_interpolate_point(line, np.linspace(0, 1, count), normalized=True))
        inside = (at >= 0).all(axis=1) & (at[:, 0] < ink.shape[1]) & (at[:, 1] < ink.shape[0])
        x, y = at[inside].astype(int).T
        unshown += curve.length_mm * float((away[y, x] > NEAR_PX + 1.0).sum()) / count
    return unseen, unshown


def _inked(text: str) -> Bools:
    """Where resvg shows anything."""
    import resvg_py
    from PIL import Image

    png = resvg_py.svg_to_bytes(svg_string=text, width=PIXELS, dpi=96, skip_system_fonts=True)
    picture = np.asarray(Image.open(io.BytesIO(bytes(png))).convert("RGBA"), dtype=np.float64)
    return np.asarray(picture[:, :, 3] > 60)


def _with_clips(text: str) -> str:
    """The file with its clipping paths drawn as lines, and nothing clipped."""
    drawn = re.sub(r"<(/?)defs\b", r"<\1g", text).replace("<clipPath", '<g fill="none" stroke="black"')
    return re.sub(r"clip-path", "no-clip", drawn.replace("</clipPath", "</g"))


def _sized(text: str) -> str:
    """The file with a size where it has a viewBox alone: resvg rounds that to whole units, which is coarse."""
    root = re.search(r"<svg\b[^>]*>", text)
    box = re.search(r"viewBox=[\"']([^\"']+)", root[0]) if root else None
    if root is None or box is None or re.search(r"\s(width|height)=", root[0]):
        return text
    _, _, width, height = map(float, re.split(r"[\s,]+", box[1].strip()))
    size = f'<svg width="{PIXELS}" height="{round(PIXELS * height / width)}"'
    return text.replace("<svg", size, 1)


def _pen_px(text: str, mm: float) -> float:
    """Half the width of the widest pen, as far as the file says it; 1 unit where it does not."""
    widths = [float(w) for w in re.findall(r"stroke-width\s*[:=]\s*[\"']?\s*([0-9.]+)", text)] or [1.0]
    box = re.search(r"viewBox=[\"']\s*[-0-9.eE]+[\s,]+[-0-9.eE]+[\s,]+([0-9.eE]+)", text)
    per_unit = PIXELS / float(box[1]) if box else 25.4 / 96 / mm
    return max(widths) * per_unit / 2


def _box(known: Sequence[Curve]) -> tuple[float, float, float, float]:
    """A page around all lines, mm, for a file that has none."""
    x0, y0, x1, y1 = shapely.total_bounds([curve.line() for curve in known]).tolist()
    more = 0.05 * max(x1 - x0, y1 - y0)
    return x0 - more, y0 - more, x1 + more, y1 + more


def _with_box(text: str, found: Seen, known: Sequence[Curve]) -> str:
    """The file with a viewBox around all that is known of it, where it says nothing of its size."""
    root = re.search(r"<svg\b[^>]*>", text)
    if root is None or re.search(r"\s(width|height|viewBox)=", root[0]) or found.reading is None:
        return text
    scale = mm_of(found.reading.units) or 1.0
    x0, y0, x1, y1 = (side / scale for side in _box(known))
    return text.replace("<svg", f'<svg viewBox="{x0} {-y1} {x1 - x0} {y1 - y0}"', 1)


def _page(file: Path, found: Seen, known: Sequence[Curve]) -> tuple[float, float, float]:
    """Left edge and top of the page in mm, and its width."""
    from kerfwise.encoder.readers.svg import parsed_svg
    from kerfwise.encoder.readers.svg_viewports import page_of

    reading = found.reading
    units = None if reading is None or reading.units_because.startswith("the page's width") else reading.units
    svg = parsed_svg(file.read_bytes())
    page = page_of(svg, ReadOptions(units=units), file.read_bytes())
    if page.sheet is None:
        x0, _, x1, y1 = _box(known)
        return x0, y1, x1 - x0
    x0, _, x1, y1 = page.sheet.bounds
    dots = 1.0 if svg.viewbox or units is None else (mm_of(units) or 1.0) * 96 / 25.4  # resvg counts 96 an inch
    measured = str(svg.values.get("width", "")).strip().endswith(("mm", "cm", "in"))
    return x0, y1, (x1 - x0) * (dots if measured else 1.0)


def _pixels(curve: Curve, page: tuple[float, float, float], mm: float) -> list[tuple[float, float]]:
    points = shapely.get_coordinates(curve.line(0.02))
    return [((x - page[0]) / mm, (page[1] - y) / mm) for x, y in points.tolist()]


def files_in(given: Sequence[str]) -> list[Path]:
    """Drawings among files and folders."""
    found = []
    for name in map(Path, given):
        inside = sorted(name.rglob("*")) if name.is_dir() else [name]
        found += [file for file in inside if file.suffix.lower() in (".dxf", ".json", ".svg")]
    return found


def main(argv: Sequence[str] | None = None) -> int:
    """Read all files twice, print a row for each that is refused or differs, and the sums."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", metavar="FOLDER|FILE")
    parser.add_argument("-p", "--profile", action="append", help="repeatable: the first that a plan is found with")
    parser.add_argument("--cpu", type=int, default=MOST_CPU_S, metavar="S", help="processor time of a plan at most")
    parser.add_argument("--work", type=float, default=WORK, metavar="W", help="the work of a plan")
    parser.add_argument("--alone", action="store_true", help="plan, and do not compare")
    parser.add_argument("--svg", metavar="PROFILE", help="the profile for SVG files")
    parser.add_argument("--plan", action="store_true", help="plan each file, too")
    parser.add_argument("-v", "--verbose", action="store_true", help="a row for each file")
    asked = parser.parse_args(argv)
    if asked.plan:
        _load()
    rows, plans = [], Counter[str]()
    for file in files_in(asked.files):
        profiles = asked.profile or ["plasma-carbon-steel"]
        profiles = [asked.svg] if asked.svg and file.suffix.lower() == ".svg" else profiles
        try:
            options = load_profile(profiles[0]).read_options()
            row = Judged(file, "-") if asked.alone else judged(file, options)
        except Exception as error:  # the other program's own trouble
            row = Judged(file, "not compared", why=f"{type(error).__name__}: {error}")
        rows.append(row)
        plan = ""
        if asked.plan:
            made = best_planned(file, profiles, asked.cpu, asked.work)
            plan = made.told()
            plans[f"{made.ended} after answers" if made.ended == "planned" and made.answers else made.ended] += 1
        if asked.verbose or row.differs or row.why:
            away = f"{row.unseen_mm:9.1f} {row.unshown_mm:9.1f}"
            print(f"{file.name[-50:]:50} {row.ended:12} {away} {row.why[:150]} {plan[:300]}", flush=True)
    ends = Counter(row.ended.split()[0] for row in rows)
    differs = sum(row.differs for row in rows)
    print(f"{len(rows)} files: {', '.join(f'{n} {end}' for end, n in sorted(ends.items()))}; {differs} differ")
    if asked.plan:
        print(f"of them {', '.join(f'{n} {end}' for end, n in sorted(plans.items()))}")
    return 1 if differs else 0


if __name__ == "__main__":
    sys.exit(main())
