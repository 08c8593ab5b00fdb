"""What an SVG file shows: clones drawn, styles laid on, what is hidden or clipped away taken out."""

from __future__ import annotations

import copy
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from xml.etree.ElementTree import Element, SubElement

from kerfwise.encoder.errors import InputError

from .svg_css import XLINK, called, declarations, href_of, properties, tag_of, with_style
from .svg_text import TEXT, write_out
from .svg_viewports import PX, VIEWPORT, length_px, lengths_resolved, symbol_fitted, view_size

CLIP, SHAPE, MASK = "kerfwise-clip-", "kerfwise-clip-shape-", "kerfwise-mask-"
"""How the ids of groups begin that stand round what is clipped, round its clipping path, and round what is masked."""

FILLED = "data-kerfwise-filled"
"""An attribute of shapes of which the file says how they are filled; others are black for want of a word."""
LEAVES = frozenset({"path", "rect", "circle", "ellipse", "line", "polyline", "polygon"})
_INHERITED = (
    "visibility", "fill", "stroke", "fill-opacity", "stroke-opacity", "stroke-width", "stroke-dasharray",
    "stroke-linecap", "color",
)  # fmt: skip
MATTERS = frozenset(
    (*_INHERITED, "display", "opacity", "filter", "mask", "d", "transform", "x", "y", "width", "height", "rx", "ry",
     "r", "cx", "cy")
)  # fmt: skip
"""What decides whether and where something is seen."""


@dataclass(slots=True)
class Seen:
    """What was taken out, by why: how many shapes; and what is not read, as it is in no or another file, with why."""

    hidden: Counter[str] = field(default_factory=Counter)
    missing: list[str] = field(default_factory=list)
    clips: int = 0
    masks: int = 0


def laid_out(root: Element) -> Seen:
    """Draw clones, move origins of transforms, mark clipping paths, and take out what is not shown.

    Raises InputError for what cannot be told, such as a clipping path in shares of a shape's box.
    """
    seen = Seen()
    _not_read(root, seen)
    named = {element.get("id", ""): element for element in root.iter() if element.get("id")}
    _only_what_applies(root, seen)
    lengths_resolved(root)
    _clones(root, named, seen)
    box = view_size(root)
    for element in list(root.iter()):
        _moved_origin(element, box)
    write_out(root, box)
    _clipped(root, named, seen)
    around = Element("g")
    around.append(root)
    _without_hidden(around, {}, 1.0, named, seen)
    if not len(around):
        del root[:]
        root.attrib = {k: v for k, v in root.attrib.items() if k not in ("style", "display")}
    return seen


_OTHER = "of a <switch>, or for another viewer or language than English"


def _only_what_applies(parent: Element, seen: Seen) -> None:
    """Only what any viewer shows, or one in English; of every <switch> the first such child."""
    children = [child for child in parent if isinstance(child.tag, str)]
    shown = [child for child in children if _applies(child)]
    kept = shown[:1] if tag_of(parent) == "switch" else shown
    for child in kept:
        _only_what_applies(child, seen)
    for child in (*shown[len(kept) :], *(child for child in children if not _applies(child))):
        parent.remove(child)
        if drawn := sum(tag_of(one) in (*LEAVES, "text", "use") for one in child.iter()):
            seen.hidden[_OTHER] += drawn


def _applies(child: Element) -> bool:
    languages = child.get("systemLanguage")
    spoken = languages is None or any(word.strip().lower().startswith("en") for word in languages.split(","))
    return spoken and not child.get("requiredExtensions")


def _clones(root: Element, named: Mapping[str, Element], seen: Seen) -> None:
    """Every <use> as a group that holds a copy of what it shows; symbols are groups, fitted into their size."""
    for parent in list(root.iter()):
        for k, child in enumerate(list(parent)):
            if tag_of(child) == "use":
                parent[k] = _drawn(child, named, (), seen)


def _drawn(use: Element, named: Mapping[str, Element], within: tuple[str, ...], seen: Seen) -> Element:
    href = href_of(use)
    space = str(use.tag)[: -len("use")]
    kept = {k: v for k, v in use.items() if k not in ("href", XLINK, "x", "y", "width", "height", VIEWPORT)}
    group = Element(f"{space}g", kept)
    group.tail = use.tail
    target = named.get(href.removeprefix("#")) if href.startswith("#") else None
    if target is None and href:
        why = "the file holds no such thing" if href.startswith("#") else "it is in another file"
        seen.missing.append(f"a clone of '{href}' is left out: {why}")
    if target is None or href in within or not _applies(target):
        return group
    x, y = (length_px(use.get(name, "0")) for name in ("x", "y"))
    holder = SubElement(group, f"{space}g", {"transform": f"translate({x:.12g} {y:.12g})"}) if x or y else group
    inner = copy.deepcopy(target)
    if tag_of(inner) in ("symbol", "svg"):
        transform = symbol_fitted(inner, use)
        if transform is None:
            return group
        inner.tag = f"{space}g"
        for name in ("viewBox", "width", "height", "x", "y", "preserveAspectRatio"):
            inner.attrib.pop(name, None)
        if transform:
            inner.set("transform", transform)
    holder.append(inner)
    for parent in list(holder.iter()):
        for k, child in enumerate(list(parent)):
            if tag_of(child) == "use":
                parent[k] = _drawn(child, named, (*within, href), seen)
    return group


_MOVES = ("translate", "rotate", "scale", "offset-path", "offset", "zoom")
"""Properties of styles that move something as `transform` does."""


def _moved_origin(element: Element, box: tuple[float, float]) -> None:
    """A transform of a style becomes an attribute, about its origin."""
    style, own = properties(element), declarations(element.get("style", ""))
    for name in _MOVES:
        if name in own and own[name][0].lower() not in ("none", "initial", "unset", "normal", "1"):
            what = f"{called(element)} is moved by its style ({name}: {own[name][0]}), which is not read"
            raise InputError(f"{what}; save the drawing as plain SVG, with transforms")
    styled = own.get("transform", ("", False))[0]
    transform = styled or element.get("transform", "")
    origin = style.get("transform-origin", "").strip()
    if not transform or transform == "none" or not (styled or origin):
        return
    transform = re.sub(
        r"([-+]?[0-9.]+(?:[eE][-+]?\d+)?)(px|mm|cm|in|pt|pc|deg|rad|turn|grad)\b", _plain_number, transform
    )
    if origin and origin not in ("0 0", "0px 0px", "0"):
        if style.get("transform-box", "view-box") not in ("view-box", "") and tag_of(element) != "svg":
            raise InputError(
                f"{called(element)} is turned about its own box (transform-box), which is not read; save the "
                "drawing as plain SVG"
            )
        x, y = _origin(origin, box)
        transform = f"translate({x:.12g} {y:.12g}) {transform} translate({-x:.12g} {-y:.12g})"
    kept = {k: v for k, (v, _) in own.items() if not k.startswith("transform")}
    if "style" in element.attrib:
        with_style(element, kept)
    element.attrib.pop("transform-origin", None)
    element.set("transform", transform)


def _plain_number(found: re.Match[str]) -> str:
    number, unit = float(found[1]), found[2]
    turns = {"deg": 1.0, "rad": 57.29577951308232, "turn": 360.0, "grad": 0.9}
    return f"{number * (turns[unit] if unit in turns else PX[unit]):.12g}"


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
            found.append(length_px(word))
    return found[0], found[1]


def _clipped(root: Element, named: Mapping[str, Element], seen: Seen) -> None:
    """Groups round what is clipped and what is masked; in the first the clipping path's shapes stand in front."""
    for parent in list(root.iter()):
        if tag_of(parent) in ("clipPath", "mask"):
            continue
        for k, child in enumerate(list(parent)):
            style = properties(child)
            space = str(child.tag)[: -len(tag_of(child))]
            mask = next((style[name] for name in _MASKS if style.get(name)), "none")
            if mask.strip() != "none" and (not _url(mask) or _url(mask) in named):
                seen.masks += 1
                child = _wrapped(parent, k, child, f"{space}g", f"{MASK}{seen.masks}")
            if region := child.attrib.pop(VIEWPORT, ""):
                numbers = zip(("x", "y", "width", "height"), region.split(), strict=True)
                seen.clips += 1
                shapes = Element(f"{space}g", {"id": f"{SHAPE}{seen.clips}"})
                SubElement(shapes, f"{space}rect", dict(numbers))
                child.insert(0, shapes)
                child = _wrapped(parent, k, child, f"{space}g", f"{CLIP}{seen.clips}")
            clip, clips = style.get("clip-path", "none").strip(), list[str]()
            if "(" in clip and not _url(clip):
                raise InputError(f"{called(child)} is clipped by {clip}, which is not read; release it in {_PROGRAM}")
            while _url(clip) in named and clip not in clips:  # a clipping path may be clipped itself
                seen.clips += 1
                clips.append(clip)
                path = named[_url(clip)]
                shapes = _clipping_shapes(path, space, style.get("transform", ""), seen.clips)
                child = _wrapped(parent, k, child, f"{space}g", f"{CLIP}{seen.clips}")
                child.insert(0, shapes)
                clip = properties(path).get("clip-path", "none").strip()


_PROGRAM = "the drawing program"
_MASKS = ("mask", "mask-image", "-webkit-mask", "-webkit-mask-image")


def _clipping_shapes(path: Element, space: str, transform: str, number: int) -> Element:
    """What a clipping path is made of, as a group that is moved with what it clips."""
    name = path.get("id")
    if path.get("clipPathUnits") == "objectBoundingBox":
        raise InputError(
            f"the clipping path '{name}' is in shares of what it clips, which is not read; release it in {_PROGRAM}"
        )
    if any(tag_of(one) in ("text", "image") or one.get(TEXT) for one in path.iter()):
        raise InputError(f"the clipping path '{name}' is made of letters, which is not read; release it in {_PROGRAM}")
    shapes = Element(f"{space}g", {"id": f"{SHAPE}{number}"})
    if transform:
        shapes.set("transform", transform)
    kept = {key: value for key, value in properties(path).items() if key in ("transform", "clip-rule")}
    inner = SubElement(shapes, f"{space}g", kept)
    inner.extend(copy.deepcopy(list(path)))
    clipped = [shape for shape in inner.iter() if properties(shape).get("clip-path", "none") != "none"]
    if clipped:
        raise InputError(
            f"{called(clipped[0])} in the clipping path '{name}' is clipped itself, which is not read; release it in "
            f"{_PROGRAM}"
        )
    return shapes


def _wrapped(parent: Element, k: int, child: Element, tag: str, name: str) -> Element:
    group = Element(tag, {"id": name})
    group.append(child)
    parent[k] = group
    return group


def _url(text: str) -> str:
    found = re.match(r"\s*url\(\s*[\"']?#([^\"')]*)[\"']?\s*\)", text)
    return found[1] if found else ""


def _without_hidden(
    element: Element, inherited: Mapping[str, str], opacity: float, named: Mapping[str, Element], seen: Seen
) -> None:
    for child in list(element):
        if (child.get("id") or "").startswith(SHAPE) or not isinstance(child.tag, str):
            continue
        style = properties(child)
        own = dict(inherited) | {k: v for k, v in style.items() if k in _INHERITED and v not in ("inherit", "unset")}
        own = {k: v for k, v in own.items() if v != "initial"}
        clear = opacity * _share(style.get("opacity", "1"))
        for share in re.findall(r"\bopacity\(([^()]+)\)", style.get("filter", "")):
            clear *= _share(share)
        if style.get("display", "").strip().lower() == "none":
            _count(child, "display: none", seen)
            element.remove(child)
        elif tag_of(child) in LEAVES:
            if why := _why_hidden(child, own, style, clear, named):
                seen.hidden[why] += 1
                element.remove(child)
            elif "fill" in own:
                child.set(FILLED, "yes")
        elif tag_of(child) not in _HOLDERS:
            _count(child, f"in <{tag_of(child)}>, which no viewer knows", seen)
            element.remove(child)
        elif tag_of(child) not in ("defs", "symbol"):
            _without_hidden(child, own, clear, named, seen)


_HOLDERS = frozenset({
    "svg", "g", "a", "switch", "defs", "symbol", "text", "image", "style", "title", "desc", "metadata", "clipPath",
    "mask", "marker", "pattern", "filter", "script", "foreignObject", "view", "linearGradient", "radialGradient",
    "stop", "namedview", "animate", "animateTransform", "animateMotion", "set",
})  # fmt: skip
"""Elements with others inside, as far as they are looked into or passed over without a word."""


def _count(element: Element, why: str, seen: Seen) -> None:
    if (count := sum(tag_of(one) in LEAVES for one in element.iter())) > 0:
        seen.hidden[why] += count


def _why_hidden(
    leaf: Element, own: Mapping[str, str], style: Mapping[str, str], opacity: float, named: Mapping[str, Element]
) -> str:
    """Why a shape is not seen; "" for one that is, and for a <line> of which nobody says how it is drawn."""
    if own.get("visibility", "").strip().lower() in ("hidden", "collapse"):
        return "visibility: hidden"
    if opacity < FAINTEST:
        return "opacity 0"
    if any(length_px(style.get(name, "0")) < 0 for name in ("width", "height", "r")):
        return "size below 0"
    if tag_of(leaf) == "rect" and any(style.get(name, "auto").strip() == "auto" for name in ("width", "height")):
        return "a side is missing"
    colour = own.get("color", "black")
    filled = tag_of(leaf) != "line" and not _is_clear(own.get("fill", "black"), colour, named)
    filled = filled and _share(own.get("fill-opacity", "1")) > 0
    drawn = (
        not _is_clear(own.get("stroke", "black" if tag_of(leaf) == "line" else "none"), colour, named)
        and _share(own.get("stroke-opacity", "1")) > 0
    )
    drawn = drawn and _is_width(own.get("stroke-width", "1")) and not _is_all_gaps(own)
    return "" if filled or drawn else "neither line nor fill"


FAINTEST = 1 / 510
"""The faintest of 256 shades is seen, what is half of it is not."""


def _is_clear_server(name: str, named: Mapping[str, Element]) -> bool:
    """Whether a gradient is clear all over, or a pattern holds nothing; of one without stops, those of another hold."""
    for _ in range(5):
        if name not in named:
            return True
        server = named[name]
        if tag_of(server) == "pattern" and len(server):
            return False
        if stops := [properties(one) for one in server if tag_of(one) == "stop"]:
            return all(
                _share(stop.get("stop-opacity", "1")) <= 0 or _is_clear(stop.get("stop-color", "black"), "black", {})
                for stop in stops
            )
        name = href_of(server).removeprefix("#")
    return True


def _is_all_gaps(own: Mapping[str, str]) -> bool:
    """Whether a line is dashed by dashes that have no length, nor ends that stick out."""
    numbers = [float(number) for number in re.findall(r"[0-9.]+", own.get("stroke-dasharray", ""))]
    dashes = numbers if len(numbers) % 2 else numbers[::2]
    return any(numbers) and not any(dashes) and own.get("stroke-linecap", "butt").strip() == "butt"


def _is_clear(paint: str, colour: str, named: Mapping[str, Element]) -> bool:
    """Whether nothing is seen of a paint; `colour` is the current one.

    Examples
    --------
    >>> [_is_clear(paint, "red", {}) for paint in ("none", "#00f0", "rgb(0 0 0 / 0%)", "url(#gone)", "hsla(0,0%,0%,0)")]
    [True, True, True, True, True]
    >>> [_is_clear(paint, "red", {}) for paint in ("#000", "currentColor", "rgb(0,0,0)", "url(#gone) blue")]
    [False, False, False, False]
    """
    text = paint.strip().lower()
    if name := _url(paint.strip()):
        after = text.partition(")")[2].strip()
        return _is_clear(after or "none", colour, named) if name not in named else _is_clear_server(name, named)
    if text == "currentcolor":
        return colour.strip().lower() != "currentcolor" and _is_clear(colour, "black", named)
    if re.fullmatch(r"#(?:[0-9a-f]{3}0|[0-9a-f]{6}00)", text) or text in _CLEAR:
        return True
    found = re.fullmatch(r"[a-z]+\((.*)\)", text)
    if found is None:
        return False
    _, slash, alpha = found[1].rpartition("/")
    values = found[1].split(",")
    alpha = alpha if slash else values[3] if len(values) == 4 else "1"
    return _share(alpha) <= 0


_CLEAR = ("none", "transparent", "context-fill", "context-stroke")
"""The last two are those of a shape that a marker is on."""


def _is_width(text: str) -> bool:
    found = re.match(r"\s*([0-9.]+(?:[eE][-+]?\d+)?)", text)
    return found is None or float(found[1]) > 0


def _share(text: str) -> float:
    try:
        return float(text.strip()[:-1]) / 100 if text.strip().endswith("%") else float(text)
    except ValueError:
        return 1.0


def _not_read(root: Element, seen: Seen) -> None:
    """Say what of a file is drawn and is no line, or moves; what stands in a <foreignObject> is taken out."""
    styles = [properties(element) for element in root.iter() if isinstance(element.tag, str)]
    tags = Counter(tag_of(element) for element in root.iter())
    marked = sum(any(_url(style.get(name, "")) for name in _MARKERS) for style in styles)
    patterns = {
        name for name, one in ((one.get("id", ""), one) for one in root.iter()) if tag_of(one) == "pattern" and len(one)
    }
    filled = sum(_url(style.get("fill", "")) in patterns for style in styles)
    moving = sum(tags[name] for name in ("animate", "animateTransform", "animateMotion", "set"))
    for count, what in (
        (marked, "markers of lines, such as arrow heads"),
        (filled, "patterns that shapes are filled with"),
        (tags["foreignObject"], "what stands in a <foreignObject>"),
        (moving, "animations, so that all is read as it stands without them"),
    ):
        if count:
            seen.missing.append(f"left out: {what} ({count})")


_MARKERS = ("marker", "marker-start", "marker-mid", "marker-end")


def hidden_told(seen: Seen) -> Iterator[str]:
    """A sentence for what was taken out."""
    if seen.hidden:
        listed = ", ".join(f"{count} ({why})" for why, count in sorted(seen.hidden.items()))
        shapes = "shape is" if sum(seen.hidden.values()) == 1 else "shapes are"
        yield f"left out, as the {shapes} not shown: {listed}"
    yield from sorted(set(seen.missing))
