"""Every plan of a small nest, as the check sees plans: cuts and geometry, no facts, no statements, no model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations, pairwise, product

import numpy as np
import shapely

from kerfwise import Nest, Profile
from kerfwise.arrays import Floats
from kerfwise.models.physics.motion import Leg, schedule
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.postproc.check.plan_runs import runs_from_cuts
from kerfwise.rule_kit import Contour, Curve, Cut, CutSequence, Side, Violation
from kerfwise.rules.catalogue.pierce import PierceOptions
from kerfwise.tests.agreement.stretches import Stretches, along_mm
from kerfwise.tests.models.engines.cases import Case

LEAST_S = 1e-3
"""Less than this a way to cut is not said to be slower."""


@dataclass(frozen=True, eq=False)
class Trial:
    """A nest, the ways to cut each contour, and the profile to judge by."""

    nest: Nest
    ways: tuple[tuple[Cut, ...], ...]
    start_side: Side | None
    profile: Profile
    links: Mapping[tuple[int, int], Curve] = field(default_factory=dict)
    """The links that are offered, by the numbers of the two ways to cut that they join, counted as `first` does."""

    @staticmethod
    def of(case: Case) -> Trial:
        """The candidates of a case as cuts, and its links."""
        facts = case.facts
        ways: list[list[Cut]] = [[] for _ in range(facts.n)]
        for c in facts.candidates:
            name, zone = facts.nest.contours[c.contour].id, int(facts.zone[c.contour])
            ways[c.contour].append(c.as_cut(name, zone))
        links = {
            (a, b): Curve.of(list(link.path), closed=False)
            for link in facts.links
            for a, b in product(link.leave, link.reach)
        }
        return Trial(facts.nest, tuple(map(tuple, ways)), facts.start_side, case.profile, links)

    @property
    def n(self) -> int:
        """Number of contours."""
        return len(self.ways)

    @cached_property
    def price(self) -> float:
        """What a millimetre of idle travel costs."""
        objective = self.profile.objective
        return objective.idle + objective.time / self.profile.machine.travel_mm_s

    @property
    def counts_pierces(self) -> bool:
        """Whether plans are compared by all their time: links and common cuts save pierces, leads and cuts."""
        if self.profile.cuts.common.shortest_mm is not None:
            return True
        return self.profile.cuts.links.longest_mm > 0 and self.profile.no_links(self.nest) is None

    @cached_property
    def stretches(self) -> Stretches | None:
        """Where contours may be cut along a stretch: which ways suit what is out."""
        if not any(cut.span is not None for own in self.ways for cut in own):
            return None
        return Stretches(self.nest, self.ways, self.profile.material.kerf_mm)

    @cached_property
    def second(self) -> float:
        """What a second costs beside idle travel."""
        objective = self.profile.objective
        return objective.time + (objective.idle * self.profile.machine.travel_mm_s if self.counts_pierces else 0.0)

    @cached_property
    def way_prices(self) -> list[list[float]]:
        """What each way to cut a contour costs for its seconds.

        With links or common cuts these are all but those of the shortest stretch, else those over the quickest way's.
        """
        kerf_mm = self.profile.material.kerf_mm
        found = []
        for contour, own in zip(self.nest.contours, self.ways, strict=True):
            seconds = [self._start_s(contour, cut) + self._lead_s(contour, cut.lead_out) for cut in own]
            if any(cut.span is not None for cut in own):
                feed = self.profile.machine.cut_feed_mm_s
                along = [along_mm(cut, contour, kerf_mm) for cut in own]
                seconds = [s + (mm - min(along)) / feed for s, mm in zip(seconds, along, strict=True)]
            least = 0.0 if self.counts_pierces else min(seconds)
            found.append([self.second * (s - least) if s - least >= LEAST_S else 0.0 for s in seconds])
        return found

    def _start_s(self, contour: Contour, cut: Cut) -> float:
        """Seconds to the place where the torch joins the contour."""
        machine = self.profile.machine
        if contour.kind == "mark":
            pierce_s = machine.mark_time_s if self.counts_pierces else 0.0
        elif cut.span is not None and machine.kerf_start:
            pierce_s = machine.edge_preheat_s
        else:
            pierce_s = machine.pierce_time_s if self._sheet.intersects(shapely.Point(cut.pierce)) else 0.0
        return pierce_s + self._lead_s(contour, cut.lead_in)

    def _lead_s(self, contour: Contour, lead: Curve | None) -> float:
        machine = self.profile.machine
        feed = machine.mark_feed_mm_s if contour.kind == "mark" else machine.cut_feed_mm_s
        return 0.0 if lead is None else lead.length_mm / feed

    @cached_property
    def moves(self) -> Floats:
        """What each move costs, numbered as in `legs_mm`: idle travel, or a link that costs less."""
        found = self.price * self.legs_mm
        for (a, b), (cost, _) in self.taken.items():
            found[a, b] = cost
        return found

    @cached_property
    def taken(self) -> dict[tuple[int, int], tuple[float, Curve]]:
        """The links that cost less than idle travel: what each costs, less the pierce and the lead-in that it saves."""
        found = {}
        cuts = [(contour, cut) for contour, own in zip(self.nest.contours, self.ways, strict=True) for cut in own]
        for (a, b), path in self.links.items():
            contour, cut = cuts[b]
            cost = self.second * (self._lead_s(contour, path) - self._start_s(contour, cut))
            if cost < self.price * self.legs_mm[a, b]:
                found[a, b] = cost, path
        return found

    def leads_near(self, options: PierceOptions) -> bool:
        """Whether any ways of two parts have leads so near each other that one might meet the kerf of the other.

        A slit is like a part of its own there.
        """
        leads = [
            (cut.contour if "slit" in cut.contour else self.nest.contour(cut.contour).part, lead.line())
            for own in self.ways
            for cut in own
            for lead in (cut.lead_in, cut.lead_out)
            if lead is not None and lead.length_mm > 0
        ]
        near_mm = options.kerf_mm + options.splash_mm
        return any(a != b and one.distance(other) < near_mm for (a, one), (b, other) in combinations(leads, 2))

    @cached_property
    def legs_mm(self) -> Floats:
        """Idle travel from the end of every cut (row) to the pierce of every other; home is the last of both."""
        home = self.profile.machine.home
        cuts = [cut for own in self.ways for cut in own]
        ends = np.array([*(cut.end for cut in cuts), home])
        pierces = np.array([*(cut.pierce for cut in cuts), home])
        return np.hypot(*(ends[:, None, :] - pierces[None, :, :]).transpose(2, 0, 1))

    @cached_property
    def first(self) -> list[int]:
        """Number of the first cut of every contour, and of home, as `legs_mm` counts them."""
        return np.cumsum([0, *(len(own) for own in self.ways)]).tolist()

    def sequence(
        self, order: Sequence[int], picks: Sequence[int], timed: bool = False, linked: bool = False
    ) -> CutSequence:
        """The cuts of contours in order, by the way picked for each contour (by its number); `linked` with links."""
        cuts = tuple(self.ways[i][picks[i]] for i in order)
        home = self.profile.machine.home
        if timed:
            lengths = [self._lengths_mm[i][picks[i]] for i in order]
            contours = [self.nest.contours[i] for i in order]
            legs = [
                Leg(
                    cut.pierce,
                    cut.end,
                    mm,
                    contour.kind == "mark",
                    shapely.intersects(self._sheet, shapely.Point(cut.pierce)),
                )
                for cut, mm, contour in zip(cuts, lengths, contours, strict=True)
            ]
            times = schedule(legs, feeds_of(self.profile), home)
            cuts = tuple(replace(cut, start_s=a, end_s=b) for cut, (a, b) in zip(cuts, times, strict=True))
        if linked:
            moves = pairwise(self.first[i] + picks[i] for i in order)
            links = [None, *(self.taken.get(move) for move in moves)]
            cuts = tuple(
                cut if link is None else replace(cut, pierce=before.end, lead_in=link[1], linked=True)
                for before, cut, link in zip((cuts[0], *cuts[:-1]), cuts, links, strict=True)
            )
        return CutSequence(cuts, self.start_side, home)

    def violations(self, rule: str, sequence: CutSequence) -> list[Violation]:
        """What the rule finds wrong with the cuts."""
        return self.profile.rulebook()[rule].violations(self.nest, sequence, self.profile.settings()[rule].options)

    @cached_property
    def _sheet(self) -> shapely.Polygon:
        return self.nest.sheet.polygon

    @cached_property
    def _lengths_mm(self) -> list[list[float]]:
        """Torch-on length of every way, as the check measures it."""
        found = []
        for own in self.ways:
            runs = [runs_from_cuts(self.nest, CutSequence((cut,)), self.profile.material.kerf_mm)[0] for cut in own]
            found.append([float(run[0].length_mm) for run in runs])
        return found
