"""The option that chooses a feed law: the name of a shipped one, or a plant's own, written out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources
from typing import Any

import yaml

from kerfwise.rules.options.kind import OptionKind, Unfit
from kerfwise.rules.options.plain_values import Choice, Number, Text
from kerfwise.rules.options.quantities import SPEED
from kerfwise.rules.options.suggest import unknown

from .feed_law import LONGEST, FeedLaw, LawPiece

NONE = "none"
_BLOCKS = Number(1, LONGEST, whole=True)


@cache
def shipped_laws() -> Mapping[str, FeedLaw]:
    """The laws that come with kerfwise, by name, each file in its own order.

    Examples
    --------
    >>> shipped_laws()["bystar-3015-amg3m-1mm"].mm_s(70)
    100.0
    """
    folder = resources.files(__package__) / "feed_laws"
    found: dict[str, FeedLaw] = {}
    for file in sorted((f for f in folder.iterdir() if f.name.endswith(".yaml")), key=lambda f: f.name):
        root = yaml.compose(file.read_text(encoding="utf-8"), Loader=yaml.SafeLoader)
        assert isinstance(root, yaml.MappingNode)
        for key, node in root.value:
            found[key.value] = replace(_read_law(node), name=key.value)
    return found


@dataclass(frozen=True, slots=True)
class LawKind(OptionKind):
    """A shipped law by name, a law of one's own as a mapping, or none."""

    def read(self, node: yaml.Node) -> FeedLaw | None:
        if isinstance(node, yaml.MappingNode):
            return _read_law(node)
        name = Text().read(node)
        if name == NONE:
            return None
        if name not in shipped_laws():
            hint = unknown("feed law", name, [*shipped_laws(), NONE])
            raise Unfit(f"{hint}; for a machine of your own give its points or pieces")
        return shipped_laws()[name]

    def write(self, value: FeedLaw | None) -> str:
        if value is None:
            return NONE
        return value.name or f"{{{', '.join(_written(value))}}}"

    def schema(self) -> dict[str, Any]:
        blocks, number = _BLOCKS.schema(), {"type": "number"}
        piece = {
            "up_to": blocks,
            "polynomial": {"type": "array", "items": number, "minItems": 1},
            "power": {"type": "array", "items": number, "minItems": 2, "maxItems": 2},
        }
        point = {"type": "array", "prefixItems": [blocks, SPEED.schema()], "minItems": 2, "maxItems": 2}
        keys = {
            "source": Text().schema(),
            "unit": {"enum": list(SPEED.units)},
            "points": {"type": "array", "items": point, "minItems": 1},
            "pieces": {
                "type": "array",
                "minItems": 1,
                "items": {
                    "type": "object",
                    "properties": piece,
                    "additionalProperties": False,
                    "oneOf": [{"required": ["polynomial"]}, {"required": ["power"]}],
                },
            },
        }
        own = {
            "type": "object",
            "properties": keys,
            "additionalProperties": False,
            "oneOf": [{"required": ["points"]}, {"required": ["pieces", "unit"]}],
        }
        return {"anyOf": [{"enum": [*shipped_laws(), NONE]}, own]}

    def expected(self) -> str:
        return "the name of a feed law, a law with points or pieces, or none"


def _read_law(node: yaml.Node) -> FeedLaw:
    members = _members(node, ("source", "unit", "points", "pieces"), "feed law")
    if ("points" in members) == ("pieces" in members):
        raise Unfit("expected either points, [[blocks, feed], …], or pieces, one formula each", node)
    law = FeedLaw(source=Text().read(members["source"]) if "source" in members else "")
    if "points" in members:
        if "unit" in members:
            raise Unfit("unit is of pieces; points carry their own, such as [120, 5.3 m/min]", members["unit"])
        law = replace(law, points=tuple(_point(point) for point in _list(members["points"], "points")))
    else:
        if "unit" not in members:
            raise Unfit(f"the formulas need their unit: expected one of {', '.join(SPEED.units)}", node)
        unit = str(Choice(tuple(SPEED.units)).read(members["unit"]))
        law = replace(law, unit=unit, pieces=tuple(_piece(piece) for piece in _list(members["pieces"], "pieces")))
    if wrong := law.wrong():
        raise Unfit(wrong, members["points" if law.points else "pieces"])
    return law


def _point(node: yaml.Node) -> tuple[int, float]:
    if not isinstance(node, yaml.SequenceNode) or len(node.value) != 2:
        raise Unfit("expected a point [blocks, feed] such as [120, 5.3 m/min]", node)
    blocks, feed = node.value
    return int(_BLOCKS.read(blocks)), float(SPEED.read(feed))


def _piece(node: yaml.Node) -> LawPiece:
    members = _members(node, ("up_to", "polynomial", "power"), "piece")
    if ("polynomial" in members) == ("power" in members):
        raise Unfit("expected either polynomial: [a, b, c] (a + b n + c n²) or power: [a, b] (a nᵇ)", node)
    up_to = int(_BLOCKS.read(members["up_to"])) if "up_to" in members else None
    if "polynomial" in members:
        return LawPiece(up_to, tuple(_numbers(members["polynomial"])))
    numbers = _numbers(members["power"])
    if len(numbers) != 2:
        raise Unfit("expected power: [factor, exponent]", members["power"])
    return LawPiece(up_to, power=(numbers[0], numbers[1]))


def _numbers(node: yaml.Node) -> list[float]:
    return [float(Number().read(number)) for number in _list(node, "numbers")]


def _list(node: yaml.Node, what: str) -> list[yaml.Node]:
    if not isinstance(node, yaml.SequenceNode) or not node.value:
        raise Unfit(f"expected a list of {what}", node)
    return list(node.value)


def _members(node: yaml.Node, keys: tuple[str, ...], what: str) -> dict[str, yaml.Node]:
    if not isinstance(node, yaml.MappingNode):
        raise Unfit(f"expected a {what} as a mapping with {', '.join(keys)}", node)
    found: dict[str, yaml.Node] = {}
    for key, value in node.value:
        if key.value not in keys:
            raise Unfit(unknown("key", str(key.value), keys), key)
        if key.value in found:
            raise Unfit(f"key {key.value!r} is given twice", key)
        found[key.value] = value
    return found


def _written(law: FeedLaw) -> list[str]:
    """The keys of a plant's own law as YAML that reads back the same."""
    said = [f"source: {Text().write(law.source)}"] if law.source else []
    if law.points:
        points = ", ".join(f"[{blocks}, {SPEED.write(mm_s)}]" for blocks, mm_s in law.points)
        return [*said, f"points: [{points}]"]
    return [*said, f"unit: {law.unit}", f"pieces: [{', '.join(map(_written_piece, law.pieces))}]"]


def _written_piece(piece: LawPiece) -> str:
    up_to = [] if piece.up_to is None else [f"up_to: {piece.up_to}"]
    name, numbers = ("power", piece.power) if piece.power is not None else ("polynomial", piece.polynomial)
    written = f"{name}: [{', '.join(map(_yaml_number, numbers))}]"
    return f"{{{', '.join([*up_to, written])}}}"


def _yaml_number(value: float) -> str:
    """A number that every YAML reader takes for one: PyYAML wants a point before the exponent.

    Examples
    --------
    >>> _yaml_number(-4e-12), _yaml_number(0.1)
    ('-4.0e-12', '0.1')
    """
    mantissa, e, exponent = repr(value).partition("e")
    return f"{mantissa if '.' in mantissa else mantissa + '.0'}{e}{exponent}"
