"""Burns as fixed cuts of the nest that was told from them: one way each, so that only the order can change."""

from __future__ import annotations

from dataclasses import dataclass

import shapely

from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nest import Nest
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check.rebuild import rebuild
from kerfwise.postproc.clock.contour_heat import contour_heat_kj
from kerfwise.postproc.dialects import fitting_dialect
from kerfwise.postproc.nc.names import program_names
from kerfwise.postproc.nc.program import cut_comment, head_comments
from kerfwise.postproc.old.contours import NoNest, Told, Unclear
from kerfwise.postproc.old.pieces import TakenApart
from kerfwise.postproc.old.reordered import reordered
from kerfwise.rules.profile.profile import Profile

from .ask import ask
from .listening import Listener
from .old_program import OldJob
from .produce import Produced, produce

_ON_RING_MM = 0.05


def plan_order(
    job: OldJob, facts: Facts, told: Told, apart: TakenApart, limits: SolveOptions, listener: Listener
) -> Produced:
    """The best order of the burns by the rules of the profile; what no order can keep is relaxed, and said.

    Raises
    ------
    RulesConflict
        If no order was found.
    """
    asked = ask(facts, job.profile, relax=True, limits=limits)
    writer = BurnWriter(told, apart)
    with listener:
        return produce(asked, job.profile, limits, listener, and_zones=True, write=writer.write, trusted=job.trusted)


def facts_of_burns(job: OldJob, told: Told) -> Facts:
    """The facts of the nest, with one candidate a contour: its burn.

    Raises
    ------
    NoNest
        If a burn is not clearly the cut of one contour.
    """
    profile, nest = job.profile, told.nest
    built = rebuild(nest, job.program, profile.material.kerf_mm, profile.home_on(nest))
    by_contour = {cut.contour: cut for cut in built.cuts}
    lines = {name: job.program.burns[k].line for name, k in told.burn_of.items()}
    wrong = {name: violation.text for violation in built.violations for name in violation.contours}
    wrong |= {name: f"it is not clearly the cut of {name}" for name in nest.index if name not in by_contour}
    if wrong or len(by_contour) != len(built.cuts):
        raise NoNest([Unclear(lines[name], text.partition(": ")[2] or text) for name, text in wrong.items()])
    candidates = [_candidate(nest, by_contour[contour.id], told, job) for contour in nest.contours]
    heat_kj = contour_heat_kj(nest, candidates, profile)
    return compute_facts(nest, profile.fact_options(nest), candidates, heat_kj)


def _candidate(nest: Nest, cut: Cut, told: Told, job: OldJob) -> Candidate:
    contour = nest.contour(cut.contour)
    path = job.program.burns[told.burn_of[cut.contour]].path
    start, end = path.vertices[0, :2].tolist(), path.vertices[-1, :2].tolist()
    ring = told.round_of[cut.contour].line() if contour.encloses else path.line()
    outside = nest.sheet.stated and not bool(shapely.contains_xy(nest.sheet.polygon, *start))
    return Candidate(
        contour=nest.index[cut.contour],
        entry_mm=contour.curve.project(cut.entry)[0],
        entry=cut.entry,
        direction=cut.direction,
        pierce=(start[0], start[1]),
        lead_in=cut.lead_in,
        lead_out=cut.lead_out,
        end=(end[0], end[1]),
        cut_mm=path.length_mm,
        edge_start=outside,
        leaves=bool(shapely.distance(ring, shapely.Point(end)) > _ON_RING_MM),
    )


@dataclass(frozen=True, eq=False, slots=True)
class BurnWriter:
    """Writes the program of a plan: the old burns in its order."""

    told: Told
    apart: TakenApart

    def order(self, plan: Plan) -> list[int]:
        """The burns, from 0, in the plan's order."""
        return [self.told.burn_of[planned.cut.contour] for planned in plan.cuts]

    def write(self, plan: Plan, nest: Nest, profile: Profile) -> str:
        """The program."""
        dialect = fitting_dialect(profile)
        names = program_names(nest, dialect)
        headings = [
            [text] if (text := cut_comment(k, names[p.cut.contour], p.cut, p.kind == "mark", dialect)) else []
            for k, p in enumerate(plan.cuts, 1)
        ]
        return reordered(self.apart, self.order(plan), head_comments(plan, nest, profile), headings)
