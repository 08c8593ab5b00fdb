"""Burns in a new order: by rules where they make a nest, else by travel; held against the old."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, zip_longest

import numpy as np
import shapely

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.encoder.graphs import strong_components
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.inputs import Tell
from kerfwise.jobs.programs import OldJob, is_of_sheet, without_comments
from kerfwise.jobs.progress import Listener
from kerfwise.jobs.request import Request, make_request
from kerfwise.models.engines.deadline import Progress
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.plan.plan import RELAXED, Plan
from kerfwise.models.routing import Instance, solve_instance
from kerfwise.pipeline import VerifiedPlan, plan_request, verified
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.check.cuts_from_program import rebuild
from kerfwise.postproc.check.reader.program import NcProgram
from kerfwise.postproc.check.reader.read_program import old_on_machine, shift_program
from kerfwise.postproc.check.torch_run import in_steps_of
from kerfwise.postproc.clock import contour_heat_kj
from kerfwise.postproc.dialects import fitting_dialect
from kerfwise.postproc.nc.gcode import comment
from kerfwise.postproc.nc.head_comments import program_names
from kerfwise.postproc.nc.program import cut_comment, head_comments
from kerfwise.postproc.old.contours import NestOfBurns
from kerfwise.postproc.old.loops import AmbiguousNest, Unclear
from kerfwise.postproc.old.program_pieces import SplitProgram, expect_same, orders_between, reordered, tool_orders
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import About, Contiguous, Link, Precede, Statement, by_kind
from kerfwise.rules.stating.state_rules import resolve

from .result import Measured, Resequenced

# Burns as fixed cuts of the nest that was told from them: one way each, so that only the order can change.

_ON_RING_MM = 0.05


@dataclass(frozen=True, eq=False, slots=True)
class FixedPaths:
    """The facts of a nest with one candidate a contour, the cut that its burn makes of it; `cuts` are those cuts."""

    facts: Facts
    cuts: tuple[Cut, ...]


def plan_order(
    job: OldJob,
    kept: FixedPaths,
    nest_of_burns: NestOfBurns,
    apart: SplitProgram,
    limits: SolveOptions,
    listener: Listener,
) -> VerifiedPlan:
    """The best order of the burns by the rules of the profile; what no order can keep is relaxed, and said.

    Raises RulesConflict if no order was found.
    """
    chains, turns = _chains(nest_of_burns), _turns(nest_of_burns, apart)
    request = make_request(kept.facts, job.profile, relax=True, limits=limits)
    request = keep_rows(request, job.profile, chains, kept.cuts, turns)
    fixed = bool(chains) or len(turns) > 0  # other zones would be stated without them
    writer = BurnWriter(nest_of_burns, apart)
    with listener, in_steps_of(job.program.step_mm):
        planned = plan_request(request, job.profile, limits, progress=listener, move_zones=not fixed)
        return verified(planned, job.profile, writer.write, job.trusted)


def _chains(nest_of_burns: NestOfBurns) -> list[list[int]]:
    """The contours of each burn that cuts several, in its order."""
    cut_by: dict[int, list[int]] = defaultdict(list)
    for name, burn in nest_of_burns.burn_of.items():
        cut_by[burn].append(nest_of_burns.nest.index[name])
    return [contours for contours in cut_by.values() if len(contours) > 1]


def _turns(nest_of_burns: NestOfBurns, apart: SplitProgram) -> Ints:
    """Pairs (before, after) of contours whose burns keep their turn."""
    of_burn = {
        burn: nest_of_burns.nest.index[name] for name, burn in nest_of_burns.burn_of.items()
    }  # of a chain the last one
    pairs = [(of_burn[one], of_burn[then]) for one, then in sorted(tool_orders(apart.pieces))]
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)


def facts_of_burns(job: OldJob, nest_of_burns: NestOfBurns) -> FixedPaths:
    """The facts of the nest, with one candidate a contour: what its burn makes of it.

    Raises NoNest if a burn is not clearly the cut of its contours.
    """
    profile, nest = job.profile, nest_of_burns.nest
    kerf_mm = profile.material.kerf_mm
    built = rebuild(nest, job.program, kerf_mm, profile.home_on(nest), tabs_asked=profile.tabs())
    by_contour = {cut.contour: cut for cut in built.cuts}
    lines = {name: job.program.burns[k].line for name, k in nest_of_burns.burn_of.items()}
    wrong = {name: violation.text for violation in built.violations for name in violation.contours}
    wrong |= {name: f"it is not clearly the cut of {name}" for name in nest.index if name not in by_contour}
    wrong |= {cut.contour: f"it is not clearly how {cut.contour} is cut" for cut in built.cuts if not _plain(cut)}
    for cut, name in zip_longest(built.cuts, nest_of_burns.burn_of):
        if cut is None or cut.contour != name:
            wrong.setdefault(name or cut.contour, "its burns are not clearly its cut")
    if wrong:
        raise AmbiguousNest([Unclear(lines[name], text.partition(": ")[2] or text) for name, text in wrong.items()])
    lengths_mm = {run.name: run.length_mm for run in built.runs}
    cuts = tuple(by_contour[contour.id] for contour in nest.contours)
    candidates = [_candidate(cut, nest_of_burns, job, lengths_mm[cut.contour]) for cut in cuts]
    heat_kj = contour_heat_kj(nest, candidates, profile)
    return FixedPaths(compute_facts(nest, profile.fact_options(nest), candidates, heat_kj), cuts)


def _plain(cut: Cut) -> bool:
    """Whether a cut goes all round by itself, on the way from the one before if it is linked with that."""
    return cut.span is None and (not cut.linked or cut.lead_in is not None)


def _candidate(cut: Cut, nest_of_burns: NestOfBurns, job: OldJob, length_mm: float) -> Candidate:
    nest, contour = nest_of_burns.nest, nest_of_burns.nest.contour(cut.contour)
    path = job.program.burns[nest_of_burns.burn_of[cut.contour]].path
    ring = nest_of_burns.round_of[cut.contour].line() if contour.encloses else path.line()
    pierce, end = cut.pierce, cut.end if contour.encloses else path.end
    lead_in = None if cut.linked else cut.lead_in
    if cut.linked and cut.lead_in is not None:  # the way to it, not of it
        pierce, length_mm = cut.lead_in.end, length_mm - cut.lead_in.length_mm
    outside = nest.sheet.stated and not bool(shapely.contains_xy(nest.sheet.polygon, *pierce))
    return Candidate(
        contour=nest.index[cut.contour],
        entry_mm=contour.curve.project(cut.entry)[0],
        entry=cut.entry,
        direction=cut.direction,
        pierce=pierce,
        lead_in=lead_in,
        lead_out=cut.lead_out,
        end=end,
        cut_mm=length_mm,
        edge_start=outside,
        leaves=bool(shapely.distance(ring, shapely.Point(end)) > _ON_RING_MM),
        tabs=cut.tabs,
    )


@dataclass(frozen=True, eq=False, slots=True)
class BurnWriter:
    """Writes the program of a plan: the old burns in its order."""

    told: NestOfBurns
    apart: SplitProgram

    def order(self, plan: Plan) -> list[int]:
        """The burns, from 0, in the plan's order."""
        return list(dict.fromkeys(self.told.burn_of[planned.cut.contour] for planned in plan.cuts))

    def write(self, plan: Plan, nest: Nest, profile: Profile) -> str:
        """The program."""
        dialect = fitting_dialect(profile)
        names = program_names(nest, dialect)
        headings: dict[int, list[str]] = defaultdict(list)
        for k, planned in enumerate(plan.cuts, 1):
            text = cut_comment(k, names[planned.cut.contour], planned.cut, planned.kind == "mark", dialect)
            headings[self.told.burn_of[planned.cut.contour]] += [text] if text else []
        order = self.order(plan)
        return reordered(self.apart, order, head_comments(plan, nest, profile), [headings[k] for k in order])


# What stays together when burns are moved: the contours of one burn, and burns of one material and tool.

KEPT = "burns"
"""What these statements come from: no rule, but the burns, which stay as they are."""
Chain = Sequence[int]
"""Contours, numbered as in the nest, in the order in which one burn cuts them."""


def keep_rows(request: Request, profile: Profile, chains: Sequence[Chain], cuts: Sequence[Cut], turns: Ints) -> Request:
    """What is asked of a plan, and besides that the burns stay whole, and that materials and tools keep their turn.

    `cuts` are the old ones, one a contour in the order of the nest, and so are the candidates of the facts; `turns` are
    pairs (before, after) of contours, (k, 2).

    A burn that cuts the outline of a part, and then goes on to others, belongs to the run of that part: what is in the
    part comes before it. A run that a burn breaks, since it comes to the part from another, is asked of no order.
    Raises RulesConflict if no order keeps the burns whole and the hard rules as well.
    """
    if not chains and not len(turns):
        return request
    facts, stated = request.facts, request.stated
    gives_way = {name: rule.gives_way for name, rule in profile.rulebook().items()}
    chosen = [d for d in stated.dropped if not d.why.startswith(RELAXED)]  # on cycles; there may be others now
    statements = [*stated.statements, *(d.statement for d in chosen)]
    asking = [*_with_chains(facts, statements, chains), *_links(facts, chains, cuts), *_in_turn(facts, turns)]
    resolved = resolve(asking, facts.n, gives_way)
    relaxed = [d for d in stated.dropped if d.why.startswith(RELAXED)]
    return replace(request, stated=replace(resolved, dropped=(*resolved.dropped, *relaxed), exempt=stated.exempt))


def _about(facts: Facts, contours: Sequence[int], sentence: str) -> About:
    return About(KEPT, tuple(facts.nest.contours[k].id for k in contours), sentence)


def _with_chains(facts: Facts, statements: Sequence[Statement], chains: Sequence[Chain]) -> Iterator[Statement]:
    """The statements, with one run for each chain in place of the runs of its contours."""
    runs = [s for s in by_kind(statements).contiguous if s.weight is None]
    later = {contour for chain in chains for contour in chain[1:]}
    gone = {id(run) for run in runs if not later.isdisjoint(run.contours)}
    for chain in chains:
        own = next((run for run in runs if id(run) not in gone and chain[0] in run.contours), None)
        before = [] if own is None else [k for k in own.contours if k != chain[0]]
        gone |= set() if own is None else {id(own)}
        sentence = f"one burn cuts {', '.join(facts.nest.contours[k].id for k in chain)}"
        yield Contiguous((*before, *chain), _about(facts, (*before, *chain), sentence))
        for first, then in [*((k, chain[0]) for k in before), *pairwise(chain)]:
            yield Precede(first, then, _about(facts, (first, then), sentence))
    yield from (s for s in statements if id(s) not in gone)


def _links(facts: Facts, chains: Sequence[Chain], cuts: Sequence[Cut]) -> Iterator[Link]:
    """The ways of the torch from contour to contour, at no cost: each burn has its own, in any order."""
    for leave, reach in (pair for chain in chains for pair in pairwise(chain)):
        if (link := cuts[reach].lead_in) is not None:
            about = _about(facts, (leave, reach), f"{cuts[reach].contour} is cut on from {cuts[leave].contour}")
            path = tuple((x, y) for x, y in link.flatten().tolist())
            yield Link((leave,), (reach,), path, about, 0.0)


def _in_turn(facts: Facts, turns: Ints) -> Iterator[Precede]:
    for first, then in turns.tolist():
        sentence = "burns of one material and tool come before those of the next, as they did"
        yield Precede(first, then, _about(facts, (first, then), sentence))


# Burns of which nobody can tell all that they cut, put in order by travel: where the user asks for that.

_TOLD = 3
_NOT_ASKED = "no rule was asked"
_LEAST_TRAVEL = (
    "proven: of all orders in which what lies inside comes first, and what touches keeps its turn, none has less "
    f"travel; {_NOT_ASKED}"
)


def order_by_travel(
    job: OldJob, apart: SplitProgram, unclear: Sequence[Unclear], limits: SolveOptions, listener: Listener, tell: Tell
) -> Resequenced:
    """Put the burns into an order of less travel: what lies inside comes first, what touches keeps its turn.

    What can be told of the nest, without the burns that are `unclear`, is judged in both orders: where the new one
    breaks a hard rule oftener, the old one stays.
    """
    more = f"; and {len(unclear) - _TOLD} more" if len(unclear) > _TOLD else ""
    reasons = "; ".join(map(str, unclear[:_TOLD])) + more
    note = f"no rule on contours is asked, only what lies inside and what touches keeps its turn: {reasons}"
    tell(note)
    job = replace(job, notes=(*job.notes, note))
    before = Measured.of(job.program, job.profile, None, None)
    with listener:
        routed = route(job, apart, limits, listener)
    ends = routed.why or (_LEAST_TRAVEL if routed.proven else f"found, not proven; {_NOT_ASKED}")
    old = stays(job, before, None, routed.proven, ends, listener)
    if list(routed.order) == list(range(len(apart.pieces))):
        return old
    top = comment(fitting_dialect(job.profile), "RESEQUENCED BY KERFWISE, ORDER AND TRAVEL ONLY, NO RULES ASKED")
    of_sheet = [row for row in apart.head if apart.ours and is_of_sheet(row)]
    text = reordered(apart, routed.order, [*([top] if top else []), *of_sheet])
    after = Measured.of(read_back(text, job, apart, routed.order), job.profile, None, None)
    if after.idle_mm > before.idle_mm - SLACK_MM:
        return old
    if worse := broken_more(_judged(job, text), _judged(job, job.old.text)):
        ends = f"the old order stays: as far as can be told, another would break {', '.join(worse)}; {_NOT_ASKED}"
        return stays(job, before, None, False, ends, listener)
    return replace(old, program=text, after=after)


def _judged(job: OldJob, text: str) -> CheckResult | None:
    """The verdict on the contours that can be told; None where none can."""
    nest_of_burns, profile = job.told or job.partly, job.profile
    if nest_of_burns is None:
        return None
    side = compute_facts(nest_of_burns.nest, profile.fact_options(nest_of_burns.nest), ()).start_side
    return check_program(nest_of_burns.nest, without_comments(text), profile, job.name, trusted=job.trusted, side=side)


# Burns in a new order: read back, each as it was, and held against the old order; or the old order, which stays.

SLACK_MM = 0.01
"""Idle travel that is not worth another order."""


def stays(job: OldJob, before: Measured, nest: Nest | None, proven: bool, ends: str, listener: Listener) -> Resequenced:
    """The old program as it is."""
    text, ended = job.old.source, listener.interrupted
    return Resequenced(job.name, "keep", text, before, before, nest, None, proven, ends, job.notes, job.home, ended)


def broken_more(one: CheckResult | None, other: CheckResult | None) -> list[str]:
    """Hard rules that one order breaks oftener than another does, excuses counted: what none can keep is no fault."""
    if one is None or other is None:
        return []
    least = {judgement.id: len(judgement.violations) + len(judgement.excused) for judgement in other.rules}
    return [
        judgement.id
        for judgement in one.rules
        if judgement.strength == "hard" and len(judgement.violations) > least.get(judgement.id, 0)
    ]


def no_gain_message(before: Measured, after: Measured, profile: Profile) -> str:
    """Before and after in words, where contours planned afresh gain nothing; else "".

    It is idle travel that counts. Where the pierces are others, or the profile lets cuts be linked or shared, the time
    of all does, at the profile's speeds.
    """
    machine = profile.machine
    in_time = profile.link_options() is not None or profile.common_options() is not None

    def cost_mm(of: Measured) -> float:
        if not in_time and before.pierces == after.pierces:
            return of.idle_mm
        burning_s = of.pierces * machine.pierce_time_s + of.cut_mm / machine.cut_feed_mm_s
        return of.idle_mm + burning_s * machine.travel_mm_s

    if cost_mm(after) < cost_mm(before) - SLACK_MM:
        return ""
    figures = (f"{of.idle_mm / 1000:.3f} m of idle travel and {of.pierces} pierces" for of in (before, after))
    return "before {}, after {}".format(*figures)


def read_back(text: str, job: OldJob, apart: SplitProgram, order: Sequence[int]) -> NcProgram:
    """The new program in the coordinates of the drawing, with every burn as it was.

    Raises InputError if it cannot be read back, or if a burn is not what it was.
    """
    try:
        written = old_on_machine(text, job.profile, job.trusted)
    except InputError as error:
        line = text.split("\n")[error.line - 1] if error.line else ""
        raise InputError(
            f"the burns in their new order cannot be read back ({line!r}: {error.message}); nothing is written",
            file=job.name,
        ) from None
    expect_same(apart, order, written)
    return shift_program(written.program, job.program.zero or (0.0, 0.0))


# Burns that make no nest, in an order of less travel: rules on contours say nothing of them, geometry does.


@dataclass(frozen=True, slots=True)
class BurnRoute:
    """The order of the burns, from 0, and whether no other that keeps what must come first has less travel."""

    order: tuple[int, ...]
    proven: bool
    why: str = ""


def route(job: OldJob, apart: SplitProgram, limits: SolveOptions, progress: Progress | None = None) -> BurnRoute:
    """The shortest travel through all burns, each as it is, from home to where the program ends."""
    burns, pieces = apart.burns, apart.pieces
    n = len(pieces)
    orders = orders_between(burns, pieces, job.profile.material.kerf_mm)
    stays = tuple(range(n))
    if n < 2:
        return BurnRoute(stays, True)
    component = strong_components(n, orders)
    if len(set(component.tolist())) < n:
        return BurnRoute(stays, False, "what lies inside and what touches contradict the old order: it stays as it is")
    home = job.profile.machine.home
    last = job.old.program
    tail = last.rapids[-len(last.homing_mm)][1] if last.homing_mm else None
    starts, ends = np.array([piece.start for piece in pieces]), np.array([piece.end for piece in pieces])
    cost = np.zeros((n + 1, n + 1), dtype=np.int64)
    cost[0, 1:] = _um(home, starts)
    cost[1:, 0] = 0 if tail is None else _um(ends, tail)
    cost[1:, 1:] = _um(ends[:, None], starts)
    np.fill_diagonal(cost, 0)
    instance = Instance(job.name, cost, tuple((k,) for k in range(n + 1)), orders + 1, start=0, closed=True)
    answer = solve_instance(instance, limits, progress)
    if not answer.tour:
        return BurnRoute(stays, False, "no order was found within the limit: it stays as it is")
    return BurnRoute(tuple(vertex - 2 for vertex in answer.tour[1:]), answer.proven)


def _um(one: Floats | Point, other: Floats | Point) -> Ints:
    """Distances between points (…, 2) in mm, whole µm."""
    return np.asarray(np.rint(np.linalg.norm(np.subtract(one, other), axis=-1) * UM_PER_MM), dtype=np.int64)
