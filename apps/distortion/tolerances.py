"""Tolerances of parts: what the nest and the profile allow, and which parts will not keep to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.nest import Nest, Part
from kerfwise.rules.options.kind import Unfit
from kerfwise.rules.options.quantities import LENGTH, positive
from kerfwise.rules.options.yaml_positions import compose
from kerfwise.rules.profile.values import ProfileValues

if TYPE_CHECKING:
    from .part_errors import PartError

_LENGTH = positive(LENGTH)
_NAMED = 4
"""So many parts are named in a sentence."""


@dataclass(frozen=True, slots=True)
class Beyond:
    """A part that will be off by more than it may, mm."""

    part: str
    max_mm: float
    tolerance_mm: float

    @property
    def told(self) -> str:
        """In a few words."""
        return f"{escape_text(self.part)} {self.max_mm:.2f} mm, {self.tolerance_mm:g} mm allowed"


def tolerances_of(nest: Nest, profile: ProfileValues) -> dict[str, float]:
    """Part → how far it may be off, mm: its key `tolerance` in the nest, else that of the profile; others are left out.

    Raises InputError if a part's key is no length.
    """
    common = profile.distortion.tolerance_mm
    found: dict[str, float] = {}
    for part in nest.parts:
        own = _own(nest, part) if "tolerance" in part.attributes else common
        if own is not None:
            found[part.id] = own
    return found


def _own(nest: Nest, part: Part) -> float:
    value = part.attributes["tolerance"]
    try:
        node = None if isinstance(value, (bool, list, dict)) else compose(str(value), "tolerance")
        if node is None:
            raise Unfit(f"expected {_LENGTH.expected()}")
        return float(_LENGTH.read(node))
    except (Unfit, InputError):
        raise InputError(
            f"{escape_text(part.id)}: tolerance {escape_text(str(value))!r}: expected {_LENGTH.expected()}",
            file=nest.file or None,
        ) from None


def beyond(parts: tuple[PartError, ...], tolerances: Mapping[str, float]) -> tuple[Beyond, ...]:
    """The parts that are off by more than they may, the worst first."""
    found = [
        Beyond(p.part, p.max_mm, tolerances[p.part])
        for p in parts
        if p.max_mm is not None and p.max_mm > tolerances.get(p.part, float("inf"))
    ]
    return tuple(sorted(found, key=lambda b: (-b.max_mm / b.tolerance_mm, b.part)))


def kept_or_not(found: tuple[Beyond, ...], count: int) -> str:
    """A sentence on `count` parts with a tolerance; "" where none has one."""
    if not count:
        return ""
    if not found:
        return f"all {count} parts with a tolerance keep it" if count > 1 else "the part with a tolerance keeps it"
    more = f" and {len(found) - _NAMED} more" if len(found) > _NAMED else ""
    named = "; ".join(b.told for b in found[:_NAMED])
    return f"{len(found)} of {count} parts with a tolerance will not keep it: {named}{more}"
