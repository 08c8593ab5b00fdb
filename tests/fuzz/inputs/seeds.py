"""Good inputs of every kind, for damages to begin with: small, so that a case takes milliseconds."""

from __future__ import annotations

import io
import json
import math
import tempfile
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

import ezdxf
import yaml

import kerfwise as package

ROOT = Path(package.__file__).parent
PLASMA = "linuxcnc-qtplasmac"


@cache
def nest(name: str = "plain") -> Any:
    """A nest as JSON has it: `plain` has two squares, `rich` holes, a guest, marks, arcs and attributes."""
    if name == "plain":
        return {
            "format": "kerfwise-nest/1",
            "sheet": {"width": 400, "height": 200},
            "parts": [
                {"id": "A", "outer": [[20, 20], [120, 20], [120, 120], [20, 120]]},
                {"id": "B", "outer": [[150, 20], [250, 20], [250, 120], [150, 120]]},
            ],
        }
    quarter = math.tan(math.pi / 8)
    return {
        "format": "kerfwise-nest/1",
        "units": "mm",
        "sheet": {"outline": [[0, 0], [400, 0], [400, 200], [0, 200]], "holes": [[[380, 20], [390, 20], [390, 30]]]},
        "parts": [
            {
                "id": "A",
                "attributes": {"priority": 1, "customer": "x"},
                "outer": [[20, 20], [160, 20], [160, 160], [20, 160]],
                "holes": [[[40, 40], [140, 40], [140, 140], [40, 140]]],
            },
            {"id": "G", "outer": [[70, 70], [110, 70], [110, 110], [70, 110]]},
            {
                "id": "D",
                "outer": [[200, 60], [260, 60, quarter], [280, 80], [280, 140], [200, 140]],
                "holes": [[[230, 100, 1], [250, 100, 1]]],
                "marks": [[[205, 70], [225, 70, 0.2], [225, 90]]],
            },
        ],
    }


JOB = {
    "profile": "plant.yaml",
    "machine": "plant",
    "quantity": 3,
    "order": "4711",
    "due": "2026-12-24",
    "locks": ["A first", {"contour": "B.outer", "direction": "cw"}, "#2 after A", "no link B"],
    "tabs": {"A": "off", "B": [150, 70]},
    "set": {
        "leads.lead_in": "4 mm",
        "material": {"thickness": 8},
        "rules.pierce.clearance": "1.6 mm",
        "rules.hold-small-parts": "hard",
    },
}
JOB_WORDS = (
    "A first", "B before A", "#1 last", "#0 first", "#999999999 last", "A 5th", "A.outer entry (1e9, nan)", "no link",
    "no", "A position -1", "A tab off", "in zone", "A in zone 1", '"', "first", "A (", "A tab [1, 2", "rules.",
    "set", "locks", "based_on", "own_rules", "2026-13-01", "0000-00-00", "9999-12-31", "rules.pierce", "material.chart",
)  # fmt: skip


@cache
def nest_bytes(name: str = "plain") -> bytes:
    """The same as a file."""
    return json.dumps(nest(name)).encode()


@cache
def dialect_bytes(name: str) -> bytes:
    """A shipped dialect's file."""
    return resources.files("kerfwise.postproc.dialects").joinpath(f"{name}.yaml").read_bytes()


RICH = """
name: rich
based_on: plasma-carbon-steel
machine: {origin: sheet-corner, travel_x: [-10 mm, 3 m], travel_y: [-10, 2000], home: [1, 2], edge_preheat: 3 s}
material: {name: S355, thickness: 8 mm, kerf: 1.8 mm}
leads: {entries: 4, lead: arc, lead_out: line, edge_start: true, hole_overcut: {1 mm: 1 mm, 9 mm: 2 mm}}
small_holes: {min_hole: 5 mm, under: spot, full_feed_hole: 50 mm, spot_size: 3 mm}
cuts: {narrow: slit}
drawing: {units: mm, frame: sheet, open_lines: mark, margin: 5 mm, join_tolerance: 0.2 mm, layers: {cut: '^cut'}}
objective: {idle: 1, time: 2}
time: {model: acceleration, acceleration: 2 m/s2, corner_deviation: 0.1 mm}
prices: {machine_hour: 80, gas_hour: 9, currency: EUR}
heat: {model: logical, grid: 10 mm, limit_c: 200, logical_step: 2 s}
rules:
  zone-order: {zone_contours: 2, zone_heat: 900 kJ}
  heat-lag: {strength: hard, lag_cuts: 1, lag: 2 s}
  part-rigidity: off
  hull-before: {strength: soft, weight: 300}
locks:
  - {contour: A.outer, before: B.outer}
  - {contour: A.outer, direction: cw}
  - {contour: B.outer, last: true}
own_rules:
  - name: narrow first
    why: they warp
    select: {kind: outer, short_side_mm: "< 8"}
    before: {kind: outer, not: {short_side_mm: "< 8"}}
    scope: part
  - {name: spread, strength: soft, weight: 40 mm, select: {kind: outer}, apart: {cuts: 1, within: 90 mm}}
  - {name: not there, select: {id: "B*"}, no_pierce: {x_mm: 2..6}}
"""
OWN_RULES = """
name: own
based_on: plasma-carbon-steel
locks:
  - {contour: B.outer, position: 1}
own_rules:
  - {name: a, select: {attribute.priority: 1}, before: {attribute.priority: "> 1"}, scope: zone}
  - {name: b, select: {kind: [outer, hole], area_mm2: "> 5"}, direction: cw, strength: soft, weight: 20}
  - {name: c, select: {long: true}, together: true, scope: attribute.customer}
  - {name: d, select: {id: A.outer}, one_stays_while: {id: "B*"}}
  - {name: e, select: {depth: 0}, not_first: true, strength: off}
  - {name: f, select: {part: "?"}, entry: {left_gap_mm: "> 1"}}
"""
LASER = """
name: blocks
based_on: laser-amg3m-1mm
time: {model: blocks, feed_by_blocks: {0: 0.1 m/s, 100: 0.09 m/s}}
objective: {idle: 1, heat: 3}
rules: {t-max: {strength: hard, limit: 900, dwells: true, longest_dwell: 9 s}}
"""


@cache
def profiles() -> dict[str, bytes]:
    """Profiles by name: shipped ones, examples, and some that use many keys."""
    found = {path.stem: path.read_bytes() for path in sorted((ROOT / "rules/profile/shipped").glob("*.yaml"))}
    found |= {path.stem: path.read_bytes() for path in sorted((ROOT / "examples/profiles").glob("*.yaml"))}
    return found | {"rich": RICH.encode(), "own": OWN_RULES.encode(), "blocks": LASER.encode()}


@cache
def profile_tree(name: str) -> Any:
    """What a profile holds."""
    return yaml.safe_load(profiles()[name])


@cache
def profile_words() -> tuple[str, ...]:
    """Keys and words that profiles have."""
    words: set[str] = set()

    def gather(tree: Any) -> None:
        if isinstance(tree, dict):
            for key, value in tree.items():
                words.add(str(key))
                gather(value)
        elif isinstance(tree, list):
            for value in tree:
                gather(value)
        elif isinstance(tree, str) and len(tree) < 40:
            words.add(tree)

    for name in profiles():
        gather(profile_tree(name))
    return tuple(sorted(words))


@cache
def made(name: str) -> tuple[bytes, bytes]:
    """The program and the plan of a nest, by the default profile; `rich` after the first two cuts is `rest`."""
    from kerfwise.tests.commands.run_cli import kerfwise

    with tempfile.TemporaryDirectory() as folder:
        file, program, plan = (Path(folder) / name for name in ("nest.json", "made.nc", "made.plan.json"))
        file.write_bytes(nest_bytes("rich" if name == "rest" else name))
        words = ["solve", file, "--work", "0.05", "-o", program, "--plan", plan]
        ended = kerfwise(*words)
        assert ended.code == 0, ended.err
        if name == "rest":
            old = plan.rename(plan.with_name("old.json"))
            ended = kerfwise(*words, "--lock-from", old, "--upto", "2")
            assert ended.code == 0, ended.err
        return program.read_bytes(), plan.read_bytes()


@cache
def drawing(name: str) -> bytes:
    """A small DXF: `lines` with bulges, arcs and a block; `curves` with splines, ellipses, texts, nested blocks."""
    document = ezdxf.new("R12" if name == "lines" else "R2000")
    if name != "lines":
        document.units = 4
    space = document.modelspace()
    space.add_lwpolyline([(0, 0), (300, 0), (300, 200), (0, 200)], close=True, dxfattribs={"layer": "SHEET"}) if (
        name != "lines"
    ) else space.add_polyline2d([(0, 0), (300, 0), (300, 200), (0, 200)], close=True, dxfattribs={"layer": "SHEET"})
    corners = [(20, 20), (90, 20), (90, 90), (20, 90)]
    for a, b in zip(corners, [*corners[1:], corners[0]], strict=True):
        space.add_line(a, b)
    space.add_arc((60, 140), 20, 0, 180)
    space.add_line((40, 140), (80, 140))
    space.add_circle((55, 55), 10)
    space.add_polyline2d([(130, 20, 1), (170, 20, 1)], format="xyb", close=True)
    document.blocks.new("disc").add_circle((0, 0), 12)
    space.add_blockref("disc", (220, 150), dxfattribs={"xscale": 1.5, "yscale": 1.5})
    if name != "lines":
        space.add_ellipse((220, 60), major_axis=(30, 0), ratio=0.5)
        space.add_spline([(120, 120), (160, 120), (160, 160), (120, 160), (120, 120)])
        space.add_text("PART 1", dxfattribs={"layer": "TEXT"})
        space.add_lwpolyline([(30, 30), (40, 35)], dxfattribs={"layer": "MARK"})
        outer = document.blocks.new("nested")
        outer.add_blockref("disc", (0, 0), dxfattribs={"rotation": 30})
        space.add_blockref("nested", (270, 100), dxfattribs={"xscale": -1})
    stream = io.StringIO()
    document.write(stream)
    whole = stream.getvalue()
    keep = whole.index("  2\nBLOCKS")  # the geometry is a small share of the file: let the damage fall on it
    end = whole.find("  0\nSECTION\n  2\nOBJECTS")
    head = "  0\nSECTION\n  2\nHEADER\n  9\n$ACADVER\n  1\nAC1015\n  9\n$INSUNITS\n 70\n4\n  0\nENDSEC\n"
    body = whole[keep:] if end < 0 else whole[keep:end] + "  0\nEOF\n"
    return f"{head if name != 'lines' else ''}  0\nSECTION\n{body}".encode()


SVG = (
    b"""<svg xmlns="http://www.w3.org/2000/svg" width="300mm" height="200mm" viewBox="0 0 300 200">
<g id="sheet"><rect width="300" height="200"/></g>
<path d="M20 20 h70 a9 9 0 0 1 9 9 C 120 60 90 90 60 90 Q 30 80 20 60 z"/>
<circle cx="60" cy="50" r="9" transform="rotate(5)"/>
</svg>
""",
    b"""<?xml version="1.0" encoding="UTF-8"?>
<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"
 xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" width="300mm" height="200mm" viewBox="0 0 300 200">
<style>.mark { stroke: red } #hid { display: none } @media screen { rect { fill: none } }</style>
<defs><g id="d"><circle r="10"/></g><linearGradient id="l"/></defs>
<g inkscape:label="sheet"><path d="M0 0 H300 V200 H0 Z"/></g>
<g inkscape:label="cut" transform="translate(10,5) scale(1.2) skewX(3)" style="stroke: black; fill: none">
<rect x="20" y="20" width="60" height="50" rx="8"/><ellipse cx="140" cy="60" rx="30" ry="20"/>
<polygon points="20,100 80,100 80,150 20,150"/><use href="#d" x="50" y="125"/><use xlink:href="#d" x="200" y="40"/>
</g>
<g class="mark" inkscape:label="mark"><polyline points="110,120 150,120 150,130"/><line x1="9" x2="30" y1="9" y2="9"/>
<text x="5" y="9">P1</text></g><svg x="200" y="120" width="80" height="60" viewBox="0 0 40 30"><rect x="5" y="5"
width="20" height="15"/></svg>
</svg>
""",
)
SVG_WORDS = (
    *tuple(
        b"svg g path rect circle ellipse polygon polyline line use defs symbol style text image clipPath mask "
        b"switch marker "
        b"transform d points viewBox width height href id class fill stroke display none visibility hidden "
        b"matrix(1,0,0,1,0,0) "
        b"matrix(0,0,0,0,0,0) scale(0) scale(1e300) rotate(nan) translate(1e9) skewX(90) M0,0 z Z A0,0,0,0,0,1,1 "
        b"a1e9,1,0,1,1,3,3 "
        b'C1,1 Q S T V H m l 1e400 100% 5em 3px 2in mm preserveAspectRatio style="display:none" transform="scale(-1)" '
        b'href="#d" href="#sheet" href="file:///etc/passwd" viewBox="0 0 0 0" xml:base="x" <!DOCTYPE <!-- --> <![CDATA['
        b" ]]> <?xml?> &amp; &lt; &x; &#10; url(#l) !important @import calc(1px+2mm) var(--x) :not(*) *".split()
    ),
    b'<!DOCTYPE svg [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>',
    b'<!ENTITY x SYSTEM "file:///x">',
)
DXF_WORDS = tuple(
    b"LINE ARC CIRCLE LWPOLYLINE POLYLINE VERTEX SEQEND SPLINE ELLIPSE INSERT BLOCK ENDBLK TEXT MTEXT HATCH "
    b"POINT SOLID "
    b"3DFACE DIMENSION LEADER ATTRIB IMAGE MLINE RAY XLINE REGION BODY SECTION ENDSEC ENTITIES BLOCKS HEADER "
    b"TABLES EOF "
    b"$INSUNITS disc nested SHEET MARK 0 1 2 3 5 6 8 10 11 20 21 30 40 41 42 43 50 51 62 66 70 71 72 73 74 90 "
    b"91 100 102 "
    b"210 220 230 330 370 999 1000 1001 1071 -1".split()
)
NEST_WORDS = (
    "format", "kerfwise-nest/1", "units", "sheet", "width", "height", "outline", "holes", "parts", "id", "outer",
    "marks",
    "attributes", "quantity", "priority", "mm", "in", "ft", "A", "B", "G", "D", "name", "origin", "thickness",
    "material",
)  # fmt: skip
PLAN_WORDS = (
    "A.outer", "B.outer", "D.hole1", "A", "cw", "ccw", "outer", "hole", "mark", "slit", "hard", "soft", "off",
    "optimal",
    "feasible", "drawing", "sheet-corner", "left", "right", "top", "order", "zone", "excused", "dwell_s", "already_cut",
    "resumed_after", "broken_off", "zero", "origin", "time", "left_out", "dropped", "rules", "breaches", "exceptions",
)  # fmt: skip
INSTANCES = ("nine.pcglns", "twelve.sop")
ROUTING_WORDS = tuple(
    b"EDGE_WEIGHT_SECTION GTSP_SET_SECTION GTSP_SET_ORDERING START_GROUP_SECTION EOF DIMENSION DIMENSION: GTSP_SETS: "
    b"NAME: TYPE: COMMENT: EDGE_WEIGHT_TYPE: EXPLICIT EDGE_WEIGHT_FORMAT: FULL_MATRIX -1 -1 0 1 1000000 2 3 9".split()
)


@cache
def instance(name: str) -> bytes:
    """A routing instance of the examples."""
    return (ROOT / "examples/routing" / name).read_bytes()


MODEL_WORDS = tuple(
    b"before after position CONTOUR OUTER HOLE MARK parent kind long level_ahead zone part i j k where /\\ \\/ not -> "
    b"forall exists sum var bool int set of array constraint true false 1..n 0 1 -1 1000000000 % cases: right: wrong: "
    b'default include "x.mzn" let in if then else endif rule_holds predicate function solve satisfy output'.split()
)
PYTHON_WORDS = tuple(
    b"self facts options nest cuts None True False 0 1 -1 1.5 [] () {} '' 'x' lambda: yield return raise not is in "
    b"and or if else for pass int float str list id sentence source Options default statements pairs violations reason "
    b"precede about nan Violation Precede NoGood Lag".split()
)
"""Nothing that goes on for ever or reaches a file: what a trusted rule does beside judging is its author's."""


@cache
def rule_file(name: str) -> bytes:
    """A rule that works, as a plant writes it: in MiniZinc or Python; `shipped.mzn` is one of the catalogue."""
    if name == "shipped.mzn":
        return (
            (ROOT / "rules/catalogue/level_ahead/level_ahead.mzn")
            .read_bytes()
            .replace(b"level_ahead_holds", b"rule_holds")
        )
    with tempfile.TemporaryDirectory() as folder:
        from kerfwise.tests.commands.run_cli import kerfwise

        how = {"plant.mzn": "--mzn", "plant.py": "--python"}[name]
        assert kerfwise("rules", "new", "rule", how, "-o", folder).code == 0
        (written,) = Path(folder).iterdir()
        return written.read_bytes()


BEST_KNOWN = b"set,instance,best_upper\nrouting,nine,123\n,twelve,456.5\n"
