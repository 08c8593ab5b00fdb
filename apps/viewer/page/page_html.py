"""The page: a nest and its plan as data, and plain ES modules, in one HTML file that needs no network."""

from __future__ import annotations

import base64
import hashlib
import json
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from html import escape
from importlib.resources import files
from types import MappingProxyType
from typing import Any, NamedTuple

from kerfwise.encoder.cut import Cut, Pierce
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest, Source
from kerfwise.languages import page_texts
from kerfwise.models.plan.plan import Plan, PlannedCut
from kerfwise.models.plan.read_plan import expect_plan_of
from kerfwise.postproc.report.legend import nest_name
from kerfwise.rules.plan_state import PlanState

_IMPORT = re.compile(r'^import\s+(?:\{[^}]*\}\s+from\s+)?"\./(?P<name>[\w/.-]+\.js)";[ \t]*\n', re.MULTILINE)
_EXPORT = re.compile(r"^export\s+(?=(?:async\s+)?(?:function|class|const|let)\b)", re.MULTILINE)


class Page(NamedTuple):
    """A page: its HTML, and the policy (Content-Security-Policy) that its HTML states."""

    html: str
    policy: str


def page_html(data: Mapping[str, Any]) -> str:
    """The page of such data, as one HTML file that asks no server; see `page_and_policy`."""
    return page_and_policy(data).html


def page_and_policy(
    data: Mapping[str, Any],
    entry: str = "static.js",
    connect: bool = False,
    more: Mapping[str, str] = MappingProxyType({}),
    said: Mapping[str, Mapping[str, Any]] | None = None,
) -> Page:
    """The page of such data, as one HTML file, and its policy.

    Parameters
    ----------
    data
        What the page shows, as JSON can hold it: `types.js` describes it.
    entry
        The module of `page_files` that the page begins with.
    connect
        Whether the page may ask the server that it came from. Without it every request is forbidden.
    more
        Texts of further modules by name, which `entry` and others may import, and of further style sheets.
    said
        The message catalogues by language; None for those of every page.
    """
    frame = _text("page.html")
    style = "\n".join([_text("page.css"), *(text for name, text in more.items() if name.endswith(".css"))])
    script = bundled(entry, tuple(more.items()))
    allowed = {
        "default-src": "'none'",
        "script-src": _hash_of(script),
        "style-src": _hash_of(style),
        "img-src": "data: blob:",
        **({"connect-src": "'self'"} if connect else {}),
        "base-uri": "'none'",
        "form-action": "'none'",
    }
    policy = "; ".join(f"{key} {value}" for key, value in allowed.items())
    parts = {
        "@policy": escape(policy),
        "@title": escape(str(data.get("title", "kerfwise"))),
        "@style": style,
        "@noscript": _without_script(data),
        "@texts": as_script_data(page_texts() if said is None else said),
        "@data": as_script_data(data),
        "@script": script,
    }
    chunks = []
    for mark, text in parts.items():
        before, _, frame = frame.partition(mark)
        chunks += [before, text]
    return Page("".join([*chunks, frame]), policy)


def _without_script(data: Mapping[str, Any]) -> str:
    """What a browser shows that runs no JavaScript: what the plan is, and its picture."""
    if not data.get("nest"):
        return "<p>This page needs JavaScript. <code>kerfwise plot</code> draws the nest without it.</p>"
    sides = data["sides"]
    state = f"<p>{escape(sides[0]['state']['told'])}</p>" if sides else ""
    picture = base64.b64encode(bare_svg(data).encode("utf-8")).decode("ascii")
    title = escape(str(data.get("title", "")))
    alt = f"the nest {title}, with the numbers of the cuts" if sides else f"the nest {title}"
    return (
        f"<h1>{title}</h1>{state}<p>The page needs JavaScript to explain and play the plan.</p>"
        f'<img alt="{alt}" src="data:image/svg+xml;base64,{picture}">'
    )


_NUMBERED = 600
"""Cuts up to which the picture without JavaScript has numbers."""


def bare_svg(data: Mapping[str, Any]) -> str:
    """A picture of a page's data as SVG: the sheet, every contour, and where each cut begins."""
    nest, (x0, y0, x1, y1) = data["nest"], data["nest"]["bounds"]
    size = max(x1 - x0, y1 - y0, 1.0)

    def path(rows: Sequence[float], closed: bool) -> str:
        bits = [f"M{rows[0]:g} {y1 - rows[1]:g}"]
        count = len(rows) // 3
        for k in range(count if closed else count - 1):
            (xa, ya, bulge), (xb, yb) = rows[3 * k : 3 * k + 3], rows[3 * ((k + 1) % count) :][:2]
            if bulge:
                chord = math.hypot(xb - xa, yb - ya)
                radius = abs(chord * (1 + bulge * bulge) / (4 * bulge))
                bits.append(f"A{radius:.4g} {radius:.4g} 0 {int(abs(bulge) > 1)} {int(bulge < 0)} {xb:g} {y1 - yb:g}")
            else:
                bits.append(f"L{xb:g} {y1 - yb:g}")
        return "".join([*bits, "Z" if closed else ""])

    parts = "".join(path(c["rows"], c["closed"]) for c in nest["contours"] if c["kind"] != "mark")
    marks = "".join(path(c["rows"], c["closed"]) for c in nest["contours"] if c["kind"] == "mark")
    cuts = data["sides"][0]["cuts"] if data["sides"] else []
    numbers = "".join(
        f'<text x="{cut["path"][0]:g}" y="{y1 - cut["path"][1]:g}">{k}</text>'
        for k, cut in enumerate(cuts[:_NUMBERED], (data["sides"][0]["made"] if cuts else 0) + 1)
    )
    line = size / 800
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{x0 - 9 * line:g} {-9 * line:g} {x1 - x0 + 18 * line:g} '
        f'{y1 - y0 + 18 * line:g}"><g fill="none" stroke="#343a40" stroke-width="{line:g}">'
        f'<path fill="#e3e6e9" fill-rule="evenodd" d="{"".join(path(rows, True) for rows in nest["sheet"])}"/>'
        f'<path fill="#c5d7e6" fill-rule="evenodd" d="{parts}"/><path stroke="#17609f" d="{marks}"/></g>'
        f'<g font-family="sans-serif" font-size="{12 * line:g}" text-anchor="middle">{numbers}</g></svg>'
    )


def as_script_data(data: Mapping[str, Any]) -> str:
    r"""JSON that may stand in a script element: nothing in it can end the element, or begin a comment in it.

    Examples
    --------
    >>> as_script_data({"part": "</script>"})
    '{"part":"\\u003c/script>"}'
    """
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"))
    # Half of a surrogate pair, as a file's name may hold, is no UTF-8: JSON may write it as an escape.
    lone = re.sub("[\ud800-\udfff]", lambda half: f"\\u{ord(half[0]):04x}", text)
    return lone.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


@cache
def bundled(entry: str, more: tuple[tuple[str, str], ...] = ()) -> str:
    """The module and all that it imports as one script, each after those that it needs; `more` are names and texts."""
    texts = dict(more)

    def text_of(name: str) -> str:
        return texts[name] if name in texts else _text(name)

    def in_order(name: str) -> Iterator[str]:
        seen.add(name)
        for found in _IMPORT.finditer(text_of(name)):
            if found["name"] not in seen:
                yield from in_order(found["name"])
        yield name

    seen = set[str]()
    return "\n".join(f"// {name}\n{_bare(text_of(name))}" for name in in_order(entry))


def _bare(module: str) -> str:
    """A module's text without imports and exports: in one script all names are known anyway."""
    return _EXPORT.sub("", _IMPORT.sub("", module))


@cache
def _text(name: str) -> str:
    return files(__package__).joinpath("page_files", name).read_text(encoding="utf-8")


def _hash_of(text: str) -> str:
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return f"'sha256-{base64.b64encode(digest).decode()}'"


# A nest and its plan as the data of the page: what can be said without a profile.

FORMAT = "kerfwise-page/1"
Data = dict[str, Any]


def page_of(nest: Nest, sides: Sequence[Data], title: str, alert: Iterable[str] = (), caption: str = "") -> Data:
    """The data of a page: the nest and its sides, none, one, or two that are compared.

    Contours in `alert` are drawn in red, and `caption` says why.
    """
    return {
        "format": FORMAT,
        "title": title,
        "caption": caption,
        "nest": nest_data(nest),
        "alert": [nest.index[name] for name in alert if name in nest.index],
        "sides": list(sides),
        "comparison": None,
    }


def plain_page(nest: Nest, plan: Plan | None, home: Point, alert: Iterable[str] = (), caption: str = "") -> Data:
    """The page of a nest, with its plan if there is one, as far as both tell by themselves."""
    sides = [] if plan is None else [side_data(nest, plan, home)]
    return page_of(nest, sides, nest_name(nest, plan), alert, caption)


def nest_data(nest: Nest) -> Data:
    """Sheet, parts and contours; rows are x, y, bulge, x, y, bulge, …, mm."""
    number = {part.id: k for k, part in enumerate(nest.parts)}
    return {
        "file": nest.file,
        "sha256": nest.sha256,
        "bounds": [round(v, 3) for v in nest.sheet.bounds],
        "sheet": [rows_of(curve) for curve in (nest.sheet.outline, *nest.sheet.holes)],
        "parts": [part.id for part in nest.parts],
        "contours": [
            {
                "id": contour.id,
                "part": number.get(contour.part, -1),
                "kind": contour.kind,
                "rows": rows_of(contour.curve),
                "closed": contour.curve.closed,
                **_as_drawn_in_file(contour.source),
            }
            for contour in nest.contours
        ],
        "left_out": [rows_of(hole.curve) for hole in nest.not_cut],
        "notes": [note.text for note in nest.notes],
    }


def _as_drawn_in_file(source: Source) -> Data:
    """What the drawing says of a line, where it says anything worth it: in words, its colour, and its writing."""
    data = {"drawn": source.told(), "colour": source.colour, "text": source.text}
    return {key: escape_text(value) for key, value in data.items() if value}


def rows_of(curve: Curve) -> list[float]:
    """A curve as x, y, bulge of each vertex in one list, mm to 3 decimals.

    Examples
    --------
    >>> rows_of(Curve.of([(0, 0), (1, 0, 0.5), (1, 1)]))
    [0, 0, 0, 1, 0, 0.5, 1, 1, 0]
    """
    return [short(value, 3 + 3 * (k % 3 == 2)) for k, value in enumerate(curve.vertices.ravel().tolist())]


def short(value: float, digits: int = 3) -> float:
    """A number that is written shortly: whole ones without a point."""
    rounded = round(value, digits)
    return int(rounded) if rounded == int(rounded) else rounded


def side_data(nest: Nest, plan: Plan, home: Point, cuts: list[Data] | None = None) -> Data:
    """One plan: its cuts, its figures, and what it says of each rule. With no `cuts` given paths are as drawn.

    Raises InputError if the plan is not one of this nest.
    """
    expect_plan_of(plan, nest)
    solve, totals = plan.solve, plan.totals
    return {
        "name": "",
        "profile": plan.profile.get("name", ""),
        "kerf_mm": 0,
        "home": [short(v) for v in home],
        "made": plan.resumed_after,
        "end_s": short(totals.time_s),
        "figures": {
            "cut_mm": short(totals.cut_mm),
            "idle_mm": short(totals.idle_mm),
            "pierces": totals.pierces,
            "status": solve.status,
            "gap": None if plan.told_gap is None else solve.gap,
            "light_gap": plan.light_gap,
        },
        "said": [],
        "ok": all(rule.holds for rule in plan.rules if rule.strength == "hard"),
        "state": state_data(plan.stated),
        "cuts": [cut_data(nest, planned) for planned in plan.cuts] if cuts is None else cuts,
        "pierces": [pierce_data(nest, pierce) for pierce in plan.pierces],
        "already": [nest.index[p.cut.contour] for p in plan.already_cut if p.cut.contour in nest.index],
        "rules": _rules_of(plan),
        "dropped": [{"rule": d.rule, "contours": list(d.contours), "why": d.why} for d in plan.dropped],
        "left_out": [{"contour": left.contour, "why": left.why} for left in plan.left_out],
        "why": {},
        "heat": None,
        "nc": None,
    }


def state_data(state: PlanState) -> Data:
    """Whether every hard rule holds: kept, kept but for some places, or broken; in short, and for an operator."""
    words = {"short": state.short(), "told": state.words(), "for_operator": state.for_operator()}
    return {"kind": state.kind, "count": state.count, **words}


def cut_data(nest: Nest, planned: PlannedCut, path: Curve | None = None) -> Data:
    """One cut; `path` is the torch's way, else leads and contour as they are drawn."""
    cut = planned.cut
    return {
        "contour": nest.index[cut.contour],
        "zone": cut.zone,
        "direction": cut.direction,
        "entry": [short(v) for v in cut.entry],
        "from_s": short(cut.start_s),
        "to_s": short(cut.end_s),
        "stand_s": 0,
        "wait_s": short(planned.dwell_s),
        "length_mm": short(planned.length_mm, 1),
        "because": list(planned.because),
        "linked": cut.linked,
        "torch": cut.torch,
        "excused": list(cut.excused),
        "tabs": [[*(short(v) for v in tab.at), short(tab.width_mm)] for tab in cut.tabs],
        "path": rows_of(path if path is not None else _as_drawn(nest, cut)),
        "unlit": [],
        "slow": [],
    }


def pierce_data(nest: Nest, pierce: Pierce) -> Data:
    """One hole of a pierce pass."""
    return {
        "contour": nest.index.get(pierce.contour, -1),
        "at": [short(v) for v in pierce.at],
        "before": pierce.before,
        "from_s": short(pierce.start_s),
        "to_s": short(pierce.end_s),
    }


def _as_drawn(nest: Nest, cut: Cut) -> Curve:
    """Lead-in, the contour from its entry on, lead-out, one after the other."""
    curve = nest.contour(cut.contour).curve
    if curve.closed:
        turned = curve.towards(cut.direction)
        curve = turned.opened_at(turned.project(cut.entry)[0])
    elif cut.direction == "cw":
        curve = curve.reversed()
    rows: list[list[float]] = []
    for piece in (cut.lead_in, curve, cut.lead_out):
        if piece is not None:
            rows += piece.vertices.tolist()
            rows[-1] = [*rows[-1][:2], 0.0]
    return Curve.of(rows, closed=False)


def _rules_of(plan: Plan) -> list[Data]:
    return [
        {
            "id": rule.id,
            "sentence": "",
            "strength": rule.strength,
            "verdict": "holds" if rule.holds and not rule.exceptions else "excused" if rule.holds else "broken",
            "cost_mm": 0,
            "unjudged": "",
            "breaches": [{"contours": list(ids), "text": why} for ids, why in rule.breaches],
            "excused": [{"contours": list(ids), "text": "", "why": why} for ids, why in rule.exceptions],
        }
        for rule in plan.rules
    ]
