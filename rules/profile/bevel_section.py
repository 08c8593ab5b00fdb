"""What a profile says of bevels: the head that tilts, its words, the kerf by angle, and what it does at corners."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import yaml

from kerfwise.encoder.bevels.bevel import Bevel, Face
from kerfwise.encoder.bevels.round import Corner
from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.kind import Choice, Number, OptionKind, Text, Unfit
from kerfwise.rules.options.option import setting
from kerfwise.rules.options.quantities import KERF, LENGTH, MASS, OrWord, likely, positive

Head = Literal["tilting", "block"]
Axis = Literal["A", "B", "C"]
_AXES = Choice(("A", "B", "C"))
_ANGLE = Number(0, 60)


@dataclass(frozen=True, slots=True)
class KerfByAngle(OptionKind):
    """A kerf by the angle of the torch, such as `{30: 2.0 mm, 45: 2.4 mm}`: rows in the order of angles."""

    def read(self, node: yaml.Node) -> tuple[tuple[float, float], ...]:
        if not isinstance(node, yaml.MappingNode):
            raise self.refuse(node)
        rows = sorted((float(_ANGLE.read(key)), float(KERF.read(value))) for key, value in node.value)
        if len({angle for angle, _ in rows}) < len(rows):
            raise Unfit("the same angle is given twice", node)
        return tuple(rows)

    def write(self, value: tuple[tuple[float, float], ...]) -> str:
        return "{" + ", ".join(f"{angle:g}: {KERF.write(kerf_mm)}" for angle, kerf_mm in value) + "}"

    def schema(self) -> dict[str, Any]:
        return {"type": "object", "additionalProperties": KERF.schema()}

    def expected(self) -> str:
        return "a table by angle such as {30: 2.0 mm, 45: 2.4 mm}"


@dataclass(frozen=True, slots=True)
class BevelPairs(OptionKind):
    """A mapping of texts, each to a bevel, such as `{'V45': 'V 45 top'}`: kept as pairs, in the order written."""

    def read(self, node: yaml.Node) -> tuple[tuple[str, Bevel], ...]:
        if not isinstance(node, yaml.MappingNode):
            raise self.refuse(node)
        found: dict[str, Bevel] = {}
        for key, entry in node.value:
            try:
                found[Text(pattern=True).read(key)] = Bevel.parse(str(Text().read(entry)))
            except InputError as error:
                raise Unfit(error.message, entry) from None
        return tuple(found.items())

    def write(self, value: tuple[tuple[str, Bevel], ...]) -> str:
        return "{" + ", ".join(f"{Text().write(key)}: {Text().write(str(bevel))}" for key, bevel in value) + "}"

    def schema(self) -> dict[str, Any]:
        number = r"\s+\d+(\.\d+)?"
        pattern = (
            rf"^\s*[VXYKvxyk]{number}(\s+[Ll][Aa][Nn][Dd]{number})?(\s+([Tt][Oo][Pp]|[Bb][Oo][Tt]{{2}}[Oo][Mm]))?\s*$"
        )
        return {"type": "object", "additionalProperties": {"type": "string", "pattern": pattern}}

    def expected(self) -> str:
        return "a mapping such as {'^V45$': 'V 45 top', red: 'Y 30 land 4 bottom'}"


@dataclass(frozen=True, slots=True)
class BevelSection:
    """A head that tilts, for the bevels that nests have."""

    head: Head | None = setting(
        None,
        Choice(("off", "tilting", "block"), none="off"),
        "what cuts bevels: one torch that tilts, or a block of three that turns",
        named=("tilting",),
    )
    tilt: Axis = setting("A", _AXES, "the axis that tilts the torch from the vertical")
    turn: Axis = setting("C", _AXES, "the axis that turns the tilted torch: its angle is where its jet goes down to")
    most_turn: float = setting(360.0, Number(180, 36_000), "how many degrees the head turns from its zero, either way")
    kerfs: tuple[tuple[float, float], ...] = setting(
        (), KerfByAngle(), "the kerf square to the jet by its angle; material.kerf at 0, straight between"
    )
    apart_mm: float = setting(
        45.0,
        likely(positive(LENGTH), 10.0, 500.0),
        "how far the tilted torches of a block stand from its upright one, along the contour",
    )
    left: Face = setting(
        "top",
        Choice(("top", "bottom")),
        "which face the torch opens to that stands on the left, as one looks from the part to the waste: it leads "
        "where a contour is cut counter-clockwise",
    )
    corner: Corner = setting(
        "either",
        Choice(("either", "loop", "turn")),
        "sharp outside corners: a loop past them, a turn about them, or a turn where no loop has room",
    )
    run_mm: float = setting(
        5.0, likely(positive(LENGTH), 0.5, 500.0), "how far past a corner a loop goes, at the least"
    )
    lies_still: float | None = setting(
        None,
        OrWord(likely(MASS, 0.0, 50_000.0), "unknown"),
        "from which mass on a part that has come loose stays where it is while it is cut again",
    )
