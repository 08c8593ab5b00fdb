"""What a profile says of time, and the law by which feeds fall with the length of a program."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources
from itertools import pairwise
from typing import Any, Literal

import numpy as np
import yaml

from kerfwise.encoder.nearest_name import unknown
from kerfwise.rules.options.kind import Choice, Number, OptionKind, Text, Unfit
from kerfwise.rules.options.option import setting
from kerfwise.rules.options.quantities import ACCELERATION, CUT_FEED, LENGTH, SPEED, likely, positive

# Cutting feed by the length of the program: how fast a machine really cuts when its program has n blocks.
#
# Tavaeva and Petunin measured that the feed of a laser machine is not the one that was set but falls with the number
# of NC blocks. A plant states its own machine in the same two ways: by formulas for ranges of n, or by measured
# points.

LONGEST = 100_000
"""Blocks up to which a polynomial may hold: beyond it nothing has been measured."""


@dataclass(frozen=True, slots=True)
class LawPiece:
    """A formula for programs of up to `up_to` blocks, or, where that is None, of any more.

    Either `polynomial`, its coefficients from the constant up, or `power`, a factor and an exponent of n; the feed in
    the law's unit.
    """

    up_to: int | None
    polynomial: tuple[float, ...] = ()
    power: tuple[float, float] | None = None

    def at(self, blocks: float) -> float:
        """The formula's value at n = `blocks`, whatever range it is for."""
        try:
            if self.power is not None:
                return float(self.power[0] * blocks ** self.power[1])
            return float(sum(c * blocks**k for k, c in enumerate(self.polynomial)))
        except OverflowError:
            return math.inf


@dataclass(frozen=True, slots=True)
class FeedLaw:
    """V_on as a function of n, by `pieces` in ascending order of n or by `points` (n, mm/s), one of the two.

    `name` is that of a shipped law, "" for a plant's own; `unit` is the one that the formulas give. Between points the
    feed is interpolated, beyond the first and last it stays as it is there.

    Examples
    --------
    >>> FeedLaw(points=((10, 100.0), (20, 80.0))).mm_s(15)
    90.0
    >>> law = FeedLaw(unit="m/s", pieces=(LawPiece(70, (0.1,)), LawPiece(None, power=(0.2572, -0.222))))
    >>> law.mm_s(1), round(law.mm_s(120), 2)
    (100.0, 88.86)
    """

    name: str = ""
    source: str = ""
    unit: str = "mm/s"
    pieces: tuple[LawPiece, ...] = ()
    points: tuple[tuple[int, float], ...] = ()

    def mm_s(self, blocks: int) -> float:
        """The cutting feed of a program of so many blocks, mm/s."""
        if self.points:
            known, feeds = np.array(self.points).T
            return float(np.interp(blocks, known, feeds))
        piece = next(p for p in self.pieces if p.up_to is None or blocks <= p.up_to)
        return piece.at(max(blocks, 1)) * self.unit_mm_s

    @property
    def unit_mm_s(self) -> float:
        """The size of the formulas' unit, mm/s."""
        return float(SPEED.units[self.unit])

    @property
    def fastest_mm_s(self) -> float:
        """The fastest feed of any program, mm/s."""
        return max(self._marks())

    def wrong(self) -> str | None:
        """What keeps the law from giving a feed for every program, in words; None where nothing does."""
        if bool(self.pieces) == bool(self.points):
            return "give either points or pieces"
        ends = [n for n, _ in self.points] if self.points else [p.up_to for p in self.pieces[:-1]]
        if any(n is None for n in ends):
            return "only the last piece holds for all longer programs: give the others up_to"
        numbers = [n for n in ends if n is not None]
        if any(b <= a for a, b in pairwise(numbers)):
            return f"numbers of blocks are expected in ascending order, got {', '.join(map(str, numbers))}"
        if self.pieces:
            last = self.pieces[-1]
            falls = len(last.polynomial) == 1 if last.power is None else last.power[1] <= 0
            if last.up_to is not None or not falls:
                return (
                    "the last piece holds for all longer programs: expected a constant (polynomial: [0.1]) or a power "
                    "that does not rise, without up_to"
                )
        slowest = min(self._marks())
        return None if slowest > 0 else f"the feed must be over 0 for every n, it falls to {slowest:.6g} mm/s"

    def unlikely(self) -> str | None:
        """What of a law's feeds no machine has, in words; None where they are likely up to the longest program."""
        low, high = CUT_FEED.likely or (0.0, math.inf)
        feeds = [*self._marks(), self.mm_s(LONGEST)]
        for mm_s in (min(feeds), max(feeds)):
            if not low <= mm_s <= high:
                text = f"{mm_s:.6g} mm/s" if mm_s < math.inf else "no number any more"
                return (
                    f"the feed is {text} for some program of up to {LONGEST} blocks: expected {low:g} to {high:g} "
                    "mm/s; are the formulas in another unit?"
                )
        return None

    def _marks(self) -> list[float]:
        """The feed at every n where it can be largest or smallest."""
        if self.points:
            return [v for _, v in self.points]
        found, first = [], 1
        for piece in self.pieces:
            last = first if piece.up_to is None else piece.up_to
            values = [piece.at(blocks) for blocks in range(first, last + 1)]
            found += [min(values), max(values)]
            first = last + 1
        return [v * self.unit_mm_s for v in found]


# The option that chooses a feed law: the name of a shipped one, or a plant's own, written out.

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
    if wrong := law.wrong() or law.unlikely():
        raise Unfit(wrong, members["points" if law.points else "pieces"])
    return law


def _point(node: yaml.Node) -> tuple[int, float]:
    if not isinstance(node, yaml.SequenceNode) or len(node.value) != 2:
        raise Unfit("expected a point [blocks, feed] such as [120, 5.3 m/min]", node)
    blocks, feed = node.value
    return int(_BLOCKS.read(blocks)), float(CUT_FEED.read(feed))


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
    lines = [f"source: {Text().write(law.source)}"] if law.source else []
    if law.points:
        points = ", ".join(f"[{blocks}, {SPEED.write(mm_s)}]" for blocks, mm_s in law.points)
        return [*lines, f"points: [{points}]"]
    return [*lines, f"unit: {law.unit}", f"pieces: [{', '.join(map(_written_piece, law.pieces))}]"]


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


TimeModel = Literal["constant", "blocks", "acceleration"]
_MODELS = Choice(("constant", "blocks", "acceleration"))


@dataclass(frozen=True, slots=True)
class Time:
    """How the time of a program is computed: at constant feeds, by its number of blocks, or with acceleration."""

    model: TimeModel = setting("constant", _MODELS, "constant feeds, feed by NC blocks, or limited acceleration")
    feed_by_blocks: FeedLaw | None = setting(
        None, LawKind(), "feed law of the model blocks: a shipped one's name, or one's own"
    )
    acceleration_mm_s2: float = setting(
        1000.0, likely(ACCELERATION, 1.0, 1e6), "of the axes, for the model acceleration"
    )
    corner_deviation_mm: float = setting(
        0.05, likely(positive(LENGTH), 1e-4, 50.0), "how far a corner may be rounded to take it faster"
    )

    def quicker_than_its_words(self, cut_feed_mm_s: float) -> Iterator[str]:
        """That the torch moves faster by the law than programs say, which no machine does."""
        law = self.feed_by_blocks
        given = "give the law that was measured at this feed, or time.model: acceleration"
        if self.model == "blocks" and law is not None and law.fastest_mm_s > _QUICKER * cut_feed_mm_s:
            most, feed = (f"{mm_s * 60 / 1000:.4g} m/min" for mm_s in (law.fastest_mm_s, cut_feed_mm_s))
            named = f"feed law {law.name}" if law.name else "feed law"
            yield (
                f"time: by the {named} the torch moves at up to {most}, and programs say {feed} (machine.cut_feed): "
                f"the times told are too short; {given}"
            )


_QUICKER = 1.25
"""Short programs run a little faster than the set feed, by laws that were measured: never so much."""


@dataclass(frozen=True, slots=True)
class LawLeft:
    """A feed law that a profile inherits and does not use: its name, "" for a plant's own, and its feed."""

    name: str
    measured_mm_s: float

    def told(self, cut_feed_mm_s: float) -> str:
        """That it is not used, and why, for a planner.

        Examples
        --------
        >>> LawLeft("big laser", 100.0).told(50.0).partition(";")[0]
        'time: the feed law big laser is for a cut_feed of 6 m/min and is not used at 3 m/min'
        """
        law = f"feed law {self.name}" if self.name else "feed law of the profile that it is based on"
        measured, feed = (f"{mm_s * 60 / 1000:.4g} m/min" for mm_s in (self.measured_mm_s, cut_feed_mm_s))
        return (
            f"time: the {law} is for a cut_feed of {measured} and is not used at {feed}; times are told at that feed, "
            "with acceleration (give time.model for another)"
        )
