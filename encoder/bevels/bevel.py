"""What a bevelled edge is: its kind, angle, land and side, how it is written, and the passes that make it.

The drawing has a bevelled part at its largest: no section of the part, at any depth, is larger than what is drawn. `V`
slopes over the whole thickness, `Y` as far as a square land, `X` from both faces, `K` from both faces to a land between
them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal, get_args

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Segment

BevelKind = Literal["V", "X", "Y", "K"]
Face = Literal["top", "bottom"]
BEVEL_KINDS: tuple[BevelKind, ...] = get_args(BevelKind)
FACES: tuple[Face, ...] = get_args(Face)
LEAST_DEG, MOST_DEG = 1.0, 60.0
"""Angles from the vertical that heads are built for."""

_WRITTEN = "such as 'V 45 top', 'Y 30 land 4 bottom', 'X 45' or 'K 30 land 6'"


@dataclass(frozen=True, slots=True)
class BevelPass:
    """One way round with the torch at one angle.

    The torch leans by `tilt_deg` from the vertical: where that is positive its jet goes away from the part as it goes
    down. At `root_mm` below the sheet's top face its cut lies on the contour as drawn.
    """

    tilt_deg: float
    root_mm: float

    @property
    def slope(self) -> float:
        """How far the jet goes away from the part for each mm that it goes down."""
        return math.tan(math.radians(self.tilt_deg))


@dataclass(frozen=True, slots=True)
class Bevel:
    """A bevel of edges: the angle is from the vertical, the land the square rest of the edge, mm.

    `side` is the face that V and Y open to; X and K open to both, and have none. Raises InputError for an angle, a land
    or a side that does not go with the kind.

    Examples
    --------
    >>> str(Bevel("Y", 30, 4, "bottom")), str(Bevel("X", 45))
    ('Y 30 land 4 bottom', 'X 45')
    """

    kind: BevelKind
    angle_deg: float
    land_mm: float = 0.0
    side: Face | None = None

    def __post_init__(self) -> None:
        if not LEAST_DEG <= self.angle_deg <= MOST_DEG:
            raise InputError(
                f"a bevel's angle is {self.angle_deg:g}: expected {LEAST_DEG:g} to {MOST_DEG:g} degrees from the "
                "vertical"
            )
        has_land = self.kind in ("Y", "K")
        if has_land and self.land_mm <= 0:
            raise InputError(f"a bevel {self.kind} has a land: expected more than 0 mm, or the kind V or X")
        if not has_land and self.land_mm:
            other = "Y" if self.kind == "V" else "K"
            raise InputError(f"a bevel {self.kind} has no land: leave it out, or the kind is {other}")
        if self.kind in ("V", "Y") and self.side is None:
            object.__setattr__(self, "side", "top")
        if self.kind in ("X", "K") and self.side is not None:
            raise InputError(f"a bevel {self.kind} opens to both faces: leave out side: {self.side}")

    def __str__(self) -> str:
        land = f" land {self.land_mm:g}" if self.land_mm else ""
        return f"{self.kind} {self.angle_deg:g}{land}{f' {self.side}' if self.side else ''}"

    @staticmethod
    def parse(text: str) -> Bevel:
        """A bevel as it is written in one line.

        Raises InputError with what was expected.

        Examples
        --------
        >>> str(Bevel.parse("V 45")), str(Bevel.parse("k 30 land 6"))
        ('V 45 top', 'K 30 land 6')
        """
        words = text.split()
        kind = next((k for k in BEVEL_KINDS if words and words[0].upper() == k), None)
        if kind is None:
            raise InputError(f"'{text}' is no bevel: expected a kind, an angle, and what goes with it, {_WRITTEN}")
        numbers = {"angle": words[1] if len(words) > 1 else ""}
        rest = words[2:]
        if rest and rest[0].lower() == "land":
            numbers["land"] = rest[1] if len(rest) > 1 else ""
            rest = rest[2:]
        side = next((face for face in FACES if len(rest) == 1 and rest[0].lower() == face), None)
        if rest and side is None:
            raise InputError(f"'{text}' is no bevel: '{' '.join(rest)}' is not understood, expected {_WRITTEN}")
        values = {}
        for name, word in numbers.items():
            try:
                values[name] = float(word)
            except ValueError:
                raise InputError(f"'{text}' is no bevel: its {name} is no number, expected {_WRITTEN}") from None
        return Bevel(kind, values["angle"], values.get("land", 0.0), side)

    @staticmethod
    def of_json(entry: Mapping[str, Any], scale: float = 1.0) -> Bevel:
        """A bevel as a nest file has it, whose lengths are so many mm; the schema has seen the keys."""
        return Bevel(entry["kind"], entry["angle"], entry.get("land", 0.0) * scale, entry.get("side"))

    def as_json(self) -> dict[str, Any]:
        """The same as a nest file has it."""
        land = {"land": self.land_mm} if self.land_mm else {}
        return {"kind": self.kind, "angle": self.angle_deg, **land, **({"side": self.side} if self.side else {})}

    @property
    def turned_over(self) -> Bevel:
        """The same on a part that lies with its other face up, as mirrored ones do."""
        if self.side is None:
            return self
        return replace(self, side="bottom" if self.side == "top" else "top")

    def expect_fit(self, thickness_mm: float) -> None:
        """Refuse a land that the sheet has no room for. Raises InputError with both lengths."""
        if self.land_mm >= thickness_mm:
            raise InputError(
                f"its land, {self.land_mm:g} mm, is no less than the sheet's thickness, {thickness_mm:g} mm"
            )

    def passes(self, thickness_mm: float) -> tuple[BevelPass, ...]:
        """The ways round that make it, in order; a square one comes last.

        Examples
        --------
        >>> [(one.tilt_deg, one.root_mm) for one in Bevel("K", 30, 6).passes(20)]
        [(30, 7.0), (-30, 13.0), (0.0, 0.0)]
        """
        a, t, land = self.angle_deg, thickness_mm, self.land_mm
        square = BevelPass(0.0, 0.0)
        match self.kind:
            case "V":
                return (BevelPass(a, t) if self.side == "top" else BevelPass(-a, 0.0),)
            case "Y":
                return BevelPass(a, t - land) if self.side == "top" else BevelPass(-a, land), square
            case "X":
                return BevelPass(a, t / 2), BevelPass(-a, t / 2)
            case "K":
                return BevelPass(a, (t - land) / 2), BevelPass(-a, (t + land) / 2), square

    def inset_mm(self, depth_mm: float, thickness_mm: float) -> float:
        """By how much the part's section at a depth is smaller than what is drawn, mm.

        Examples
        --------
        >>> [round(Bevel("V", 45).inset_mm(z, 20), 9) for z in (0, 10, 20)]
        [20.0, 10.0, 0.0]
        """
        return max(0.0, *(one.slope * (one.root_mm - depth_mm) for one in self.passes(thickness_mm) if one.tilt_deg))


@dataclass(frozen=True, eq=False, slots=True)
class EdgeBevel:
    """A bevel of one edge alone: a line or an arc of a contour, told by where it lies, either way along it."""

    bevel: Bevel
    edge: Curve

    _OFF_MM: ClassVar[float] = 0.05

    def is_on(self, segment: Segment) -> bool:
        """Whether a line or an arc of the contour is the edge, or a piece of it."""
        return all(self.edge.project(segment.point_at(share))[1] < self._OFF_MM for share in (0.02, 0.5, 0.98))
