"""Small nests built by hand, for the cases of rules, for tests and for trying things out."""

from __future__ import annotations

from collections.abc import Sequence

from kerfwise.encoder.geometry.curve import Curve

from .nest import Contour, Nest, Part, Sheet, as_scrap

Rows = Sequence[Sequence[float]]


def rect(x: float, y: float, w: float, h: float) -> Rows:
    """A rectangle's vertices, counter-clockwise from its lower left corner."""
    return [(x, y), (x + w, y), (x + w, y + h), (x, y + h)]


def circle(cx: float, cy: float, r: float) -> Rows:
    """A circle as two half-circle arcs."""
    return [(cx - r, cy, 1.0), (cx + r, cy, 1.0)]


def part(name: str, outer: Rows, holes: Sequence[Rows] = (), marks: Sequence[Rows] = ()) -> Part:
    """A part with contour ids as a reader gives them; marks are open lines."""
    return Part(
        name,
        Contour(f"{name}.outer", name, "outer", Curve.of(outer)),
        tuple(Contour(f"{name}.hole{k}", name, "hole", Curve.of(h)) for k, h in enumerate(holes, 1)),
        tuple(Contour(f"{name}.mark{k}", name, "mark", Curve.of(m, closed=False)) for k, m in enumerate(marks, 1)),
    )


def nest(width: float, height: float, *parts: Part, scrap: Sequence[Rows] = ()) -> Nest:
    """A rectangular sheet at the origin with these parts, and with these lines to cut up its skeleton."""
    return Nest(Sheet.rectangle(width, height), parts, scrap=scrap_lines(scrap))


def scrap_lines(lines: Sequence[Rows]) -> tuple[Contour, ...]:
    """Scrap lines with ids as a reader gives them."""
    return as_scrap(Curve.of(line, closed=False) for line in lines)
