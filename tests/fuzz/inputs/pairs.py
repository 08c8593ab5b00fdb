"""Plans and programs that are whole and not of their nest, material charts, and lists of parts."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Callable
from random import Random
from typing import Any

from . import seeds
from .byte_damage import damaged
from .case import Case

SHORT = ("--work", "0.01")
NEST, PLAN, PROGRAM = "nest.json", "made.plan.json", "made.nc"
HUGE = (1e12, -1e12, 1e6, -1.0, 1e-9, 0, 10**40, 1e308, True, "7", None, [], {})
_UNKNOWN = ("D.holetrue", "Z.outer", "", "A", "A.outer.slit", "scrap1", "a.outer", "B.hole1 ", "D.mark9", "№7.outer")
Tree = dict[str, Any]
Change = Callable[[Tree, Random], None]


def _row(plan: Tree, rnd: Random) -> Tree:
    return rnd.choice(plan["cuts"]) if plan["cuts"] else {}


def _renamed(plan: Tree, rnd: Random) -> None:
    row = _row(plan, rnd)
    row["contour"] = rnd.choice((*_UNKNOWN, *(cut["contour"] for cut in plan["cuts"])))


def _swapped(plan: Tree, rnd: Random) -> None:
    one, other = _row(plan, rnd), _row(plan, rnd)
    key = rnd.choice(("contour", "entry", "pierce", "lead_in", "lead_out", "kind", "part", "zone"))
    one[key], other[key] = other.get(key), one.get(key)


def _missing(plan: Tree, rnd: Random) -> None:
    for _ in range(rnd.choice((1, 1, 2, 9))):
        if plan["cuts"]:
            plan["cuts"].pop(rnd.randrange(len(plan["cuts"])))
    _count(plan)


def _twice(plan: Tree, rnd: Random) -> None:
    plan["cuts"].insert(rnd.randrange(len(plan["cuts"]) + 1), copy.deepcopy(_row(plan, rnd)))
    _count(plan)


def _count(plan: Tree) -> None:
    for number, cut in enumerate(plan["cuts"], len(plan.get("already_cut", [])) + 1):
        cut["order"] = number


def _already(plan: Tree, rnd: Random) -> None:
    """Some of the first cuts are said to be made, or others, or such as there are not."""
    made = copy.deepcopy(plan["cuts"][: rnd.choice((1, 2))])
    if rnd.random() < 0.5:
        plan["cuts"] = plan["cuts"][len(made) :]
    if made and rnd.random() < 0.4:
        made[0]["contour"] = rnd.choice(_UNKNOWN)
    plan["already_cut"], plan["resumed_after"] = made, len(made)
    for number, cut in enumerate(made, 1):
        cut["order"] = number
    _count(plan)


def _moved(plan: Tree, rnd: Random) -> None:
    row = _row(plan, rnd)
    dx, dy = rnd.choice(((1e6, 0), (5, 5), (0.2, 0), (-300, 80), (1e-7, 0)))
    for key in rnd.choice((("entry",), ("pierce",), ("pierce", "lead_in"), ("entry", "pierce", "lead_in", "lead_out"))):
        if row.get(key):
            points = row[key] if isinstance(row[key][0], list) else [row[key]]
            for point in points:
                point[0], point[1] = point[0] + dx, point[1] + dy


def _huge(plan: Tree, rnd: Random) -> None:
    row = _row(plan, rnd)
    key = rnd.choice(("order", "zone", "length_mm", "start_s", "end_s", "dwell_s", "torch", "linked", "because"))
    rnd.choice((row, plan["totals"], plan["solve"]))[key] = rnd.choice(HUGE)


def _of_plan(plan: Tree, rnd: Random) -> None:
    key = rnd.choice((*plan, "pierces", "torches", "left_out", "losses", "made_with", "origin", "state", "dropped"))
    plan[key] = copy.deepcopy(
        rnd.choice((*HUGE, "left", "sheet-corner", [_row(plan, rnd)], {"a": 1}, plan.get("cuts")))
    )


def _odd_cut(plan: Tree, rnd: Random) -> None:
    """A link, a span, a tab or a torch where the plan has none."""
    row, other = _row(plan, rnd), _row(plan, rnd)
    row.update(
        rnd.choice(
            (
                {"linked": True},
                {"span": {"from": row.get("entry"), "to": other.get("entry")}},
                {"span": {"from": [0, 0], "to": [1e6, 1e6]}},
                {"tabs": [{"at": other.get("entry"), "width": rnd.choice((0.5, 1e6, -1, 0))}]},
                {"torch": 2, "together": other.get("contour")},
                {"torch": 3, "together": "Z.outer"},
                {"excused": ["no-rule", "level-ahead"]},
                {"dwell_s": rnd.choice((1e9, 30))},
                {"lead_in": [[0, 0], [0, 0]]},
                {"lead_in": [[0, 0, 1e6], [1, 1, -1e6]]},
                {"lead_out": [[row.get("entry", [0])[0], 5]] * 400},
                {"direction": rnd.choice(("cw", "ccw"))},
                {"kind": rnd.choice(("hole", "outer", "mark", "slit", "scrap"))},
            )
        )
    )


CHANGES: tuple[Change, ...] = (
    _renamed, _renamed, _swapped, _missing, _twice, _already, _moved, _huge, _of_plan, _odd_cut, _odd_cut,
)  # fmt: skip


def changed_plan(data: bytes, rnd: Random) -> bytes:
    """A plan with one to three rows that are not those of its nest; still whole JSON, mostly of the format."""
    plan = json.loads(data)
    for _ in range(rnd.choice((1, 1, 2, 3))):
        try:
            rnd.choice(CHANGES)(plan, rnd)
        except (KeyError, TypeError, IndexError, AttributeError):  # what an earlier change has left there
            continue
    if rnd.random() < 0.5:
        plan["nest"] = {"file": NEST}
    return json.dumps(plan).encode()


def changed_program(data: bytes, rnd: Random) -> bytes:
    """A program with burns dropped, doubled or in another order, or the comments of another."""
    lines = data.decode().splitlines()
    at, other = sorted(rnd.sample(range(len(lines)), 2))
    match rnd.randrange(4):
        case 0:
            del lines[at:other]
        case 1:
            lines[at:at] = lines[at:other]
        case 2:
            lines[at], lines[other] = lines[other], lines[at]
        case _:
            lines = [line.replace("A.", "B.") if rnd.random() < 0.5 else line for line in lines]
    return ("\n".join(lines) + "\n").encode()


def pair(rnd: Random) -> Case:
    """A nest, and a plan and program that are not, or not quite, of it; any verb that takes them."""
    name, nest = rnd.choice(("plain", "rich", "rest")), rnd.choice(("plain", "rich"))
    own = "rich" if name == "rest" else name
    nest = own if rnd.random() < 0.75 else nest
    program, plan = seeds.made(name)
    if rnd.random() < 0.85 or nest == own:
        plan = changed_plan(plan, rnd)
    if rnd.random() < 0.4:
        program = changed_program(program, rnd)
    contour = rnd.choice(("A.outer", "B.outer", "D.hole1", "A.hole1", "G.outer", "D.holetrue"))
    upto = rnd.choice("1234599")
    words = rnd.choice(
        (
            ("check", NEST, PLAN),
            ("check", NEST, PROGRAM, "--plan", PLAN),
            ("time", NEST, PLAN),
            ("time", NEST, PLAN, "--json"),
            ("heat", NEST, PLAN, "--set", "heat.grid=20"),
            ("explain", NEST, PLAN, contour),
            ("explain", NEST, PLAN, contour, "--all", "--json"),
            ("plot", NEST, PLAN, "-o", "out.svg"),
            ("plot", NEST, PLAN, "-o", "out.html"),
            ("plot", NEST, PLAN, "-o", "out.html", "--why"),
            ("plot", NEST, PLAN, "-o", "out.png"),
            ("sheet", NEST, PLAN, "-o", "out.pdf"),
            ("sheet", NEST, PLAN, "--program", PROGRAM, "-o", "out.pdf"),
            ("compare", NEST, PLAN, PROGRAM),
            ("compare", NEST, PLAN, PLAN, "-o", "out.html"),
            ("solve", NEST, "--lock-from", PLAN, "--upto", upto, *SHORT),
            ("solve", NEST, "--lock-from", PLAN, "--upto", upto, "--redo-last", *SHORT),
            ("solve", NEST, "--lock-from", PLAN, "--lock", "#2 first", *SHORT),
            ("resequence", PROGRAM, "--work", "0.01"),
        )
    )
    files: dict[str, bytes | None] = {NEST: seeds.nest_bytes(nest), PLAN: plan, PROGRAM: program}
    return Case("pair", files, words, tuple(file for file in (PLAN, PROGRAM) if file in words))


CHART = b"""name, material, thickness [mm], kerf [mm], feed [mm/min], pierce_delay [s], gas, amps
thin, S235, 3, 1.2, 4000, 0.2, air, 45
plate, S235, 6, 1.5, 2500, 0.5, air, 85
thick, S235, 12, 2.2, 1400, 1.1, O2, 130
"""
CHART_WORDS = tuple(
    b"name material thickness kerf feed mark_feed pierce_delay pierce_height cut_height amps volts power gas gas_flow "
    b'[mm] [m] [in] [mm/min] [m/s] [s] [parsec] S235 plate 6 0 -1 1e9 3,200 , ; " # - {material: {'.split()
)
LIST = b"""parts:
  - {part: a.json, quantity: 3}
  - {part: b.json, quantity: 2, mirror: true, rotations: [0, 90]}
sheets:
  - {size: 400x300, stock: 2, price: 7}
"""
CSV_LIST = b"file,quantity,material,thickness,rotation,order\na.json,3,S235,6,90,4711\nb.json,2,S235,6,free,4712\n"
LISTS = {"list.yaml": LIST, "list.csv": CSV_LIST}
_FOUR_DIGITS = re.compile(rb"(?<!\d)\d{4,6}(?!\d)")
"""Quantities that are lawful, and take longer than a case may."""
LIST_WORDS = tuple(
    b"parts part file quantity stock size price mirror rotations rotation priority order sheets remnant 0x0 1e9x1 400 "
    b"-1 0 1 1000000000 a.json nowhere.json . * free none any true {} [] nan".split()
)


def chart(rnd: Random) -> Case:
    """A material chart, under a profile that names it."""
    bad = damaged(CHART, rnd, CHART_WORDS)
    row = rnd.choice((b"", b", row: plate", b", thickness: 8, interpolate: true", b", row: {thickness: 12}"))
    plant = b"name: plant\nbased_on: plasma-carbon-steel\nmaterial: {chart: chart.csv" + row + b"}\n"
    program, plan = seeds.made("plain")
    files: dict[str, bytes | None] = {"chart.csv": bad, "plant.yaml": plant, NEST: seeds.nest_bytes("plain")}
    words = rnd.choice(
        (
            ("profile", "check", "plant.yaml"),
            ("profile", "check", "plant.yaml"),
            ("profile", "show", "plant.yaml", "--sources"),
            ("time", NEST, PLAN, "-p", "plant.yaml"),
            ("solve", NEST, "-p", "plant.yaml", "-o", "out.nc", *SHORT),
            ("check", NEST, PROGRAM, "-p", "plant.yaml"),
        )
    )
    return Case("chart", files | {PLAN: plan, PROGRAM: program}, words, ("chart.csv",))


def part_list(rnd: Random) -> Case:
    """A list of parts with quantities, in YAML or CSV."""
    part = {"format": "kerfwise-nest/1", "units": "mm", "sheet": {"width": 90, "height": 70}}
    files: dict[str, bytes | None] = {
        f"{name.lower()}.json": json.dumps(
            part | {"parts": [{"id": name, "outer": [[5, 5], [w, 5], [w, 60], [5, 60]]}]}
        ).encode()
        for name, w in (("A", 80), ("B", 45))
    }
    name = rnd.choice(("list.yaml", "list.yaml", "list.csv"))
    files[name] = _FOUR_DIGITS.sub(lambda found: found[0][:3], damaged(LISTS[name], rnd, LIST_WORDS))
    sheet = () if name == "list.yaml" else ("--sheet", "400x300")
    words = rnd.choice(
        (
            ("nest", name, *sheet, "-o", "out", "--rounds", "1", "--weigh-work", "0.01"),
            ("nest", name, *sheet, "-o", "out", "--rounds", "1", "--weigh-work", "0.01", "--skip-bad"),
            ("make", name, *sheet, "-o", "out", "--rounds", "1", "--weigh-work", "0.01", *SHORT),
        )
    )
    return Case("list", files, words, (name,))
