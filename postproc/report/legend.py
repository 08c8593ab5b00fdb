"""What stands around the drawing: title, scale bar, key and the colour bar of time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kerfwise.encoder.nest import Nest
from kerfwise.languages import ENGLISH_TEXTS, Texts
from kerfwise.models.plan.plan import Plan

from . import scene
from .layers import INKS
from .scene import FOOTER, HEADER, MARGIN, Dot, Item, SceneLayer, Shape, Style, TextLine, View, text_width

_SMALL = 12.5


@dataclass(frozen=True, slots=True)
class Clock:
    """What the colours of idle travel count: seconds where the plan has times, else cuts."""

    total: float
    in_seconds: bool

    def ticks(self) -> list[tuple[float, str]]:
        """Places 0 … 1 on the colour bar with their labels; the last has the unit."""
        if not self.in_seconds:
            unit, name = 1.0, " cuts"
        elif self.total < 180:
            unit, name = 1.0, " s"
        else:
            unit, name = 60.0, " min"
        whole = self.total / unit
        step = _round_step(whole / 6) if self.in_seconds else max(_round_step(whole / 6), 1.0)
        values = [k * step for k in range(math.floor(whole / step + 1e-9) + 1)]
        labels = [f"{v:g}" for v in values]
        labels[-1] += name
        return [(v / whole, label) for v, label in zip(values, labels, strict=True)]


def _round_step(least: float) -> float:
    """The smallest of 1, 2, 5 × 10ⁿ that is not under `least`."""
    if least <= 0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(least))
    return next(m * power for m in (1, 2, 5, 10) if m * power >= least * (1 - 1e-9))


def nest_name(nest: Nest, plan: Plan | None) -> str:
    """The name of the nest's file, without its folder."""
    named = nest.file or (plan.nest.get("file", "") if plan else "")
    return Path(named).name or "nest"


def header_layer(nest: Nest, plan: Plan | None, view: View, caption: str) -> SceneLayer:
    """The name of the nest, the profile and the caption; under it the totals."""
    name = nest_name(nest, plan)
    profile = plan.profile.get("name", "") if plan else ""
    about = " · ".join(text for text in (f"profile {profile}" if profile else "", caption) if text)
    left, bottom, right, top = nest.sheet.bounds
    counts = (counted(len(nest.parts), "part"), counted(len(nest.contours), "contour"))
    sizes = [f"{right - left:g} × {top - bottom:g} mm", *counts]
    totals = " · ".join([*sizes, *_totals(plan)] if plan else sizes)
    room = view.width - 2 * MARGIN
    name_size = _fitting(name, 19, 0.6 * room, bold=True)
    indent = MARGIN + text_width(name, name_size, bold=True) + 14
    items: list[Item] = [
        _band(0, HEADER - 6, view),
        TextLine(MARGIN, 24, name, name_size, scene.INK, "start", bold=True),
        TextLine(MARGIN, 49, totals, _fitting(totals, 14, room), scene.INK, "start"),
    ]
    if about:
        size = _fitting(about, 15, MARGIN + room - indent)
        items.append(TextLine(indent, 24.6, about, size, scene.FAINT, "start"))
    return SceneLayer("header", tuple(items))


def _band(top: float, bottom: float, view: View) -> Shape:
    """A strip of blank page, for a drawing that runs over its window."""
    corners = [(0.0, top), (view.width, top), (view.width, bottom), (0.0, bottom)]
    return Shape((np.array(corners),), Style(fill=scene.PAGE))


def _fitting(text: str, size: float, room: float, bold: bool = False) -> float:
    """The size, or a smaller one with which the text is no wider than the room."""
    return min(size, room / text_width(text, 1.0, bold))


def _totals(plan: Plan) -> list[str]:
    t, solve = plan.totals, plan.solve
    facts = [
        f"cut {t.cut_mm / 1000:.1f} m",
        f"idle {t.idle_mm / 1000:.1f} m",
        counted(t.pierces, "pierce"),
        f"time {duration(t.time_s)}",
    ]
    if plan.waits:
        facts.append(f"{duration(plan.wait_s)} of it waiting")
    if solve.status == "optimal":
        facts.append("proven optimal within these zones and entries")
    elif solve.gap is None:
        facts.append("no bound proven")
    else:
        if plan.heavy_mm:
            facts.append(f"fewer excuses {'impossible' if plan.none_needless else 'not ruled out'}")
        if plan.told_gap is not None:
            facts.append(f"gap {100 * plan.told_gap:.1f} %{' besides' if plan.heavy_mm else ''}")
    if plan.zones_cost is not None and plan.zones_cost.mm > 0:
        facts.append(f"zones cost {plan.zones_cost.mm / 1000:.1f} m")
    return [*facts, *_not_kept(plan)]


def _not_kept(plan: Plan) -> list[str]:
    """What the plan does not keep of its rules, counted: excuses, soft rules broken, statements left out."""
    counts = {
        "excuse": sum(len(rule.exceptions) for rule in plan.rules),
        "soft breach": sum(len(rule.breaches) for rule in plan.rules),
        "dropped order": sum(not dropped.relaxed for dropped in plan.dropped),
        "RELAXED statement": sum(dropped.relaxed for dropped in plan.dropped),
    }
    plural = {"soft breach": "soft breaches"}
    return [f"{k} {plural.get(name, name + 's') if k > 1 else name}" for name, k in counts.items() if k]


def counted(number: int, word: str) -> str:
    """So many of them.

    Examples
    --------
    >>> counted(1, "pierce"), counted(12, "pierce")
    ('1 pierce', '12 pierces')
    """
    return f"{number} {word}{'' if number == 1 else 's'}"


def duration(seconds: float, say: Texts = ENGLISH_TEXTS) -> str:
    """Seconds for people, in the units of a language.

    Examples
    --------
    >>> duration(42.4), duration(754), duration(8000)
    ('42 s', '12 min 34 s', '2 h 13 min')
    """
    whole, tr = round(seconds), say.tr
    if whole < 60:
        return tr("{s} s").format(s=whole)
    if whole < 3600:
        return tr("{m} min {s} s").format(m=whole // 60, s=whole % 60)
    return tr("{h} h {m} min").format(h=whole // 3600, m=whole % 3600 // 60)


def clock_text(seconds: float) -> str:
    """Minutes and seconds.

    Examples
    --------
    >>> clock_text(754.4)
    '12:34'
    """
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02d}"


def footer_layer(view: View, clock: Clock | None, kinds: frozenset[str]) -> SceneLayer:
    """The scale bar; with a plan (that has a clock) also the key and the colour bar."""
    y = view.height - FOOTER / 2 + 4
    items: list[Item] = [_band(view.height - FOOTER + 6, view.height, view)]
    x = _scale_bar(items, view, y)
    if clock is not None:
        end = _colour_bar(items, view, clock, y)
        _key(items, x + 40, end - 30, y, kinds)
    return SceneLayer("footer", tuple(items))


def _scale_bar(items: list[Item], view: View, y: float) -> float:
    window_mm = view.window[2] - view.window[0]
    length_mm = _round_step(0.06 * window_mm)
    length = length_mm * view.scale
    ends = np.array([(MARGIN, y - 4), (MARGIN, y + 4), (MARGIN, y), (MARGIN + length, y)])
    tip = np.array([(MARGIN + length, y - 4), (MARGIN + length, y + 4)])
    items.append(Shape((ends, tip), Style(stroke=scene.INK, width=1.4), closed=False))
    label = f"{length_mm / 1000:g} m" if length_mm >= 1000 else f"{length_mm:g} mm"
    items.append(TextLine(MARGIN + length + 8, y, label, _SMALL, scene.INK, "start"))
    return MARGIN + length + 8 + text_width(label, _SMALL)


def _colour_bar(items: list[Item], view: View, clock: Clock, y: float) -> float:
    length, steps = 240.0, 48
    left = view.width - MARGIN - length - 34
    for k in range(steps):
        x0, x1 = left + length * k / steps, left + length * (k + 1) / steps + (0.4 if k < steps - 1 else 0)
        box = np.array([(x0, y - 10), (x1, y - 10), (x1, y - 2), (x0, y - 2)])
        items.append(Shape((box,), Style(fill=scene.time_colour((k + 0.5) / steps))))
    for share, label in clock.ticks():
        x = left + share * length
        items.append(Shape((np.array([(x, y - 2), (x, y + 2)]),), Style(stroke=scene.FAINT, width=0.8), closed=False))
        items.append(TextLine(x, y + 10, label, 11, scene.INK))
    items.append(TextLine(left - 10, y - 6, "idle travel", _SMALL, scene.INK, "end"))
    return left - 10 - text_width("idle travel", _SMALL)


def _key(items: list[Item], x: float, end: float, y: float, kinds: frozenset[str]) -> None:
    """Samples with their names, as many as there is room for."""
    for kind, label in (
        ("pierce", "pierce and lead"),
        ("further", "of a further torch, at once"),
        ("pass", "pierce pass"),
        ("edge", "begins off the sheet"),
        ("kerf", "begins in an older kerf"),
        ("wait", "waits for metal to cool"),
        ("stretch", "stretch cut before the rest"),
        ("bevel", "tilted torch, at the top face"),
        ("below", "its jet, at the bottom face"),
        ("outer", "outer contour"),
        ("hole", "hole"),
        ("mark", "mark"),
        ("slit", "slit along a narrow slot"),
        ("scrap", "scrap line"),
        ("tab", "tab that holds the part"),
        ("across", "slot not cut, narrower than the kerf"),
        ("small", "small hole, not cut"),
        ("home", "home"),
        ("out", "out already"),
    ):
        if kind not in kinds:
            continue
        width = 28 + text_width(label, _SMALL)
        if x + width > end:
            return
        items.extend(_sample(kind, x, y))
        items.append(TextLine(x + 28, y, label, _SMALL, scene.INK, "start"))
        x += width + 24


def _sample(kind: str, x: float, y: float) -> list[Item]:
    line = np.array([(x, y), (x + 22, y)])
    if kind == "home":
        cross = (np.array([(x + 3, y), (x + 19, y)]), np.array([(x + 11, y - 8), (x + 11, y + 8)]))
        return [
            Dot(x + 11, y, 4.5, Style(fill=scene.PAGE, stroke=scene.INK, width=1.2)),
            Shape(cross, Style(stroke=scene.INK, width=1.2), closed=False),
        ]
    if kind == "tab":
        bar = np.array([(x + 11, y - 6), (x + 11, y + 6)])
        outline = Shape((line,), Style(stroke=INKS["outer"], width=1.4), closed=False)
        return [outline, Shape((bar,), Style(stroke=scene.TAB, width=3), closed=False)]
    if kind == "across":
        strokes = tuple(np.array([(x + 6, y - s * 5), (x + 16, y + s * 5)]) for s in (-1, 1))
        return [Shape(strokes, Style(stroke=scene.ACROSS, width=2), closed=False)]
    if kind == "stretch":
        return [Shape((line,), Style(stroke=scene.STRETCH, width=2.4), closed=False)]
    if kind in ("bevel", "below"):
        dash = (2.0, 2.6) if kind == "below" else ()
        return [Shape((line,), Style(stroke=scene.STRETCH, width=1.6 if not dash else 1.2, dash=dash), closed=False)]
    if kind == "pass":
        return [Shape((line,), Style(stroke=scene.PIERCE, width=1.0, dash=(1.2, 2.4)), closed=False)]
    if kind in ("edge", "kerf"):
        return [Dot(x + 11, y, 3, Style(fill=scene.PAGE, stroke=scene.PIERCE, width=1.5))]
    if kind == "wait":
        return [Dot(x + 11, y, 3, Style(fill=scene.PIERCE)), Dot(x + 11, y, 6, Style(stroke=scene.WAIT, width=2))]
    if kind == "small":
        return [Shape((line,), Style(stroke=scene.FAINT, width=1.4, dash=(4, 3)), closed=False)]
    if kind == "out":
        return [Shape((line,), Style(stroke=scene.FAINT, width=1.0, dash=(2.0, 2.0)), closed=False)]
    ink = {"pierce": scene.PIERCE, "further": scene.FURTHER, **INKS}[kind]
    sample: list[Item] = [Shape((line,), Style(stroke=ink, width=1.4), closed=False)]
    return [*sample, Dot(x + 2, y, 3, Style(fill=ink))] if kind in ("pierce", "further") else sample
