"""How a plant cuts: tabs, small holes, links, bevels, and what a nest becomes under its profile."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kerfwise.encoder.bevels.cut_nest import bevelled, with_bevels
from kerfwise.encoder.bridges import expect_wider
from kerfwise.encoder.candidates.candidate import LEAST_WASTE_MM, LeadOptions
from kerfwise.encoder.facts.links import LinkOptions
from kerfwise.encoder.nest import Kind, Nest
from kerfwise.encoder.scrap import with_scrap
from kerfwise.encoder.slits import with_slits
from kerfwise.encoder.small_holes import HoleLimits, with_small_holes
from kerfwise.encoder.torch_path import TabOptions, with_corner_times

from .active_rules import ActiveRules

if TYPE_CHECKING:
    from kerfwise.encoder.bevels.room import Bevelling


@dataclass(frozen=True)
class Technique(ActiveRules):
    """A profile's rules with what cuts become by them and by its values: see `Profile`."""

    def _asked_of_leads(self) -> LeadOptions:
        """What the sections and the rules ask of each lead, whatever the nest."""
        leads = self.leads
        lead_options = LeadOptions(
            entries=leads.entries,
            kerf_mm=self.material.kerf_mm,
            lead=leads.lead,
            lead_in_mm=self.length_mm(leads.lead_in_mm),
            lead_in_min_mm=leads.lead_in_min_mm,
            lead_out=leads.lead_out,
            lead_out_mm=leads.lead_out_length_mm,
            pierce_clearance_mm=0.0,
            splash_mm=None,
            hole_overcut_mm=self.length_mm(leads.hole_overcut_mm),
            edge_start=leads.edge_start,
        )
        for rule, options, strength in self._every_rule:
            lead_options = rule.lead_options(lead_options, options, strength)
        return lead_options

    def tabs(self) -> TabOptions | None:
        """Which parts have tabs, and of what kind; None where no rule asks for any."""
        return self._asked_of_leads().tabs

    def rules_of_direction(self, kind: Kind) -> tuple[str, ...]:
        """Ids of the rules that leave one direction only for this kind of contour."""
        free = LeadOptions()
        return tuple(
            rule.id
            for rule, options, strength in self._every_rule
            if len(rule.lead_options(free, options, strength).directions[kind]) == 1
        )

    def hole_limits(self) -> HoleLimits:
        """What is done with small holes, in mm on this sheet: `small_holes`, its thickness, and the pierce's room."""
        # Without a lead the pierce is on the path.
        asked_mm = self._asked_of_leads().pierce_clearance_mm if self.leads.lead != "none" else 0.0
        clearance_mm = max(asked_mm, self.material.kerf_mm / 2 + LEAST_WASTE_MM)
        return self.small_holes.limits(self.material.thickness_mm, clearance_mm)

    def link_options(self) -> LinkOptions | None:
        """How links are made: no longer than the profile allows, and than pays; None where there are none."""
        machine, leads = self.machine, self.leads
        longest_mm = self.cuts.links.longest_mm
        if longest_mm <= 0 or self.no_links() is not None:
            return None
        slower = 1 / machine.cut_feed_mm_s - 1 / machine.travel_mm_s
        if slower > 0:
            lead_s = self.length_mm(leads.lead_in_mm) * (1 / machine.cut_feed_mm_s + 1 / machine.travel_mm_s)
            longest_mm = min(longest_mm, (max(machine.pierce_time_s, machine.edge_preheat_s) + lead_s) / slower)
        return LinkOptions(longest_mm, self.material.kerf_mm, self._asked_of_leads().splash_mm or 0.0)

    def no_links(self, nest: Nest | None = None) -> str | None:
        """Why there can be no links, whatever length of them is allowed: a clause; None where there can."""
        limit = self.temperature_limit()
        if limit is not None and limit.dwells:
            return f"the rule {limit.rule} lets metal cool while the torch is off (dwells)"
        if self.corner_feed() is not None:
            return "corners are cut more slowly (corner_feed), and the one where a link begins is of two cuts"
        if nest is not None and nest.scrap:
            return "links would cut metal off the skeleton, in which scrap lines are cut afterwards"
        return None

    def without_losses(self, nest: Nest) -> Nest:
        """The nest less what parts that touch lose to the cut between them, where the profile accepts that."""
        edges = self.common_options() if self.cuts.common.accept_loss else None
        if edges is None:
            return nest
        from kerfwise.encoder.touching_edges import with_touching_edges_cut

        return with_touching_edges_cut(nest, self.material.kerf_mm, edges.shortest_mm, edges.gap_mm)

    def as_cut(self, nest: Nest) -> Nest:
        """The nest as this plant cuts it: small holes are marks or gone, others know their feed, slots have slits.

        So has the skeleton its lines, where the profile has them made. Of parts that touch it is what they keep, where
        the profile accepts the loss.

        Raises InputError if a bridge of the nest is narrower than the kerf, a part has no room to lose what it is to
        lose, or the sheet has none for a bevel.
        """
        expect_wider(nest, self.material.kerf_mm)
        cut_nest = self.without_losses(with_small_holes(nest, self.hole_limits()))
        cut_nest = with_slits(cut_nest, self.material.kerf_mm) if self.cuts.narrow == "slit" else cut_nest
        cut_nest = with_scrap(cut_nest, self.material.kerf_mm, self.cuts.scrap.grid_mm, self.cuts.scrap.remnant)
        bevels = self.bevel_options()
        cut_nest = cut_nest if bevels is None else with_bevels(cut_nest, bevels)
        law = self.corner_feed()
        return cut_nest if law is None else with_corner_times(cut_nest, law, self.material.kerf_mm)

    def bevelling_of(self, nest: Nest) -> Bevelling | None:
        """Which corners of a nest as it is cut have loops; None where no contour has a bevel.

        Raises InputError for bevels that cannot be cut as they are drawn.
        """
        options = self.bevel_options()
        if options is None or next(bevelled(nest), None) is None:
            return None
        from kerfwise.encoder.bevels.room import plan_bevels

        return plan_bevels(nest, options)
