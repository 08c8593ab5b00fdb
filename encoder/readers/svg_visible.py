"""What an SVG file shows: clones drawn, styles laid on, what is hidden or clipped away taken out."""

from __future__ import annotations

import copy
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from xml.etree.ElementTree import Element, SubElement

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Note
from kerfwise.encoder.questions import Asking, Choice, Question

from .drawing import DrawnCurve, DrawnText
from .fit_arcs import FLATTEN_MM, fit_curve
from .layers import counted
from .svg_css import declarations
from .svg_text import write_out

# What an SVG file shows: clones drawn, styles laid on, and what is hidden taken out, before any curve is made.

XLINK = "{http://www.w3.org/1999/xlink}href"
CLIP, SHAPE, MASK = "kerfwise-clip-", "kerfwise-clip-shape-", "kerfwise-mask-"
"""How the ids of groups begin that stand round what is clipped, round its clipping path, and round what is masked."""

LEAVES = frozenset({"path", "rect", "circle", "ellipse", "line", "polyline", "polygon"})
_INHERITED = (
    "visibility", "fill", "stroke", "fill-opacity", "stroke-opacity", "stroke-width", "stroke-dasharray", "color",
)  # fmt: skip
_NONE = frozenset({"none", "transparent", "rgba(0,0,0,0)"})
_PX = {"": 1.0, "px": 1.0, "mm": 96 / 25.4, "cm": 960 / 25.4, "in": 96.0, "pt": 96 / 72, "pc": 16.0, "q": 24 / 25.4}


@dataclass(slots=True)
class Seen:
    """What was taken out, by why: how many shapes."""

    hidden: Counter[str] = field(default_factory=Counter)
    clips: int = 0
    masks: int = 0


def laid_out(root: Element) -> Seen:
    """Draw clones, move origins of transforms, mark clipping paths, and take out what is not shown.

    Raises
    ------
    InputError
        For what cannot be told, such as a clipping path in shares of a shape's box.
    """
    seen = Seen()
    named = {element.get("id", ""): element for element in root.iter() if element.get("id")}
    _clones(root, named)
    box = _view_box(root)
    for element in list(root.iter()):
        _moved_origin(element, box)
    write_out(root, box)
    _clipped(root, named, seen)
    _without_hidden(root, {}, 1.0, seen)
    return seen


def properties(element: Element) -> dict[str, str]:
    """What an element says of itself: its attributes, and its style, which goes before them."""
    own = {name: value for name, value in element.items() if "}" not in name}
    return own | {name: value for name, (value, _) in declarations(element.get("style", "")).items()}


def _tag(element: Element) -> str:
    return str(element.tag).rpartition("}")[2]


def _clones(root: Element, named: Mapping[str, Element]) -> None:
    """Every <use> as a group that holds a copy of what it shows; symbols are groups, fitted into their size."""
    for parent in list(root.iter()):
        for k, child in enumerate(list(parent)):
            if _tag(child) == "use":
                parent[k] = _drawn(child, named, ())


def _drawn(use: Element, named: Mapping[str, Element], within: tuple[str, ...]) -> Element:
    href = (use.get("href") or use.get(XLINK) or "").strip()
    space = str(use.tag)[: -len("use")]
    kept = {k: v for k, v in use.items() if k not in ("href", XLINK, "x", "y", "width", "height")}
    group = Element(f"{space}g", kept)
    group.tail = use.tail
    target = named.get(href.removeprefix("#")) if href.startswith("#") else None
    if target is None or href in within:
        return group
    x, y = (_length(use.get(name, "0")) for name in ("x", "y"))
    if x or y:
        group.set("transform", f"{kept.get('transform', '')} translate({x:g} {y:g})".strip())
    inner = copy.deepcopy(target)
    if _tag(inner) in ("symbol", "svg"):
        inner.tag = f"{space}g"
        fitted = _fitted(inner, use)
        for name in ("viewBox", "width", "height", "x", "y", "preserveAspectRatio"):
            inner.attrib.pop(name, None)
        if fitted:
            inner.set("transform", fitted)
    holder = Element(f"{space}g")
    holder.append(inner)
    for parent in list(holder.iter()):
        for k, child in enumerate(list(parent)):
            if _tag(child) == "use":
                parent[k] = _drawn(child, named, (*within, href))
    group.append(holder[0])
    return group


def _fitted(symbol: Element, use: Element) -> str:
    """The transform that fits a symbol's own box into the size of its clone."""
    numbers = [float(n) for n in re.split(r"[\s,]+", symbol.get("viewBox", "").strip()) if n]
    sizes = [use.get(name) or symbol.get(name) for name in ("width", "height")]
    if len(numbers) != 4 or not numbers[2] or not numbers[3]:
        return ""
    x0, y0, width, height = numbers
    if any(size is None or size.endswith("%") for size in sizes):
        return f"translate({-x0:g} {-y0:g})" if x0 or y0 else ""
    sx, sy = _length(str(sizes[0])) / width, _length(str(sizes[1])) / height
    if symbol.get("preserveAspectRatio", "").startswith("none"):
        return f"scale({sx:.12g} {sy:.12g}) translate({-x0:g} {-y0:g})"
    s = min(sx, sy)
    dx, dy = (sx - s) * width / 2, (sy - s) * height / 2
    return f"translate({dx:.12g} {dy:.12g}) scale({s:.12g}) translate({-x0:g} {-y0:g})"


def _length(text: str) -> float:
    """A length in user units, 0 for what is none."""
    found = re.fullmatch(r"\s*([-+]?[0-9.]+(?:[eE][-+]?\d+)?)\s*([a-zA-Z]*)\s*", text)
    if found is None or found[2].lower() not in _PX:
        return 0.0
    return float(found[1]) * _PX[found[2].lower()]


def _view_box(root: Element) -> tuple[float, float]:
    """Width and height of what percentages are shares of, in user units."""
    numbers = [n for n in re.split(r"[\s,]+", root.get("viewBox", "").strip()) if n]
    if len(numbers) == 4:
        return float(numbers[2]), float(numbers[3])
    return _length(root.get("width", "0")), _length(root.get("height", "0"))


def _moved_origin(element: Element, box: tuple[float, float]) -> None:
    """A transform of a style becomes an attribute, about its origin."""
    said = properties(element)
    styled = declarations(element.get("style", "")).get("transform", ("", False))[0]
    transform = styled or element.get("transform", "")
    origin = said.get("transform-origin", "").strip()
    if not transform or transform == "none" or not (styled or origin):
        return
    transform = re.sub(
        r"([-+]?[0-9.]+(?:[eE][-+]?\d+)?)(px|mm|cm|in|pt|pc|deg|rad|turn|grad)\b", _plain_number, transform
    )
    if origin and origin not in ("0 0", "0px 0px", "0"):
        if said.get("transform-box", "view-box") not in ("view-box", "") and _tag(element) != "svg":
            name = f" '{element.get('id')}'" if element.get("id") else ""
            raise InputError(
                f"the <{_tag(element)}>{name} is turned about its own box (transform-box), which is not read; save the "
                "drawing as plain SVG"
            )
        x, y = _origin(origin, box)
        transform = f"translate({x:.12g} {y:.12g}) {transform} translate({-x:.12g} {-y:.12g})"
    kept = {k: v for k, (v, _) in declarations(element.get("style", "")).items() if not k.startswith("transform")}
    if "style" in element.attrib:
        element.set("style", ";".join(f"{name}:{value}" for name, value in kept.items()))
    element.attrib.pop("transform-origin", None)
    element.set("transform", transform)


def _plain_number(found: re.Match[str]) -> str:
    number, unit = float(found[1]), found[2]
    turns = {"deg": 1.0, "rad": 57.29577951308232, "turn": 360.0, "grad": 0.9}
    return f"{number * (turns[unit] if unit in turns else _PX[unit]):.12g}"


def _origin(text: str, box: tuple[float, float]) -> tuple[float, float]:
    words = text.split()
    if words[0] in ("top", "bottom") or (len(words) > 1 and words[1] in ("left", "right")):
        words = [*words[1:2], words[0]] if len(words) > 1 else ["center", words[0]]
    words = [*words[:2], "center"][:2]
    shares = {"left": 0.0, "top": 0.0, "center": 0.5, "right": 1.0, "bottom": 1.0}
    found = []
    for word, side in zip(words, box, strict=True):
        if word in shares:
            found.append(shares[word] * side)
        elif word.endswith("%"):
            found.append(float(word[:-1]) / 100 * side)
        else:
            found.append(_length(word))
    return found[0], found[1]


def _clipped(root: Element, named: Mapping[str, Element], seen: Seen) -> None:
    """Groups round what is clipped and what is masked; in the first the clipping path's shapes stand in front."""
    for parent in list(root.iter()):
        if _tag(parent) in ("clipPath", "mask"):
            continue
        for k, child in enumerate(list(parent)):
            said = properties(child)
            space = str(child.tag)[: -len(_tag(child))]
            if (mask := _url(said.get("mask", ""))) and mask in named:
                seen.masks += 1
                child = _wrapped(parent, k, child, f"{space}g", f"{MASK}{seen.masks}")
            if (clip := _url(said.get("clip-path", ""))) and clip in named:
                path = named[clip]
                if path.get("clipPathUnits") == "objectBoundingBox":
                    raise InputError(
                        f"the clipping path '{clip}' is in shares of what it clips, which is not read; release it in "
                        "the drawing program"
                    )
                seen.clips += 1
                child = _wrapped(parent, k, child, f"{space}g", f"{CLIP}{seen.clips}")
                shapes = Element(f"{space}g", {"id": f"{SHAPE}{seen.clips}"})
                if said.get("transform"):
                    shapes.set("transform", said["transform"])
                inner = SubElement(shapes, f"{space}g")
                if path.get("transform"):
                    inner.set("transform", str(path.get("transform")))
                inner.extend(copy.deepcopy(list(path)))
                for shape in inner.iter():
                    shape.attrib.pop("clip-path", None)
                child.insert(0, shapes)


def _wrapped(parent: Element, k: int, child: Element, tag: str, name: str) -> Element:
    group = Element(tag, {"id": name})
    group.append(child)
    parent[k] = group
    return group


def _url(text: str) -> str:
    found = re.fullmatch(r"\s*url\(\s*[\"']?#([^\"')]*)[\"']?\s*\)\s*", text)
    return found[1] if found else ""


def _without_hidden(element: Element, inherited: Mapping[str, str], opacity: float, seen: Seen) -> None:
    for child in list(element):
        if (child.get("id") or "").startswith(SHAPE):
            continue
        said = properties(child)
        own = dict(inherited) | {k: v for k, v in said.items() if k in _INHERITED and v != "inherit"}
        clear = opacity * _share(said.get("opacity", "1"))
        if said.get("display") == "none":
            _count(child, "display: none", seen)
            element.remove(child)
        elif _tag(child) in LEAVES:
            if why := _why_hidden(child, own, clear):
                seen.hidden[why] += 1
                element.remove(child)
        elif _tag(child) not in ("defs", "symbol"):
            _without_hidden(child, own, clear, seen)


def _count(element: Element, why: str, seen: Seen) -> None:
    if (count := sum(_tag(one) in LEAVES for one in element.iter())) > 0:
        seen.hidden[why] += count


def _why_hidden(leaf: Element, own: Mapping[str, str], opacity: float) -> str:
    """Why a shape is not seen; "" for one that is, and for a <line> of which nobody says how it is drawn."""
    if own.get("visibility") in ("hidden", "collapse"):
        return "visibility: hidden"
    if opacity <= 0:
        return "opacity 0"
    filled = _tag(leaf) != "line" and own.get("fill", "black").replace(" ", "") not in _NONE
    filled = filled and _share(own.get("fill-opacity", "1")) > 0
    drawn = (
        own.get("stroke", "black" if _tag(leaf) == "line" else "none").replace(" ", "") not in _NONE
        and _share(own.get("stroke-opacity", "1")) > 0
    )
    drawn = drawn and _is_width(own.get("stroke-width", "1"))
    return "" if filled or drawn else "neither line nor fill"


def _is_width(text: str) -> bool:
    found = re.match(r"\s*([0-9.]+(?:[eE][-+]?\d+)?)", text)
    return found is None or float(found[1]) > 0


def _share(text: str) -> float:
    try:
        return float(text.strip()[:-1]) / 100 if text.strip().endswith("%") else float(text)
    except ValueError:
        return 1.0


def hidden_told(seen: Seen) -> Iterator[str]:
    """A sentence for what was taken out."""
    if seen.hidden:
        listed = ", ".join(f"{count} ({why})" for why, count in sorted(seen.hidden.items()))
        shapes = "shape is" if sum(seen.hidden.values()) == 1 else "shapes are"
        yield f"left out, as the {shapes} not shown: {listed}"


# Lines that a drawing shows only in part, through a clipping path: what is not seen is not cut.

NEAR_MM = 0.01
"""A line that reaches no further out of its clipping path is shown whole."""

Clips = tuple[shapely.Geometry, ...]
"""Areas in mm; what is drawn is seen where it lies in all of them."""


def seen_through(pieces: Sequence[tuple[DrawnCurve, Clips]], asking: Asking) -> tuple[list[DrawnCurve], list[Note]]:
    """The pieces that are seen, and a word on those that are not.

    A piece that lies wholly in its clipping paths stays, one that lies outside is left out. One that is seen in part
    raises the question `clip`.
    """
    kept: list[DrawnCurve] = []
    hidden: list[DrawnCurve] = []
    partly: list[tuple[int, DrawnCurve, shapely.Geometry]] = []
    for piece, clips in pieces:
        if not clips:
            kept.append(piece)
            continue
        area, line = shapely.intersection_all(clips), piece.curve.line()
        if shapely.buffer(area, NEAR_MM).covers(line):
            kept.append(piece)
        elif (piece.area if piece.curve.closed else line).intersection(area).is_empty:
            hidden.append(piece)
        elif piece.curve.closed and not line.intersects(area.buffer(NEAR_MM)):
            hidden.append(piece)  # the hole in it is seen, its line nowhere
        else:
            partly.append((len(kept), piece, area))
    notes = [_note(hidden)] if hidden else []
    if not partly:
        return kept, notes
    said = asking.ask(_question([piece for _, piece, _ in partly]))
    if said == "ignore":
        return kept, [*notes, _note([piece for _, piece, _ in partly])]
    made = list(kept)
    for before, piece, area in reversed(partly):
        made[before:before] = [piece] if said == "whole" else _inside(piece, area)
    return made, notes


def texts_seen(texts: Sequence[tuple[DrawnText, Clips]]) -> tuple[tuple[DrawnText, ...], list[Note]]:
    """The texts and points that are seen whole, and a word on those that a clipping path hides, or hides in part."""
    kept: list[DrawnText] = []
    gone: list[DrawnText] = []
    for text, clips in texts:
        lines = [stroke.curve.line() for stroke in text.strokes] or [shapely.Point(text.look.curve.vertices[0, :2])]
        area = shapely.buffer(shapely.intersection_all(clips), NEAR_MM) if clips else None
        (kept if area is None or shapely.covers(area, lines).all() else gone).append(text)
    if not gone:
        return tuple(kept), []
    named = f"left out, as a clipping path hides them, or some of them: {counted(t.look.layer for t in gone)}"
    return tuple(kept), [Note("warning", f"{named}, the first the {gone[0].place}")]


def _question(partly: Sequence[DrawnCurve]) -> Question:
    count = len(partly)
    which = (
        f"the line {partly[0].place} is" if count == 1 else f"{count} lines ({counted(p.layer for p in partly)}) are"
    )
    return Question(
        "clip",
        f"{which} seen only in part, through a clipping path: what is cut?",
        (
            Choice("clipped", "what is seen, closed along the edge of the clipping path"),
            Choice("whole", "the whole, as it is drawn behind the clipping path"),
            Choice("ignore", "nothing of it"),
        ),
    )


def _note(hidden: Sequence[DrawnCurve]) -> Note:
    return Note("warning", f"left out, as a clipping path hides them: {counted(p.layer for p in hidden)}")


def _inside(piece: DrawnCurve, area: shapely.Geometry) -> list[DrawnCurve]:
    """The part of a piece that lies in an area."""
    shape = piece.area if piece.curve.closed else piece.curve.line(FLATTEN_MM)
    found = shapely.intersection(shape, area)
    return [replace(piece, curve=curve) for points in _runs(found) if (curve := _curve(points)) is not None]


def _runs(found: shapely.Geometry) -> Iterator[Floats]:
    for one in shapely.get_parts(found):
        if one.geom_type == "Polygon":
            yield from (np.array(ring.coords) for ring in (one.exterior, *one.interiors))
        elif one.geom_type == "LineString":
            yield np.array(one.coords)


def _curve(points: Floats) -> Curve | None:
    return fit_curve(points)
