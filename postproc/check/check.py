"""The independent check: geometry, the program and the profile; no facts, no statements, no model."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from kerfwise.encoder.cut import CutSequence, Side
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.check.reader.program import NcProgram, expand_torches
from kerfwise.postproc.check.reader.read_program import Trusted, origin_warning, read_on_machine, with_program_origin
from kerfwise.rules.judging.pierces import starts_in_older_kerfs
from kerfwise.rules.judging.violation import Violation
from kerfwise.rules.options.yaml_positions import raise_together
from kerfwise.rules.profile.contradictions import bevel_misfits
from kerfwise.rules.profile.sections import Scrap
from kerfwise.rules.profile.technique import Technique

from .bevels import judge_bevels
from .coverage import (
    burnt_rings,
    burnt_tabs,
    burnt_twice,
    coverage,
    finished_by_others,
    first_cuts,
    open_contours,
)
from .cuts_from_program import pierce_pass_violations, rebuild
from .features_kept import Allowed, features_lost
from .feeds import Thermometer, heatings_of_cuts, heatings_of_program, judge_running, measured
from .gouging import Accepted, Pairs, edge_loss_notes, gouges, paths_off_sheet, wrong_edge_losses
from .loose_metal import broken_bridges, cuts_in_loose_metal, cuts_in_loose_skeleton, wrong_pieces
from .machine_limits import (
    bad_links,
    edge_starts,
    long_leads,
    paths_beyond_travel,
    rapids_beyond_travel,
    run_up_mm,
    stated_spacing,
    stricter,
    torch_count,
    wrong_spacing,
    wrong_torch_cuts,
)
from .plan_conformance import Claims, PlanClaims, claims_kept, idle_mm, strays_from, totals
from .plan_runs import burnt_before, runs_from_cuts, unlit_tabs
from .result import CheckResult, JudgedCuts, Judgement, Measured, RelaxedStatement, read_relaxed, relaxed_warnings
from .rule_verdicts import about_nothing, judge
from .small_features import (
    JudgedNest,
    Slots,
    judged_nest,
    misplaced,
    passes_of_cuts,
    passes_of_program,
    slits_of_made,
    slot_notes,
    small_hole_notes,
    small_holes,
    with_passes,
)
from .stated import CutTimes, wrong_state, wrong_times
from .torch_run import TorchRun, in_steps_of, judgement, tolerance_mm

_ROUNDING_MM = 1e-3


@dataclass(frozen=True, slots=True)
class _Cut:
    """What is cut on a nest, as a plan or a program has it.

    `slots` are the nest's narrow ones, `faults` what the reader of the cuts found wrong, `astray` ways without torch
    that leave the machine's travel. `comments` are those of a program; a plan has none, and says itself how long its
    leads are.
    """

    slots: Slots
    cuts: CutSequence
    runs: Sequence[TorchRun]
    faults: Sequence[Violation]
    astray: Iterable[Violation] = ()
    comments: Sequence[str] | None = None


Known = Callable[[], JudgedCuts | None]
"""What the rules have said of cuts, asked for once all else is judged: another process may still be at it."""


@dataclass(frozen=True, slots=True)
class Besides:
    """What a program is judged by besides nest and profile.

    Without a thermometer no temperature is judged. What a plan says is `planned`: the program has to follow that, cut
    by cut, and names, zones and excuses that it does not tell are the plan's. Where the cuts that it makes are those
    that rules are `known` to have judged, the rules do not judge them once more. What is `trusted` is taken as it
    stands: nobody judges what a material on the machine has. `side` is the start side where the program states none.
    """

    thermometer: Thermometer | None = None
    planned: PlanClaims | None = None
    known: Known | None = None
    trusted: Trusted | None = None
    side: Side | None = None


NOTHING_BESIDES = Besides()


def check_cuts(
    nest: Nest,
    cuts: CutSequence,
    profile: Technique,
    claims: Claims | None = None,
    relaxed: Sequence[RelaxedStatement] = (),
    thermometer: Thermometer | None = None,
) -> CheckResult:
    """Judge a plan's cuts, and what the plan says of them, where that is given.

    The torch's paths are made anew from the nest, the kerf and the leads. `relaxed` are the statements that the plan
    says are relaxed. Without a thermometer no temperature is judged.
    """
    judged_by = judged_nest(nest, profile)
    nest, slots = with_passes(judged_by.nest, passes_of_cuts(cuts), profile)
    judged_by = replace(judged_by, nest=nest)
    runs, faults = runs_from_cuts(nest, cuts, profile.material.kerf_mm)
    judged, warnings = _judge_paths(judged_by, _Cut(slots, cuts, runs, faults), profile, relaxed)
    in_kerfs = _starts_in_kerfs(nest, cuts, profile)
    heatings = heatings_of_cuts(nest, cuts, runs, profile, in_kerfs)
    felt = measured(first_cuts(nest, cuts), heatings, thermometer)
    rules = judge(nest, felt, profile, relaxed)
    for other in (cuts.turned(by) for by in range(1, torch_count(cuts))):
        paths, wrong = runs_from_cuts(nest, other, profile.material.kerf_mm)
        more, _ = _judge_paths(judged_by, _Cut(slots, other, paths, wrong), profile, relaxed)
        judged, rules = stricter(judged, more), stricter(rules, judge(nest, first_cuts(nest, other), profile, relaxed))
    if profile.machine.torches.several or torch_count(cuts) > 1:
        judged.append(judgement("torches", wrong_torch_cuts(cuts, profile)))
    by_rules = JudgedCuts(nest, felt, profile, tuple(relaxed), tuple(rules))
    warnings += [*relaxed_warnings(relaxed), *about_nothing(nest, felt, profile)]
    if claims is not None:
        broken, texts = claims_kept(claims, rules)
        judged += [judgement("totals", totals(nest, cuts, runs, claims, in_kerfs)), judgement("claims", broken)]
        warnings += texts
        if claims.blocks is not None:
            said = (nest, cuts, profile, judged_by.shares, in_kerfs, claims.blocks, claims.time_s)
            warnings += _first_few(list(CutTimes(*said).wrong(runs)))
    return CheckResult(
        (*judged, *rules), tuple(warnings), _measured(runs, idle_mm(nest, cuts)), by_rules, tuple(relaxed)
    )


def check_program(
    nest: Nest,
    nc_text: str,
    profile: Technique,
    file: str = "",
    besides: Besides = NOTHING_BESIDES,
) -> CheckResult:
    """Judge an NC program: what it burns is read with a reader of its own and matched with the nest.

    Raises InputError with the line, for a program that is malformed or says something the reader does not understand.
    """
    judged_by = judged_nest(nest, profile)
    nest = judged_by.nest
    planned = besides.planned
    profile = profile if planned is None else profile.at_origin(planned.origin)
    raise_together(bevel_misfits(profile, nest))
    program = read_on_machine(nc_text, nest, profile, file, besides.trusted)
    late = list(wrong_times(program, profile, None if planned is None else planned.time_s))
    bevels = judge_bevels(nest, program, profile, judged_by.shares)
    program = bevels.program
    with in_steps_of(program.step_mm):
        result = _judge_program(judged_by, program, profile, besides, late)
        for by in range(1, 1 + max((len(burn.torches) for burn in program.burns), default=0)):
            other = _judge_program(judged_by, program, profile, besides, turned=by)
            result = replace(result, rules=tuple(stricter(result.rules, other.rules)))
        if bevels.violations is not None:
            result = replace(result, rules=(judgement("bevels", bevels.violations), *result.rules))
        return replace(result, warnings=(*result.warnings, *wrong_state(program.comments, result.state)))


def damage(nest: Nest, cuts: CutSequence, profile: Technique, claims: Claims) -> Iterator[str]:
    """What of a plan's leads, entries, lengths and times is not as nest and profile have it, whatever the rules say."""
    judged_by = judged_nest(nest, profile)
    nest, _ = with_passes(judged_by.nest, passes_of_cuts(cuts), profile)
    runs, faults = runs_from_cuts(nest, cuts, profile.material.kerf_mm)
    in_kerfs = _starts_in_kerfs(nest, cuts, profile)
    for violation in (*faults, *totals(nest, cuts, runs, claims, in_kerfs)):
        yield violation.text
    if claims.blocks is not None:
        yield from CutTimes(nest, cuts, profile, judged_by.shares, in_kerfs, claims.blocks, claims.time_s).wrong(runs)


_FEW = 3


def _first_few(texts: list[str]) -> list[str]:
    more = len(texts) - _FEW
    return [*texts[:_FEW], *([f"the plan says {more} other times that are not those of its cuts"] if more > 0 else [])]


def _starts_in_kerfs(nest: Nest, cuts: CutSequence, profile: Technique) -> frozenset[int]:
    """The positions of cuts that begin in the kerf of an older one, and pierce nothing."""
    return starts_in_older_kerfs(nest, cuts, profile.material.kerf_mm) if profile.kerf_starts else frozenset()


def _judge_program(
    judged_by: JudgedNest,
    program: NcProgram,
    profile: Technique,
    besides: Besides,
    late: Sequence[str] = (),
    turned: int = 0,
) -> CheckResult:
    """The judgement where, of what several torches burn together, each comes so many places sooner (`turned`).

    `late` are warnings of the program's times.
    """
    nest, planned = judged_by.nest, besides.planned
    notes = [*origin_warning(program, profile), *_coarse(program, profile), *late]
    profile = with_program_origin(program, profile)
    of_torches = list(wrong_spacing(program, profile, planned is not None))
    profile = profile.at_spacing(stated_spacing(program, planned, profile.machine.torches))
    torches = profile.machine.torches
    burnt = expand_torches(program, torches.shift, turned)
    nest, slots = with_passes(nest, passes_of_program(nest, burnt, profile), profile)
    judged_by = replace(judged_by, nest=nest)
    kerf_mm, in_passes = profile.material.kerf_mm, profile.cuts.pierce_pass is not None
    built = rebuild(nest, burnt, kerf_mm, profile.home_on(nest), planned, profile.tabs(), in_passes)
    if built.cuts.start_side is None and besides.side is not None:
        built = replace(built, cuts=replace(built.cuts, start_side=besides.side))
    astray = rapids_beyond_travel(nest, program, profile)
    relaxed = read_relaxed(nest, program.comments, profile.rulebook())
    if planned is not None:
        relaxed = tuple(dict.fromkeys((*relaxed, *planned.relaxed)))
    cut = _Cut(slots, built.cuts, built.runs, built.violations, astray, program.comments)
    judged, warnings = _judge_paths(judged_by, cut, profile, relaxed)
    if torches.several or of_torches:
        judged.append(judgement("torches", of_torches))
    if planned is not None and not turned:
        judged.append(judgement("follows-plan", strays_from(planned, nest, built.cuts, profile.material.kerf_mm)))
    begun = _starts_in_kerfs(nest, built.cuts, profile)
    in_kerfs = {(run.where, built.cuts[run.position - 1].torch) for run in built.runs if run.position in begun}
    judged += judge_running(nest, program, profile, built.runs, judged_by.shares, in_kerfs)
    felt = measured(first_cuts(nest, built.cuts), heatings_of_program(burnt), besides.thermometer)
    known = besides.known() if besides.known is not None and not turned else None
    same = None if known is None else known.known(nest, felt, profile, relaxed)
    rules = tuple(judge(nest, felt, profile, relaxed)) if same is None else same
    warnings += [*relaxed_warnings(relaxed), *about_nothing(nest, felt, profile)]
    warnings = [*notes, *built.warnings, *warnings]
    ran = _measured(built.runs, program.idle_mm)
    return CheckResult((*judged, *rules), tuple(warnings), ran, relaxed=tuple(relaxed))


def _coarse(program: NcProgram, profile: Technique) -> Iterator[str]:
    """A warning where the control counts in steps that are coarser than paths are judged by elsewhere."""
    allowed_mm = tolerance_mm(profile.material.kerf_mm)
    if program.step_mm and allowed_mm <= program.step_mm:
        yield f"the control counts in steps of {program.step_mm:g} mm: paths are judged within {allowed_mm:g} mm"


def _judge_paths(
    judged_by: JudgedNest, cut: _Cut, profile: Technique, relaxed: Sequence[RelaxedStatement]
) -> tuple[list[Judgement], list[str]]:
    """What is wrong with the paths of cuts."""
    slots, cuts, runs, faults, comments = cut.slots, cut.cuts, cut.runs, cut.faults, cut.comments
    nest, kerf_mm = judged_by.nest, profile.material.kerf_mm
    tabs = {} if profile.tabs() is None else {one.contour: unlit_tabs(one, kerf_mm) for one in cuts if one.tabs}
    whole, runs = runs, [piece for run in runs for piece in run.lit]
    losses_mm = {name: slot.loss_mm(kerf_mm) for name, slot in slots.items()}
    found = gouges(nest, runs, kerf_mm, _sharing(nest, profile, relaxed), losses_mm)
    cut_contours = [nest.contour(one.contour) for one in cuts[: cuts.made] if one.contour in nest.index]
    before = burnt_before(nest, cuts[: cuts.made], kerf_mm, cuts.begun)
    several = burnt_rings(nest.contours, runs, before, kerf_mm, tabs)
    opened = list(open_contours(several, cuts.positions()))
    if comments is None:  # the cuts that are made of a program end with what finishes their contours
        opened += finished_by_others(several, cuts.positions())
    lost = list(wrong_edge_losses(nest, kerf_mm, _accepted(profile)))
    skipped, allowed = frozenset(k for fault in [*faults, *opened] for k in fault.cuts), Allowed.by(profile)
    uncut = features_lost(runs, kerf_mm, skipped, slits_of_made(nest, cuts), tabs, before.lines, allowed)
    run_up = run_up_mm(nest, profile)
    loose = [*cuts_in_loose_metal(nest, runs, kerf_mm, before.lines)]
    loose += cuts_in_loose_skeleton(nest, runs, cut_contours, kerf_mm)
    long = [] if comments is None else long_leads(whole, profile, comments, run_up)
    judged = [
        judgement("every-contour-once", [*coverage(nest, cuts, relaxed), *opened, *_of("every-contour-once", faults)]),
        *([judgement("tabs", burnt_tabs(several))] if tabs else []),
        *([judgement("edge-loss", lost)] if nest.losses or lost else []),
        *([judgement("bridges", broken_bridges(nest, runs, kerf_mm))] if nest.bridges else []),
        *([judgement("pierce-pass", pierce_pass_violations(nest, cuts, profile))] if profile.cuts.pierce_pass else []),
        judgement("burnt-twice", burnt_twice(several, _overcut_mm(profile))),
        judgement("links", [*bad_links(runs, kerf_mm, profile.longest_link_mm), *long]),
        judgement("loose-metal", loose),
        *(
            [judgement("scrap-pieces", wrong_pieces(nest, runs, cut_contours, profile))]
            if profile.cuts.scrap != Scrap()
            else []
        ),
        judgement("small-holes", small_holes(judged_by, cuts, whole, profile)),
        judgement("contour-geometry", _of("contour-geometry", faults)),
        judgement("features-kept", [*uncut.lost, *misplaced(slots, cuts, kerf_mm)]),
        judgement("kerf-side", _of("kerf-side", faults)),
        judgement("on-sheet", paths_off_sheet(nest, runs, kerf_mm, run_up)),
        judgement("edge-start", edge_starts(nest, whole, profile)),
        judgement("no-gouging", found.violations),
    ]
    if profile.reach_on(nest) is not None:
        judged.append(judgement("within-travel", [*paths_beyond_travel(nest, cuts, runs, profile), *cut.astray]))
    return judged, [
        *([f"resumed after cut {cuts.made}: what was cut before is taken as stated"] if cuts.made else []),
        *small_hole_notes(judged_by, profile),
        *slot_notes(nest, slots, kerf_mm),
        *uncut.told(),
        *edge_loss_notes(nest),
        *found.warnings,
    ]


def _accepted(profile: Technique) -> Accepted:
    """Which losses of parts that touch are: edges count as touching within what the check allows, too."""
    common = profile.cuts.common
    touch_mm = min(common.gap_tolerance_mm, tolerance_mm(profile.material.kerf_mm)) + _ROUNDING_MM
    shortest_mm = common.shortest_mm if common.accept_loss else None
    return Accepted(touch_mm, math.inf if shortest_mm is None else shortest_mm)


def _overcut_mm(profile: Technique) -> float:
    """How far a cut may run on along what is burnt: its overcut or lead-out, and the kerfs at its ends."""
    leads = profile.leads
    return max(profile.length_mm(leads.hole_overcut_mm), leads.lead_out_length_mm) + 2 * profile.material.kerf_mm


def _sharing(nest: Nest, profile: Technique, relaxed: Sequence[RelaxedStatement]) -> Pairs | None:
    """Pairs of parts that may burn each other's metal; None for all, where the profile lets contours touch."""
    book = profile.rulebook()
    guards = {name for name in profile.settings() if book[name].guards_metal}
    if not guards:
        return None
    let = (statement.contours for statement in relaxed if statement.rule in guards)
    return frozenset(frozenset(nest.contour(name).part for name in names if name in nest.index) for names in let)


def _measured(runs: Sequence[TorchRun], idle_mm: float) -> Measured:
    return Measured(sum(not run.linked for run in runs), math.fsum(run.length_mm for run in runs), idle_mm)


def _of(rule: str, faults: Sequence[Violation]) -> list[Violation]:
    return [fault for fault in faults if fault.rule == rule]
