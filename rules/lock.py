"""Locks: an operator's own decisions about single contours and parts. Always hard."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any, Literal

import yaml

from kerfwise.encoder.cut import Direction
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nearest_name import unknown
from kerfwise.encoder.nest import Nest
from kerfwise.rules.options.kind import Choice, Flag, Number, OptionKind, Text
from kerfwise.rules.options.option import setting
from kerfwise.rules.options.quantities import PointOrOff, PointXY
from kerfwise.rules.options.yaml_positions import Place, wrong_at


@dataclass(frozen=True, slots=True)
class Position(OptionKind):
    """first, last, or a position counted from 1."""

    def read(self, node: yaml.Node) -> int | str:
        text = node.value if isinstance(node, yaml.ScalarNode) else ""
        if text in ("first", "last"):
            return str(text)
        if not re.fullmatch(r"[1-9]\d{0,8}", text):
            raise self.refuse(node)
        return int(text)

    def write(self, value: int | str) -> str:
        return str(value)

    def schema(self) -> dict[str, Any]:
        return {"anyOf": [{"enum": ["first", "last"]}, {"type": "integer", "minimum": 1}]}

    def expected(self) -> str:
        return "first, last or a position counted from 1"


@dataclass(frozen=True, slots=True)
class Lock:
    """One entry of a profile's `locks`: what it is about (a contour, or a part), and what is decided of it.

    `place` is where the profile says so, `reason` why it is locked, for one that stands in no profile.
    """

    contour: str | None = setting(None, Text(), "id of the contour that is locked")
    part: str | None = setting(None, Text(), "id of the part that is locked (to a zone)")
    before: str | None = setting(None, Text(), "id of a contour that is cut later")
    position: int | Literal["first", "last"] | None = setting(
        None, Position(), "place in the order of all contours, marks included: first, last or a number from 1"
    )
    entry: Point | None = setting(None, PointXY(), "where the torch joins the contour")
    direction: Direction | None = setting(None, Choice(("cw", "ccw")), "which way round it is cut")
    linked: bool | None = setting(
        None, Flag(), "false: the torch goes off before it, whatever links the profile allows"
    )
    tab: Point | Literal["off"] | None = setting(None, PointOrOff(), "where a tab holds the part, or off: it has none")
    zone: int | None = setting(None, Number(1, whole=True), "zone of the part")
    place: Place | None = field(default=None, compare=False)
    reason: str = field(default="", compare=False)

    def wrong(self) -> str | None:
        """What is wrong with the lock by itself, None for a good one."""
        decided = (self.before, self.position, self.entry, self.direction, self.linked, self.tab)
        of_contour = [one is not None for one in decided]
        if (self.contour is None) == (self.part is None):
            return "a lock is about one contour or one part: give either contour or part, with an id"
        if self.part is not None and (self.zone is None or any(of_contour)):
            return "what can be locked of a part is its zone: {part: ID, zone: N}"
        if self.contour is not None and (self.zone is not None or not any(of_contour)):
            return "what can be locked of a contour is before, position, entry, direction, linked or tab"
        if self.linked:
            return "a link can be ruled out, not asked for: {contour: ID, linked: false}"
        if self.contour is not None and self.contour == self.before:
            return f"{self.contour} cannot be cut before itself"
        return None

    def place_among(self, n: int) -> int | Literal["first", "last"] | None:
        """The position among n contours: 1 is first and n is last, however it is given.

        Examples
        --------
        >>> Lock(contour="A", position=1).place_among(3), Lock(contour="A", position=3).place_among(3)
        ('first', 'last')
        """
        return "first" if self.position == 1 else "last" if self.position == n else self.position

    @property
    def because(self) -> str:
        """The reason that sentences give."""
        return self.reason or "locked by the operator" + (f" ({self.place})" if self.place else "")


def check_locks(locks: tuple[Lock, ...], nest: Nest) -> None:
    """Make sure that the nest has what the locks name.

    Raises InputError if a lock names a contour, a part or a position that the nest does not have.
    """
    for lock in locks:
        for name in (lock.contour, lock.before):
            if name in nest.left_out:
                raise wrong_at(lock.place, f"lock: {name} is left out as a small hole (small_holes.under: skip)")
            if name is not None and name not in nest.index:
                raise wrong_at(lock.place, f"lock: {unknown('contour', name, nest.index)}")
        if lock.part is not None and lock.part not in nest.part_of:
            raise wrong_at(lock.place, f"lock: {unknown('part', lock.part, nest.part_of)}")
        n = len(nest.contours)
        if isinstance(lock.position, int) and lock.position > n:
            raise wrong_at(lock.place, f"lock: position {lock.position}, but the nest has {n} contours only")
        if lock.tab is not None and nest.contour(lock.contour or "").kind != "outer":
            raise wrong_at(lock.place, f"lock: tab of {lock.contour}: tabs hold parts; give the outer contour of one")
