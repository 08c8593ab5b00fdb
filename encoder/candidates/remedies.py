"""Which one option, at which value, frees contours that cannot be cut as the options ask.

Every remedy is tried, alone, before it is named.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from kerfwise.encoder.narrow import Narrow
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.small_holes import EXACT_MM, HoleLimits, Under, diameter_under, kept_because

from .candidate import LEAST_WASTE_MM, LeadOptions
from .lead_in import least_clearance_mm
from .no_room import Reason
from .profile_keys import IN_PROFILE
from .surroundings import Surroundings
from .tried import TriedLeads, try_options

Key = Literal["pierce_clearance_mm", "under", "least_mm", "lead_in_min_mm", "narrow", "corner_mm"]

ORDER: tuple[Key, ...] = ("pierce_clearance_mm", "under", "least_mm", "lead_in_min_mm", "narrow", "corner_mm")
"""The order in which remedies are named."""

_SHARES = (0.5, 0.25, 0.1)
"""How much smaller an option is tried."""

_VALUES = 12
"""Values of one option that are tried at the most; contours that would do with a little more share the least."""


@dataclass(frozen=True, slots=True)
class Remedy:
    """One option at one value."""

    key: Key
    value: float | Under | Narrow

    @property
    def text(self) -> str:
        """As a profile has it.

        Examples
        --------
        >>> Remedy("pierce_clearance_mm", 1.48).text, Remedy("under", "spot").text
        ('`rules.pierce.clearance: 1.48 mm`', '`small_holes.under: spot`')
        """
        if self.key == "narrow":
            return f"`{IN_PROFILE[self.key]}: {self.value}` (the torch cuts straight across)"
        return f"`{IN_PROFILE[self.key]}: {self.value if isinstance(self.value, str) else f'{self.value:g} mm'}`"

    def applied(self, options: LeadOptions) -> LeadOptions:
        """The options with this one changed."""
        change: dict[str, Any] = {self.key: self.value}
        if self.key in ("under", "least_mm"):
            return replace(options, holes=replace(options.holes, **change))
        changed = replace(options, **change)
        return replace(changed, holes=_with_room(changed))


def _with_room(options: LeadOptions) -> HoleLimits:
    """The limits of holes where pierces keep another clearance."""
    if not options.holes.room_mm:
        return options.holes
    of_own = options if options.lead != "none" else replace(options, pierce_clearance_mm=0.0)
    return replace(options.holes, room_mm=2 * least_clearance_mm(of_own))


class Remedies:
    """What frees the contours at fault in one nest; `reasons` are theirs, by number."""

    def __init__(
        self, nest: Nest, tried: TriedLeads, reasons: Mapping[int, Reason], around: Surroundings, options: LeadOptions
    ) -> None:
        self._nest, self._tried, self._reasons = nest, tried, reasons
        self._around, self._options = around, options

    def of_each(self) -> dict[int, tuple[Remedy, ...]]:
        """For every contour at fault the remedies that free it alone; none where nothing known does."""
        found: dict[int, list[Remedy]] = {k: [] for k in self._reasons}
        for remedy, contours in self._proposed():
            for k in self.freed(remedy, contours):
                found[k].append(remedy)
        of_kerf = {*self._tried.narrow, *self._tried.uncut, *self._tried.beyond}  # whatever the leads are
        for name in self._smaller_options():
            for remedy, k in self._smaller(name, [k for k in self._reasons if k not in of_kerf]):
                found[k].append(remedy)
        return {k: tuple(sorted(of, key=lambda remedy: ORDER.index(remedy.key))) for k, of in found.items()}

    def freed(self, remedy: Remedy, contours: Iterable[int]) -> list[int]:
        """Those of some contours that a remedy frees."""
        chosen, changed = list(contours), remedy.applied(self._options)
        if remedy.key == "under":
            return [k for k in chosen if self._is_treated(k, changed.holes)]
        if not chosen or not _leads_reach(changed):
            return []
        faulty = try_options(self._nest, chosen, self._around, changed).faulty
        return [k for k in chosen if k not in faulty]

    def frees_nest(self, remedy: Remedy) -> bool:
        """Whether a remedy leaves no contour of the nest at fault."""
        every = remedy.key == "lead_in_min_mm"  # with other lengths every lead is another: all contours are looked at
        contours = sorted({*self._tried.outlines, *self._reasons}) if every else list(self._reasons)
        return len(self.freed(remedy, contours)) == len(contours)

    def _is_treated(self, k: int, limits: HoleLimits) -> bool:
        hole = self._nest.contours[k]
        if hole.kind != "hole" or diameter_under(hole, limits.limit_mm) is None:
            return False
        return kept_because(self._nest, hole, limits) is None

    def _proposed(self) -> Iterator[tuple[Remedy, list[int]]]:
        """Remedies to try whose values the contours themselves tell, and for which contours."""
        contours, holes = self._nest.contours, self._options.holes
        left = [k for k in self._reasons if contours[k].kind == "hole"]
        for under in ("spot", "skip") if holes.under == "refuse" else ("skip",):
            remedy = Remedy("under", under)
            yield remedy, left
            done = set(self.freed(remedy, left))
            left = [k for k in left if k not in done]
        within_mm = self._options.kerf_mm / 2 + LEAST_WASTE_MM
        gaps_mm = {k: r.gap_mm for k, r in self._reasons.items() if r.gap_mm is not None and r.gap_mm > within_mm}
        yield from _at_values("pierce_clearance_mm", gaps_mm)
        across_mm = {k: diameter_under(contours[k], holes.limit_mm) for k in self._tried.small}
        rounded_mm = {k: math.floor((mm + EXACT_MM / 2) * 100) / 100 for k, mm in across_mm.items() if mm is not None}
        yield from _at_values("least_mm", rounded_mm)
        yield Remedy("narrow", "leave"), sorted(self._tried.narrow)
        corners_mm = {
            k: math.ceil(max(one.left_mm for one in of.lost if one.corner_deg is not None) * 100) / 100
            for k, of in self._tried.narrow.items()
            if of.lost and all(one.corner_deg is not None for one in of.lost)
        }
        yield from ((Remedy("corner_mm", value), [k]) for k, value in corners_mm.items())

    def _smaller_options(self) -> tuple[Key, ...]:
        """Options of which smaller values are tried, because no contour tells one."""
        return ("lead_in_min_mm",) if self._options.lead != "none" else ("pierce_clearance_mm",)

    def _smaller(self, name: Key, left: list[int]) -> Iterator[tuple[Remedy, int]]:
        """The largest of some smaller values that frees each contour."""
        for share in _SHARES:
            remedy = Remedy(name, round(getattr(self._options, name) * share, 3))
            freed = self.freed(remedy, left)
            yield from ((remedy, k) for k in freed)
            left = [k for k in left if k not in freed]


def _leads_reach(options: LeadOptions) -> bool:
    """Whether the longest lead brings a pierce as far from its contour as its clearance."""
    return options.lead == "none" or options.lead_in_mm >= least_clearance_mm(options) - options.kerf_mm / 2


def _at_values(key: Key, values: Mapping[int, float]) -> Iterator[tuple[Remedy, list[int]]]:
    """An option at the value that each contour asks for; where there are many values, at some of the smaller ones."""
    known = np.unique(list(values.values()))
    tried = known[np.unique(np.arange(min(_VALUES, len(known))) * len(known) // max(min(_VALUES, len(known)), 1))]
    for i, value in enumerate(tried.tolist()):
        above = tried[i + 1] if i + 1 < len(tried) else math.inf
        yield Remedy(key, value), [k for k, asked in values.items() if value <= asked < above]
