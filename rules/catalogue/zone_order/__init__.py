"""Rule zone-order."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product
from typing import TYPE_CHECKING

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Contour, Ids, Nest
from kerfwise.rules.judging.metal import host_holes
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.kind import Number
from kerfwise.rules.options.option import setting
from kerfwise.rules.options.quantities import ENERGY, OrWord, likely, positive
from kerfwise.rules.rule import Forced, Rule, Strength, Violation
from kerfwise.rules.statements import About, Precede

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import FactOptions, Facts


@dataclass(frozen=True, slots=True)
class ZoneOrderOptions:
    """How the sheet is divided into zones; the last two are `heat.absorbed_power_w` and the profile's locks."""

    zone_contours: int | None = setting(
        None,
        OrWord(Number(1, whole=True), "auto"),
        "contours in a zone, about, marks aside (auto: as many as a proof bears)",
    )
    square_ratio: float = setting(
        1.25, Number(1), "long side by short side of what is left, over which zones come off the start side only"
    )
    zone_heat_kj: float | None = setting(
        None, OrWord(likely(positive(ENERGY), 1e-3, 1e7), "off"), "how much heat may go into one zone"
    )
    absorbed_power_w: float = 1300.0
    locks: tuple[Lock, ...] = ()


class ZoneOrder(Rule[ZoneOrderOptions]):
    """The sheet is cut zone after zone.

    ## What it does

    Parts are grouped into zones 1…m of about `zone_contours` contours, strip after strip off the start side while
    what is left is longer than wide by more than `square_ratio`, then off whichever side leaves it most square. Every
    hole and outer contour of a zone is cut before any of the next. A host and what it contains share a zone; no zone
    goes against the order rules. Marks do not count towards `zone_contours` and have no zone order: they neither free
    metal nor heat it. Scrap lines are a zone of their own, the last, and no budget of heat is asked of it.

    Small zones make long ways, and so do thin strips of a large sheet. With `zone_contours: auto` strips are wide, and
    divided along their length into pieces of about 8 contours. These are cut one after the other, from the end where
    the strip before ended. Pieces that follow each other are then joined to zones that are as large as a proof of the
    best plan bears: as long as there are few sets of contours that may be out while a zone is cut. Where locks put
    parts in zones, these are strips of about 12 contours.

    Borders that geometry draws can cost travel, so a plan without zones is looked for, and runs of it take the place of
    the zones where the plan is then cheaper. They are zones still: no more than there were, or than a proof bears, what
    is left stays about as square (up to `square_ratio` it is square), they reach into each other about as little, and
    the first is at the start side. Of all borders along that plan those are drawn that do this best. Where all such
    zones let the plan cost more than without them, runs of any shape are zones, or the whole sheet is one. The cheapest
    plan is taken, proven or not; where it is not, the plan says what is proven within other zones. Zones stay as they
    are where the plant gives a number, locks or a budget of heat.

    With `zone_heat`, a strip ends before the heat of its contours passes that budget: `heat.absorbed_power_w` for as
    long as the torch is on, piercing included, at the feeds that the section `time` names. What the order rules then
    raise into a zone that has no room for it makes two zones of it. A part that passes the budget alone, with what it
    contains, has a zone of its own, and where locks put parts in zones these may pass it: both are exceptions that the
    plan lists. `kerfwise facts` gives the heat of every zone.

    ## Links, tabs and other cuts

    - **Links**: A link may lead from the last part of a zone to the first of the next.
    - **Tabs**: They change nothing.
    - **Common cuts**: Parts of two zones may have an edge in common: the later one begins in the kerf of the
      earlier one.
    - **Scrap lines**: They are a zone of their own, the last, and no budget of heat is asked of it.
    - **Several torches**: Zones are those of the first; a copy is in the zone of what it is cut with.

    ## Why

    Petunin 2009 (fig. 4): what is left of the sheet stays as close to a square as it can, and so stiff, and heat
    moves across the sheet instead of gathering. How much of it one zone may take is for the plant to say.

    ## Wrong

    `A.outer` (zone 1), `C.outer` (zone 2), `B.outer` (zone 1).

    ## Right

    `A.outer` (zone 1), `B.outer` (zone 1), `C.outer` (zone 2).
    """

    id = "zone-order"
    sentence = "The sheet is cut zone after zone."
    source = "Petunin 2009, fig. 4"
    Options = ZoneOrderOptions
    minds_ways = True
    makes_zones = True

    def statements(self, facts: Facts, options: ZoneOrderOptions) -> Iterator[Precede]:
        contours = facts.nest.contours
        members: dict[int, list[int]] = defaultdict(list)
        for k, zone in enumerate(facts.zone.tolist()):
            if contours[k].kind != "mark":
                members[zone].append(k)
        for zone, following in pairwise(sorted(members)):
            yield from _in_turn(self.id, contours, (zone, members[zone]), (following, members[following]))

    def fact_options(self, given: FactOptions, options: ZoneOrderOptions, strength: Strength) -> FactOptions:
        return replace(
            given,
            zone_contours=options.zone_contours,
            square_ratio=options.square_ratio,
            zone_heat_kj=options.zone_heat_kj,
            zone_places=given.zone_places if strength == "hard" else (),
        )

    def pairs(self, nest: Nest, cuts: CutSequence, options: ZoneOrderOptions) -> list[Ids]:
        members: dict[int, list[str]] = defaultdict(list)
        for cut in cuts.new:
            if cut.zone and nest.contour(cut.contour).kind != "mark":
                members[cut.zone].append(cut.contour)
        zones = pairwise(sorted(members))
        return [(a, b) for zone, following in zones for a in members[zone] for b in members[following]]

    def exempt(self, facts: Facts, options: ZoneOrderOptions) -> Iterator[About]:
        budget_kj = options.zone_heat_kj
        if budget_kj is None:
            return
        outers = [facts.nest.index[part.outer.id] for part in facts.nest.parts]
        of_scrap = {int(facts.zone[facts.nest.index[line.id]]) for line in facts.nest.scrap}
        for zone, kj in enumerate(facts.zone_heat_kj.tolist(), 1):
            if kj > budget_kj * (1 + ALLOWANCE) and zone not in of_scrap:
                names = [facts.nest.contours[k].id for k in outers if facts.parent[k] < 0 and facts.zone[k] == zone]
                yield self.about(names, f"zone {zone} takes up {_too_much(kj, budget_kj)}: {', '.join(names)}")

    def unjudged(self, nest: Nest, cuts: CutSequence, options: ZoneOrderOptions) -> str | None:
        if cuts.new and not any(cut.zone for cut in cuts.new):
            return "the zones of the cuts are not stated"
        timed = options.zone_heat_kj is None or any(cut.end_s for cut in cuts.new) or not cuts.new
        return None if timed else "the times of the cuts are not stated, and so the heat of their zones is not known"

    def violations(self, nest: Nest, cuts: CutSequence, options: ZoneOrderOptions) -> list[Violation]:
        if not any(cut.zone for cut in cuts.new):
            return []
        new = enumerate(cuts.new, cuts.made + 1)
        through = [(k, cut) for k, cut in new if nest.contour(cut.contour).kind != "mark"]
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
        found += self._split(nest, {cut.contour: (k, cut.zone) for k, cut in through})
        return found + [violation for violation, _ in self._hot(nest, cuts, options)]

    def excuse(
        self, nest: Nest, cuts: CutSequence, options: ZoneOrderOptions, violation: Violation, forced: Forced
    ) -> str | None:
        for known, zone in self._hot(nest, cuts, options):
            if known == violation and len(zone.outers) == 1:
                return f"{zone.outers[0]} is cut in one zone with all that lies in it"
            locked = [lock.part for lock in options.locks if lock.part is not None]
            if known == violation and locked:
                return f"locks decide on zones: of {', '.join(locked)}"
        return None

    def _hot(self, nest: Nest, cuts: CutSequence, options: ZoneOrderOptions) -> Iterator[tuple[Violation, HotZone]]:
        """The zones that pass the budget, as violations."""
        if options.zone_heat_kj is not None:
            for zone in hot_zones(nest, cuts, options.absorbed_power_w, options.zone_heat_kj):
                text = f"zone {zone.zone} takes up {_too_much(zone.heat_kj, options.zone_heat_kj)}"
                yield Violation(self.id, zone.outers, text, zone.cuts), zone

    def _split(self, nest: Nest, stated: dict[str, tuple[int, int]]) -> list[Violation]:
        """Contours whose zone is not that of the contour around them."""
        around = [(hole.id, part.outer.id) for part in nest.parts for hole in (*part.slits, *part.holes)]
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


def _too_much(heat_kj: float, budget_kj: float) -> str:
    return f"{heat_kj:.1f} kJ, not {budget_kj:g} kJ at the most"


def _in_turn(
    rule: str, contours: Sequence[Contour], sooner: tuple[int, list[int]], later: tuple[int, list[int]]
) -> list[Precede]:
    """Each contour of a zone before each of the next; given are the numbers of both zones and of their contours."""
    (zone, first), (following, then) = sooner, later
    statements = []
    for i, j in product(first, then):
        names = (contours[i].id, contours[j].id)
        sentence = f"{names[0]} is cut before {names[1]}: zone {zone} comes before zone {following}"
        statements.append(Precede(i, j, About(rule, names, sentence)))
    return statements


# How much heat goes into each zone of a sequence of cuts, as the judging of zone-order sees it: by their own times.

ALLOWANCE = 1e-3
"""Share of a budget that may be passed: plans state times to a millisecond, programs feeds to a few digits."""
J_PER_KJ = 1000.0


@dataclass(frozen=True, slots=True)
class HotZone:
    """A zone that takes up more than its budget: its cuts (positions from 1), and the parts that may be told apart.

    Those are the outer contours straight on the sheet: what is nested in a part shares its zone.
    """

    zone: int
    heat_kj: float
    cuts: tuple[int, ...]
    outers: tuple[str, ...]


def hot_zones(nest: Nest, cuts: CutSequence, absorbed_power_w: float, budget_kj: float) -> Iterator[HotZone]:
    """The zones whose cuts, while the torch is on, leave more heat in the sheet than the budget.

    Marks leave none, and scrap lines, which are cut when all parts are out, are not asked about.
    """
    members: dict[int, list[int]] = defaultdict(list)
    for k, cut in enumerate(cuts.new, cuts.made + 1):
        if cut.zone and nest.contour(cut.contour).shapes_part:
            members[cut.zone].append(k)
    for zone, positions in sorted(members.items()):
        on_s = sum(cuts[k - 1].end_s - cuts[k - 1].start_s for k in positions)
        heat_kj = absorbed_power_w * on_s / J_PER_KJ
        if heat_kj > budget_kj * (1 + ALLOWANCE):
            outers = dict.fromkeys(_outermost(nest, cuts[k - 1].contour) for k in positions)
            yield HotZone(zone, heat_kj, tuple(positions), tuple(outers))


def _outermost(nest: Nest, contour: str) -> str:
    """The outer contour straight on the sheet that a contour lies in."""
    hosts, part = host_holes(nest), nest.contour(contour).part
    while part in hosts:
        part = hosts[part].part
    return nest.part_of[part].outer.id
