"""Rule zone-order."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING

from ...encoder.cut import CutSequence
from ...encoder.nest import Nest
from ..kinds import Number
from ..option import option
from ..placement import host_holes
from ..rule import Ids, Rule, Violation
from ..statements import Precede

if TYPE_CHECKING:
    from ...encoder.facts.facts import Facts


@dataclass(frozen=True, slots=True)
class ZoneOrderOptions:
    """How the sheet is divided into zones."""

    zone_contours: int = field(default=12, metadata=option(Number(1, whole=True), "contours in a zone, about"))
    square_ratio: float = field(
        default=1.25,
        metadata=option(
            Number(1), "long side by short side of what is left, over which zones come off the start side only"
        ),
    )


class ZoneOrder(Rule[ZoneOrderOptions]):
    """The sheet is cut zone after zone.

    ## What it does

    Parts are grouped into zones 1…m of about `zone_contours` contours, strip after strip off the start side while
    what is left is longer than wide by more than `square_ratio`, then off whichever side leaves it most square. Every
    hole and outer contour of a zone is cut before any of the next. A host and what it contains share a zone; no zone
    goes against the order rules. Marks have no zone order: they neither free metal nor heat it.

    ## Why

    Petunin 2009 (fig. 4): what is left of the sheet stays as close to a square as it can, and so stiff, and heat
    moves across the sheet instead of gathering.

    ## Wrong

    `A.outer` (zone 1), `C.outer` (zone 2), `B.outer` (zone 1).

    ## Right

    `A.outer` (zone 1), `B.outer` (zone 1), `C.outer` (zone 2).
    """

    id = "zone-order"
    sentence = "The sheet is cut zone after zone."
    source = "Petunin 2009, fig. 4"
    Options = ZoneOrderOptions

    def statements(self, facts: Facts, options: ZoneOrderOptions) -> Iterator[Precede]:
        contours = facts.nest.contours
        members: dict[int, list[int]] = defaultdict(list)
        for k, zone in enumerate(facts.zone.tolist()):
            if contours[k].kind != "mark":
                members[zone].append(k)
        for zone, following in pairwise(sorted(members)):
            for before in members[zone]:
                for after in members[following]:
                    first, then = contours[before].id, contours[after].id
                    sentence = f"{first} is cut before {then}: zone {zone} comes before zone {following}"
                    yield Precede(before, after, self.about((first, then), sentence))

    def pairs(self, nest: Nest, cuts: CutSequence, options: ZoneOrderOptions) -> list[Ids]:
        members: dict[int, list[str]] = defaultdict(list)
        for cut in cuts:
            if cut.zone and nest.contour(cut.contour).kind != "mark":
                members[cut.zone].append(cut.contour)
        zones = pairwise(sorted(members))
        return [(a, b) for zone, following in zones for a in members[zone] for b in members[following]]

    def unjudged(self, nest: Nest, cuts: CutSequence, options: ZoneOrderOptions) -> str | None:
        return None if any(cut.zone for cut in cuts) or not cuts else "the zones of the cuts are not stated"

    def violations(self, nest: Nest, cuts: CutSequence, options: ZoneOrderOptions) -> list[Violation]:
        if self.unjudged(nest, cuts, options):
            return []
        through = [(k, cut) for k, cut in enumerate(cuts, 1) if nest.contour(cut.contour).kind != "mark"]
        found = []
        highest: tuple[int, str, int] = (0, "", 0)
        for k, cut in through:
            if cut.zone < 1:
                text = f"{cut.contour} (cut {k}) has no zone, while other cuts have"
                found.append(Violation(self.id, (cut.contour,), text, (k,)))
            elif cut.zone < highest[0]:
                zone, name, earlier = highest
                text = f"{cut.contour} of zone {cut.zone} (cut {k}) is cut after {name} of zone {zone} (cut {earlier})"
                found.append(Violation(self.id, (cut.contour, name), text, (earlier, k)))
            elif cut.zone > highest[0]:
                highest = (cut.zone, cut.contour, k)
        return found + self._split(nest, {cut.contour: (k, cut.zone) for k, cut in through})

    def _split(self, nest: Nest, stated: dict[str, tuple[int, int]]) -> list[Violation]:
        """Contours whose zone is not that of the contour around them."""
        around = [(hole.id, part.outer.id) for part in nest.parts for hole in part.holes]
        around += [(nest.part_of[guest].outer.id, hole.id) for guest, hole in host_holes(nest).items()]
        found = []
        for inner, outer in around:
            if inner not in stated or outer not in stated:
                continue
            (k, zone), (other, its_zone) = stated[inner], stated[outer]
            if zone != its_zone and zone and its_zone:
                text = f"{inner} is in zone {zone} (cut {k}), but {outer} around it is in zone {its_zone} (cut {other})"
                found.append(Violation(self.id, (inner, outer), text, (k, other)))
        return found
