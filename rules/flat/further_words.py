"""Words about contours beside the facts: sizes, and what the nest's file says of its parts. Of the nest alone."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping

from kerfwise.encoder.nest import Nest
from kerfwise.rules.minizinc.dzn import flags, numbers
from kerfwise.rules.own.measures import areas_mm2, attributes, lengths_mm, rectangle_sides_mm, sizes_mm

PER_MM = 100
_SIZES: Mapping[str, Callable[[Nest], list[int]]] = {
    "contour_area": lambda nest: [round(v) for v in areas_mm2(nest)],
    "contour_length": lambda nest: [round(v * PER_MM) for v in lengths_mm(nest)],
    "contour_width": lambda nest: [round(v * PER_MM) for v in sizes_mm(nest, 0)],
    "contour_height": lambda nest: [round(v * PER_MM) for v in sizes_mm(nest, 1)],
    "short_side": lambda nest: [round(v * PER_MM) for v in rectangle_sides_mm(nest, longer=False)],
    "long_side": lambda nest: [round(v * PER_MM) for v in rectangle_sides_mm(nest, longer=True)],
}
"""Word → its values: lengths in whole 0.01 mm as all facts, the area in whole mm²."""


def further_words(nest: Nest, text: str) -> str:
    """MiniZinc text that defines, with their values, the further words that a rule's text names.

    `attribute_NAME[i]` is what the nest's file says of the part of contour i: a number, rounded, or a text; 0 or ""
    where it says nothing, and there `has_attribute_NAME[i]` is false.
    """
    named = dict.fromkeys(re.findall(r"[A-Za-z_]\w*", text))
    lines = [f"array[CONTOUR] of int: {word} = {numbers(_SIZES[word](nest))};" for word in _SIZES if word in named]
    wanted = {re.sub(r"^(has_)?attribute_", "", w) for w in named if re.match(r"(has_)?attribute_\w", w)}
    for name in sorted(wanted):
        values = attributes(nest, name)
        given = [v for v in values if v is not None]
        lines.append(f"array[CONTOUR] of bool: has_attribute_{name} = {flags(v is not None for v in values)};")
        if all(isinstance(v, int | float) for v in given):
            lines.append(f"array[CONTOUR] of int: attribute_{name} = {numbers(round(v or 0) for v in values)};")
        else:
            texts = ", ".join(json.dumps("" if v is None else str(v), ensure_ascii=False) for v in values)
            lines.append(f"array[CONTOUR] of string: attribute_{name} = [{texts}];")
    return "".join(f"{line}\n" for line in lines)
