"""What is asked of a plan: facts, what rules state of them, the limits of a solve; and that no plan was found."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Unpack

from kerfwise.encoder.already_cut import NOTHING_CUT, AlreadyCut
from kerfwise.encoder.candidates import CandidateBuilder
from kerfwise.encoder.candidates.candidate import Candidate, LeadOptions
from kerfwise.encoder.candidates.common_edges import facing_edges
from kerfwise.encoder.candidates.older_kerfs import OlderKerfs
from kerfwise.encoder.candidates.stretches import (
    StretchWays,
    begun_by,
    past_ways,
    split_ways,
    to_be_split,
    with_stretches,
)
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.errors import MOST_DETAILS, InputError, RulesConflict
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.facts.compute import loose_in, remaining_facts, with_ways
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.facts.links import with_links
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.tolerances import tolerance_mm
from kerfwise.encoder.identical_parts import Group, align_copies, entries_of_copies, shared_candidates
from kerfwise.encoder.nearest_name import unknown
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.progress_notice import amount, long_job
from kerfwise.encoder.questions import SHARED_EDGES, Choice, Question, Questions, with_answers
from kerfwise.models.engines import ENGINES, Engine, member_of
from kerfwise.models.engines.solution import Limits, Solution, SolveOptions
from kerfwise.models.engines.tuning import REQUEST_ENOUGH_WORK as ENOUGH_WORK
from kerfwise.models.engines.tuning import REQUEST_LONGER as LONGER
from kerfwise.models.engines.tuning import REQUEST_RELAX as RELAX
from kerfwise.models.jit import running_s
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.postproc.clock import contour_heat_kj
from kerfwise.postproc.dialects import dialect_misfits
from kerfwise.rules.lock import check_locks
from kerfwise.rules.options.yaml_positions import raise_together
from kerfwise.rules.profile.contradictions import (
    common_cut_problems,
    misfits,
)
from kerfwise.rules.profile.profile import SHORTEST_SHARED_MM, Profile
from kerfwise.rules.registry import RULES
from kerfwise.rules.stating.state_rules import (
    HOPELESS,
    DroppedStatement,
    Stated,
    every_statement,
    hopeless_anyway,
    loose_orders,
    state_rules,
)
from kerfwise.rules.stating.zones_yield import zones_that_yield

from .gantry import drop_parts, facts_of_torches, first_groups, with_best_spacing
from .time_limits import JobLimit

if TYPE_CHECKING:
    from kerfwise.models.plan.conflict import Conflict


@dataclass(frozen=True, eq=False, slots=True)
class Request:
    """What is asked of a plan: the facts of the nest, and what the profile's rules state of them.

    `seconds` is how long it took to state them, by the clock.
    """

    facts: Facts
    stated: Stated
    seconds: float = 0.0


Found = Callable[[Request, Solution], None]
"""Told of a better plan that is found while others are looked for: what it was asked, and its route. Nothing is proven
of it, and no geometry has looked at its whole order: only a check says whether it is lawful."""


def _measuring(
    nest: Nest,
    profile: Profile,
    already: AlreadyCut = NOTHING_CUT,
    limit: JobLimit | None = None,
    *,
    zoned: bool = True,
) -> str:
    return f"measuring {nest.file or 'the nest'}"


@long_job(_measuring)
def facts_of(
    nest: Nest,
    profile: Profile,
    already: AlreadyCut = NOTHING_CUT,
    limit: JobLimit | None = None,
    *,
    zoned: bool = True,
) -> Facts:
    """All facts of the nest, as the profile has it cut, under the profile's thresholds.

    If they are not to be `zoned`, all is one zone where geometry alone would draw zones, which takes longer than a
    first plan is worth, and the heat of single contours is not known.

    Where some of it is `already` cut they are those of what is left. A `limit` notes how long finding candidates takes;
    the compiling of rules in model files ends within it.

    Raises
    ------
    InputError
        If a lock names what the nest does not have, a contour cannot be cut as the profile asks, or a rule in a model
        file is on and there is no MiniZinc, or more contours than it bears.
    RulesConflict
        If contours cannot be cut and hard rules cannot hold in any order: the second is mostly the reason of the first.
    """
    if rules := profile.model_rules():
        from kerfwise.rules.flat.compiler import minizinc_program

        minizinc_program()
        for rule in rules:
            rule.expect_small(nest)
    with _compiling(profile, None if limit is None else limit.seconds()):
        return _measured(nest, profile, already, limit, zoned)


def _compiling(profile: Profile, seconds: float | None) -> AbstractContextManager[None]:
    """Has the compiling of rules in model files end within so many seconds, where these are given."""
    if seconds is None or not profile.model_rules():
        return nullcontext()
    from kerfwise.rules.flat.compiler import compiled_within

    return compiled_within(seconds)


def _measured(nest: Nest, profile: Profile, already: AlreadyCut, limit: JobLimit | None, zoned: bool) -> Facts:
    """See `facts_of`; rules are compiled for as long as they take."""
    amount(len(nest.contours), "contour", "contours")
    nest = profile.as_cut(nest)
    check_locks(profile.locks, nest)
    raise_together(misfits(profile, nest, bool(already)))
    if unknown := sorted(already.contours - nest.index.keys()):
        had = f"the plan says of contours that {nest.file or 'the nest'} does not have that they are cut already"
        raise InputError(f"{had}: it was made from another nest", details=tuple(unknown))
    loose = loose_in(nest, already.contours)
    profile = with_best_spacing(nest, profile)
    groups, step = first_groups(nest, profile), profile.machine.torches.step
    try:
        drawn = align_copies(nest, groups, step) if groups else nest
        leads = profile.lead_options(nest)
        leads = replace(leads, entry_points=entries_of_copies(drawn, leads.entry_points, groups, step))
        began_s = running_s()
        candidates, met, made = _with_ways_along(drawn, profile, leads, already, loose)
        candidates, met = _beside_bevels(drawn, profile, candidates, met)
        if limit is not None:
            limit.candidates_s = running_s() - began_s
    except InputError as error:
        unheated = replace(profile.fact_options(nest), zone_heat_kj=None)  # without candidates no heat is known
        if alone := hopeless_anyway(_left(compute_facts(nest, unheated, ()), already), profile):
            besides = (
                f"besides, {error.message}, and --relax (in Python: relax=True) does not help there:",
                *error.details[:MOST_DETAILS],
            )
            expect_no_shared_edges(nest, profile, already)
            raise RulesConflict(HOPELESS, (*(f"{a.rule}: {a.sentence}" for a in alone), *besides)) from None
        if not isinstance(error, Questions):
            expect_no_shared_edges(nest, profile, already)
        raise
    if groups:
        candidates, met, groups = _cut_alike(candidates, met, groups, step)
    options = given = profile.fact_options(nest)
    if not (zoned or given.zones_decided or nest.scrap or made is not None or profile.machine.torches.several):
        options, heat_kj = replace(given, zone_contours=max(len(nest.contours), 1)), None
    else:  # zones may have a budget of it
        heat_kj = contour_heat_kj(nest, candidates, profile)
    facts = replace(compute_facts(nest, options, candidates, heat_kj, met), options=given)
    if profile.machine.torches.several and nest.contours:
        return facts_of_torches(facts, groups, profile)
    links = None if profile.no_links(nest) else profile.link_options()
    facts = with_links(facts, links, _burnt(already))
    if made is not None and made.ways:
        heat_kj = contour_heat_kj(made.nest, made.ways, profile)[len(nest.contours) :]
        facts = with_ways(facts, made, heat_kj)
    return _left(facts, already)


def _with_ways_along(
    nest: Nest, profile: Profile, leads: LeadOptions, already: AlreadyCut, loose: Collection[str]
) -> tuple[tuple[Candidate, ...], OlderKerfs | None, StretchWays | None]:
    """The candidates of the nest, and its ways along rows of neighbours; a row whose ends have no room is none."""
    asked, kerf_mm = profile.snake_options(), leads.kerf_mm
    past = past_ways(nest, (cut for _, cut in already.begun), kerf_mm)
    begun = {name for name in begun_by(past) if name not in already.contours}
    out = [nest.index[name] for name in already.contours]
    left = [c.id for c in nest.contours if c.id not in begun.union(already.contours, loose)]
    rows = []
    if asked is not None:
        from kerfwise.encoder.candidates.snake import rows_of, snake_of

        rows = rows_of(nest, kerf_mm, asked, left, leads.directions["outer"])
    if past:
        rows = [replace(one, name=f"{one.name}.{len(already.cuts)}") for row in rows for one in row.of or (row,)]
    taken = frozenset[str]().union(*(row.members for row in rows))
    split = to_be_split(nest, kerf_mm, profile.split_options(), [name for name in left if name not in taken])
    builder = CandidateBuilder(nest, leads, already, loose)
    while rows or split or begun:
        members = frozenset({*split, *begun}).union(*(row.members for row in rows))
        led = {*split, *(name for row in rows for name in (row.contours[0].id, row.contours[-1].id))}
        candidates, met = builder.build(members, led)
        ways = {row.name: snake_of(nest, row, candidates, leads) for row in rows}
        unfit = {name for name, way in ways.items() if way is None}
        halves = list(split_ways(nest, split, candidates, met, kerf_mm, profile.split_options()))
        bare = {*split} - {one.contour for way in halves for one in way.along}
        if not unfit and not bare:
            sure = [*(way for way in ways.values() if way is not None), *halves]
            made = with_stretches(nest, sure, candidates, met, leads, profile.shared_edges, out, past)
            if isinstance(made, StretchWays):
                of_rest = None if made.met is None else made.met.of_kept(range(len(made.rest)), made.count)
                return made.rest, of_rest, made
            unfit = {made}
            bare = {one.contour for way in halves if way.id == made for one in way.along}
        rows = [one for row in rows for one in (row.of if row.name in unfit else (row,))]
        split = {name: how for name, how in split.items() if name not in bare}
    return (*builder.build(), None)


def _beside_bevels(
    nest: Nest, profile: Profile, candidates: tuple[Candidate, ...], met: OlderKerfs | None
) -> tuple[tuple[Candidate, ...], OlderKerfs | None]:
    """Those that leave room for tilted torches, where contours have bevels."""
    bevelling = profile.bevelling_of(nest)
    if bevelling is None:
        return candidates, met
    from kerfwise.encoder.bevels.room import kept_candidates

    kept = kept_candidates(nest, candidates, bevelling, profile.reach_on(nest))
    return tuple(candidates[k] for k in kept), None if met is None else met.of_kept(kept, len(candidates))


def expect_no_shared_edges(nest: Nest, profile: Profile, already: AlreadyCut = NOTHING_CUT) -> None:
    """Ask about parts that share an edge, or are a kerf apart, of a nest without a plan, where common cuts would do.

    Raises Questions with that question alone.
    """
    if already or profile.common_options() is not None or profile.machine.torches.several:
        return
    if dict(profile.drawing.answers).get(SHARED_EDGES):
        return
    outers = [(k, c) for k, c in enumerate(nest.contours) if c.kind == "outer"]
    kerf_mm = profile.material.kerf_mm
    touch = f"touch: each part loses half a kerf, {kerf_mm / 2:g} mm, along them"
    for gap_mm, apart in ((kerf_mm, "are one kerf apart"), (0.0, touch)):
        facing = max(facing_edges(outers, gap_mm, tolerance_mm(kerf_mm)), key=lambda f: f.length_mm, default=None)
        if facing is None or facing.length_mm < SHORTEST_SHARED_MM:
            continue
        answer, wanted, keys = _with_shared_edges(profile)
        try:
            make_request(facts_of(nest, wanted), wanted)
        except (InputError, RulesConflict):
            continue
        pair = f"{nest.contours[facing.contour].id} and {nest.contours[facing.other].id}"
        once = Choice(answer, f"both parts by one cut ({keys})")
        refuse = Choice("refuse", "not cut: the nest is refused, to be drawn otherwise")
        text = f"there is no room for a cut between parts: edges of {pair} {apart}: how are such edges cut?"
        raise Questions([Question(SHARED_EDGES, text, (once, refuse))], file=nest.file or None)


def _with_shared_edges(profile: Profile) -> tuple[str, Profile, str]:
    """The answer that has shared edges cut once, the profile with it, and all that it then has to say, as YAML."""
    keys = f"cuts: {{common: {{shortest: {SHORTEST_SHARED_MM:g} mm, good_side: any, accept_loss: true}}}}"
    wanted = _answered(profile, "once")
    wrong = common_cut_problems(wanted.cuts.common, wanted.machine, wanted.material)
    if not (any(wrong) or any(dialect_misfits(wanted))):
        return "once", wanted, keys
    return "pierced", _answered(profile, "pierced"), f"{keys}, machine: {{kerf_start: false}}"


def _answered(profile: Profile, answer: str) -> Profile:
    answers = with_answers(profile.drawing.answers, [(SHARED_EDGES, answer)])
    return replace(profile, drawing=replace(profile.drawing, answers=answers)).as_answered()


def _cut_alike(
    candidates: tuple[Candidate, ...], met: OlderKerfs | None, groups: list[Group], step: Point
) -> tuple[tuple[Candidate, ...], OlderKerfs | None, list[Group]]:
    """Candidates of groups that all torches can make alike; a group that has none is none."""
    kept, bare = shared_candidates(candidates, groups, step)
    while bare:
        groups = drop_parts(groups, bare)
        kept, bare = shared_candidates(candidates, groups, step)
    return tuple(candidates[k] for k in kept), None if met is None else met.of_kept(kept, len(candidates)), groups


def _burnt(already: AlreadyCut) -> tuple[Cut, ...]:
    return already.cuts if already.broken_off is None else (*already.cuts, already.broken_off)


def _left(facts: Facts, already: AlreadyCut) -> Facts:
    return remaining_facts(facts, already) if already else facts


def make_request(
    facts: Facts,
    profile: Profile,
    relax: bool = False,
    limits: SolveOptions | None = None,
) -> Request:
    """What the rules state of the facts; `relax` lets the cheapest statements give way where they clash.

    The look for them ends within `limits`, and so does the compiling of rules in model files. Raises InputError if a
    rule's model file cannot be compiled, or not within a limit in seconds; RulesConflict if hard orders contradict each
    other (and nothing that may give way helps), or, unless `relax` leaves them out, if contours are left in metal that
    has fallen out.
    """
    with _compiling(profile, None if limits is None else limits.time_s):
        return _requested(facts, profile, relax, limits)


def _requested(facts: Facts, profile: Profile, relax: bool, limits: SolveOptions | None) -> Request:
    """The same; rules are compiled for as long as they take."""
    loose, began_s = loose_orders(facts), running_s()
    zoning = frozenset(name for name, rule in RULES.items() if rule.minds_zones)
    if relax:
        from kerfwise.models.engines.deadline import Deadline
        from kerfwise.models.plan.conflict import state_relaxed, without_cycles
        from kerfwise.models.plan.plan import RELAXED

        deadline = None
        if limits is not None:
            deadline = Deadline.of(replace(limits, time_s=limits.time_s and RELAX * limits.time_s))
        if len(set(facts.zone.tolist())) > 1:  # zones yield before anything is relaxed, and after what gives way
            zone = zones_that_yield(facts, without_cycles(facts, profile, every_statement(facts, profile)[0]), zoning)
            facts = facts if zone is None else replace(facts, zone=zone)
        stated = state_relaxed(facts, profile, deadline=deadline)
        left_out = (DroppedStatement(order, f"{RELAXED}{order.about.sentence}") for order in loose)
        return Request(facts, replace(stated, dropped=(*stated.dropped, *left_out)), running_s() - began_s)
    if loose:
        raise RulesConflict(
            "some contours cannot be cut any more (--relax, in Python relax=True, leaves them out)",
            tuple(o.about.sentence for o in loose),
        )
    stated = state_rules(facts, profile)
    if (zone := zones_that_yield(facts, stated.statements, zoning)) is not None:
        facts = replace(facts, zone=zone)
        stated = state_rules(facts, profile, stated)
    return Request(facts, stated, running_s() - began_s)


# The limits of a solve for one nest and one profile: whoever solves gets home and feeds from here.


def options_for(nest: Nest, profile: Profile, **limits: Unpack[Limits]) -> SolveOptions:
    """The limits given, with the machine's home on this nest and the feeds that plans are made with.

    See `SolveOptions` for what each limit means; `work` is 30 and `engine` all of them where nothing is said.

    Raises InputError for a limit that is not above 0, a gap outside 0 … 1, a seed that is no whole number from 0, or an
    engine that there is not.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> from kerfwise.rules.profile.load import load_profile
    >>> plate = nest(100, 100, part("A", rect(10, 10, 80, 80)))
    >>> options = options_for(plate, load_profile(), work=2, engine="ideals")
    >>> options.work, options.member, options.home_mm, round(options.feeds.cut_mm_s, 1)
    (2, 'ideals', (0.0, 0.0), 41.7)
    """
    amounts: dict[str, Any] = {name: limits.get(name) for name in ("work", "time_s", "no_improvement_s", "memory_gb")}
    for name, this_amount in amounts.items():
        if this_amount is not None:
            _expect(name, this_amount, "a number over 0", _is_number(this_amount) and this_amount > 0)
    gap, seed, engine = limits.get("gap"), limits.get("seed", 1), limits.get("engine", "portfolio")
    if gap is not None:
        _expect("gap", gap, "a share from 0 to 1, such as 0.01", _is_number(gap) and 0 <= gap <= 1)
    _expect("seed", seed, "a whole number from 0", isinstance(seed, int) and seed >= 0)
    if engine not in ENGINES:
        raise InputError(unknown("engine", str(engine), ENGINES))
    named: dict[str, Any] = {name: value for name, value in limits.items() if name != "engine"}
    return SolveOptions(**named, home_mm=profile.home_on(nest), feeds=feeds_of(profile), member=member_of(engine))


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and math.isfinite(value)


def _expect(name: str, value: object, expected: str, fits: bool) -> None:
    if not fits:
        raise InputError(f"{name}: expected {expected}, got {value!r}")


NOT_SHOWN = "which rules contradict each other, if any do, was not shown within the limit"
FEWEST_NOT_SHOWN = "how few of the hard rules contradict each other was not shown within the limit"


class NoPlan(RulesConflict):
    """No plan holds every hard rule, or none was found.

    Attributes
    ----------
    conflict
        Statements that contradict each other, in sentences with contour ids, and the cheapest way out. None where no
        contradiction was shown: then `message` and `reasons` say all there is to say.
    within_limit
        Whether the look for a contradiction came to its end within the limit.
    why
        What went wrong in the first place.
    facts, profile
        What was to be planned.
    ways
        Where no contradiction was shown: what was tried, and what to try.
    """

    def __init__(
        self,
        why: RulesConflict,
        facts: Facts,
        profile: Profile,
        conflict: Conflict | None = None,
        within_limit: bool = True,
        ways: tuple[str, ...] = (),
    ) -> None:
        super().__init__(why.message, why.reasons, proven=why.proven)
        self.ways = () if conflict is not None else ways
        self.why, self.facts, self.profile, self.conflict = why, facts, profile, conflict
        self.within_limit = within_limit

    def __str__(self) -> str:
        if self.conflict is not None:
            return str(self.conflict)
        return "\n".join([str(self.why), *(f"  {line}" for line in self.notes)])

    @property
    def notes(self) -> tuple[str, ...]:
        """What is to be said where no contradiction was shown."""
        not_shown = FEWEST_NOT_SHOWN if self.why.proven else NOT_SHOWN
        return self.ways if self.within_limit else (f"note: {not_shown}", *self.ways)


RELAXING = "--relax (in Python relax=True), which lets the cheapest hard rules give way"


def ways_on(limits: SolveOptions, engine: Engine, relaxed: bool, proven: bool = False) -> tuple[str, ...]:
    """What was tried within limits that have come to nothing, and what to try, one line each.

    Where it is proven that there is no plan, nothing but relaxing helps.

    Examples
    --------
    >>> ways_on(SolveOptions(time_s=3.0), "portfolio", True)[0]
    'tried: all engines within 3 s, with the cheapest hard rules relaxed'
    >>> ways_on(SolveOptions(work=0.5), "portfolio", True)[1]
    'try: --work 4, which counts work and not the clock (in Python work=4)'
    """
    if proven:
        return () if relaxed else (f"try: {RELAXING}",)
    who = "all engines" if engine == "portfolio" else f"the engine {engine}"
    spent = f"work {limits.work:g}" if limits.time_s is None else f"{limits.time_s:g} s"
    looked = "then for a contradiction among the hard rules, and none was shown"
    looked = "with the cheapest hard rules relaxed" if relaxed else looked
    more = f"{max(ENOUGH_WORK, LONGER * limits.work if limits.time_s is None else 0.0):g}"
    tries = [f"--work {more}, which counts work and not the clock (in Python work={more})"]
    if limits.time_s is not None:
        tries.append(f"--time-limit {LONGER * limits.time_s:g} (in Python time_limit=)")
    if engine != "portfolio":
        tries.append("all engines, without --engine (in Python engine=)")
    if not relaxed:
        tries.append(f"or {RELAXING}")
    return f"tried: {who} within {spent}, {looked}", f"try: {'; '.join(tries)}"
