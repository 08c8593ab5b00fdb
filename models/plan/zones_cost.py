"""What zones cost: how much better a plan is that need not be cut zone after zone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from kerfwise.rules.statements import EXEMPTION_MM


@dataclass(frozen=True, slots=True)
class ZonesCost:
    """How much better a plan is that need not be cut zone after zone, the best that was found in a short while.

    Parameters
    ----------
    mm
        What zones add to the objective, mm of idle travel, the weight of excuses left out; below 0 where the plan
        without zones has fewer excuses, but longer ways.
    excuses
        How many excuses fewer it has.
    avoided
        Ids of the contours that the plan excuses, each with its rule, where the plan without zones does not.
    seconds
        How long it was looked for, s; of work, as `SolveReport.seconds`.
    aside
        Rules that neither of the two is priced by, as the nest is too large for them without zones.
    proven_elsewhere_mm
        Objective of a plan that is proven within other zones and costs more, where this one is not proven; else None.
    """

    mm: float
    excuses: int
    avoided: tuple[tuple[str, str], ...]
    seconds: float
    aside: tuple[str, ...] = ()
    proven_elsewhere_mm: float | None = None

    @property
    def sentence(self) -> str:
        """What zones cost, for people.

        Examples
        --------
        >>> ZonesCost(912.4, 0, (), 3.0).sentence
        'zones cost 0.912 m against the best plan known without them, looked for in 3.0 s'
        >>> ZonesCost(0.0, 0, (), 0.5).sentence
        'no better plan without zones is known, looked for in 0.5 s'
        >>> ZonesCost(-300.0, 1, (("A.outer", "no-islands"),), 3.0).sentence
        'zones cost 1 excuse that a plan without them avoids, 0.300 m longer, looked for in 3.0 s: A.outer (no-islands)'
        >>> ZonesCost(0.0, 0, (), 0.5, (), 18_634.0).sentence
        'no better plan without zones is known, looked for in 0.5 s; not proven, but within other zones 18.634 m is'
        """
        return self._against_none + self._elsewhere

    @property
    def _against_none(self) -> str:
        looked_for = f"looked for in {self.seconds:.1f} s{''.join(f', {rule} aside' for rule in self.aside)}"
        if self.excuses > 0:
            way = f"{abs(self.mm) / 1000:.3f} m {'shorter' if self.mm >= 0 else 'longer'}"
            excuses = _excuses(self.excuses)
            names = ", ".join(f"{contour} ({rule})" for contour, rule in self.avoided)
            listed = f": {names}" if names else ""
            return f"zones cost {excuses} that a plan without them avoids, {way}, {looked_for}{listed}"
        if self.mm <= 0:
            return f"no better plan without zones is known, {looked_for}"
        return f"zones cost {self.mm / 1000:.3f} m against the best plan known without them, {looked_for}"

    @property
    def _elsewhere(self) -> str:
        if self.proven_elsewhere_mm is None:
            return ""
        excuses, rest_mm = divmod(self.proven_elsewhere_mm, EXEMPTION_MM)
        also = f" with {_excuses(round(excuses))}" if excuses else ""
        return f"; not proven, but within other zones {rest_mm / 1000:.3f} m{also} is"

    def as_json(self) -> dict[str, Any]:
        """As a plan lists it."""
        avoided = [{"contour": contour, "rule": rule} for contour, rule in self.avoided]
        amounts = {"mm": round(self.mm, 6), "excuses": self.excuses, "avoided": avoided}
        elsewhere = self.proven_elsewhere_mm
        proven = {} if elsewhere is None else {"proven_elsewhere_mm": round(elsewhere, 6)}
        return amounts | {"seconds": round(self.seconds, 6), "aside": list(self.aside)} | proven

    @staticmethod
    def of_json(data: dict[str, Any]) -> ZonesCost:
        """The same, read back."""
        avoided = tuple((row["contour"], row["rule"]) for row in data["avoided"])
        aside, elsewhere = tuple(data["aside"]), data.get("proven_elsewhere_mm")
        return ZonesCost(data["mm"], data["excuses"], avoided, data["seconds"], aside, elsewhere)


def _excuses(count: int) -> str:
    return f"{count} excuse{'s' if count > 1 else ''}"
