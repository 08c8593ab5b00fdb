"""A picture of a rule's cases: each a small nest with the order of its cuts, and what is wrong with it below."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from html import escape
from textwrap import wrap

import shapely

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.rules.rule import Violation

from .svg import FONT

PAGE, MARGIN, LINE = 720.0, 20.0, 18.0
MOST_HEIGHT, MOST_LETTERS = 320.0, 95
ToPaper = Callable[[float, float], tuple[float, float]]
INK, RED, METAL = "#1f2933", "#c62828", "#dbe4ee"


@dataclass(frozen=True, eq=False, slots=True)
class Panel:
    """One nest with its cuts in order, under a title."""

    title: str
    nest: Nest
    cuts: CutSequence
    violations: tuple[Violation, ...] = ()


def case_picture(panels: Sequence[Panel]) -> str:
    """An SVG document of the panels, one below the other; contours that break the rule are red."""
    y, drawn = MARGIN, []
    for panel in panels:
        lines, height = _panel(panel, y)
        drawn += lines
        y += height
    size = f'viewBox="0 0 {PAGE:g} {y:g}" width="{PAGE:g}" height="{y:g}"'
    font = f'font-family="{FONT}" font-size="12"'
    head = f'<svg xmlns="http://www.w3.org/2000/svg" {size} {font}>'
    return "\n".join([head, '<rect width="100%" height="100%" fill="#ffffff"/>', *drawn, "</svg>"]) + "\n"


def _panel(panel: Panel, top: float) -> tuple[list[str], float]:
    """The panel's elements, and how much height it takes."""
    xmin, ymin, xmax, ymax = panel.nest.sheet.bounds
    scale = min((PAGE - 2 * MARGIN) / (xmax - xmin), MOST_HEIGHT / (ymax - ymin))
    floor = top + LINE + (ymax - ymin) * scale
    wrong = {name for violation in panel.violations for name in violation.contours}
    at = panel.cuts.positions()

    def place(x: float, y: float) -> tuple[float, float]:
        return round(MARGIN + (x - xmin) * scale, 2), round(floor - (y - ymin) * scale, 2)

    lines = [_text(MARGIN, top + 10, panel.title, INK, "start", bold=True)]
    lines.append(_path(panel.nest.sheet.outline.line(), place, INK, METAL, 1))
    for contour in _largest_first(panel.nest):
        ink = RED if contour.id in wrong else INK
        fill = {"outer": "#ffffff", "hole": METAL, "mark": "none", "slit": "none", "scrap": "none"}[contour.kind]
        lines.append(_path(contour.line, place, ink, fill, 2 if contour.id in wrong else 1))
    for contour in panel.nest.contours:
        if contour.id in at:
            x, y = place(*contour.curve.point_at(0.0))
            ink = RED if contour.id in wrong else INK
            lines.append(f'<circle cx="{x:g}" cy="{y:g}" r="8" fill="{ink}"/>')
            lines.append(_text(x, y + 4, str(at[contour.id]), "#ffffff", "middle"))
    said = [violation.text for violation in panel.violations] or ["nothing is wrong"]
    below = [line for text in said for line in wrap(text, MOST_LETTERS)]
    ink = RED if panel.violations else INK
    lines += [_text(MARGIN, floor + LINE * k, text, ink, "start") for k, text in enumerate(below, 1)]
    return lines, floor - top + LINE * (len(below) + 2)


def _largest_first(nest: Nest) -> Iterator[Contour]:
    """The contours in the order that paints what lies inside over what lies around it."""
    yield from sorted(nest.contours, key=lambda c: -c.polygon.area if c.encloses else 1.0)


def _path(line: shapely.LineString, place: ToPaper, ink: str, fill: str, width: float) -> str:
    points = " ".join("{:g},{:g}".format(*place(x, y)) for x, y in shapely.get_coordinates(line).tolist())
    return f'<polyline points="{points}" fill="{fill}" stroke="{ink}" stroke-width="{width:g}"/>'


def _text(x: float, y: float, text: str, ink: str, anchor: str, bold: bool = False) -> str:
    weight = ' font-weight="bold"' if bold else ""
    return f'<text x="{x:g}" y="{y:g}" fill="{ink}" text-anchor="{anchor}"{weight}>{escape(text, quote=False)}</text>'
