"""The check of a plan and of its program: what they hold is handed to the check, and its verdicts back to the plan."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from kerfwise.encoder.cut import HotSpot, Side
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.shown import shown
from kerfwise.encoder.still_going import long_job, so_much, told_if_long
from kerfwise.models.plan.plan import Plan, RuleReport
from kerfwise.postproc.check import CheckResult, Claims, Heating, JudgedCuts, Planned, Relaxed, Thermometer, check_cuts
from kerfwise.postproc.check import check_program as check_nc
from kerfwise.postproc.check.reader.old import Trusted
from kerfwise.postproc.dialects import load_dialect
from kerfwise.rules.profile.for_one_nest import changed_since
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.rule_file import RuleFile

__all__ = ["check_plan", "check_program", "judge", "report_of", "thermometer_of"]


def _of_plan(nest: Nest, plan: Plan, profile: Profile) -> str:
    return f"checking the plan of {nest.file or 'the nest'}"


@long_job(_of_plan)
def check_plan(nest: Nest, plan: Plan, profile: Profile) -> CheckResult:
    """Judge a plan by geometry and the profile alone, and what it states of itself.

    A plan whose `rules` are empty claims nothing about them; see `report_of` to fill them in.
    """
    so_much(len(plan.cuts), "cut", "cuts")
    claims = Claims(
        plan.totals.cut_mm,
        plan.totals.idle_mm,
        plan.totals.pierces,
        plan.totals.time_s,
        tuple(planned.length_mm for planned in plan.cuts),
        {rule.id: rule.holds for rule in plan.rules},
        plan.profile.get("sha256") == profile.sha256 and not any(changed_since(plan.made_with, profile.for_one_nest)),
    )
    relaxed = _relaxed_of(plan)
    thermometer = thermometer_of(nest, profile)
    profile = profile.at_origin(plan.origin).at_spacing(plan.sequence().spacing_mm(profile.machine.torches.axis))
    return check_cuts(nest, plan.sequence(profile.home_on(nest)), profile, claims, relaxed, thermometer)


def check_program(
    nest: Nest,
    nc_text: str,
    profile: Profile,
    file: str = "",
    plan: Plan | None = None,
    known: JudgedCuts | None = None,
    trusted: Trusted | None = None,
    side: Side | None = None,
) -> CheckResult:
    """Judge an NC program by geometry, the profile and, where a rule asks for it, temperatures.

    Given a plan, the program has to follow it, and what the program's comments do not say is taken from there. What it
    leaves to the machine's material is refused, unless that is `trusted`. `side` is the start side that it is judged by
    where it states none. The rules do not judge once more what is `known` of the same cuts.

    Raises
    ------
    InputError
        With the line, for a program that is malformed or says something the reader does not understand.
    """
    planned = None if plan is None else Planned(plan.sequence(), _relaxed_of(plan), plan.origin)
    program = file or f"the program of {nest.file or 'the nest'}"
    with told_if_long(f"checking {program}"):
        so_much(nc_text.count("\n"), "line", "lines")
        heat = thermometer_of(nest, profile)
        return check_nc(nest, nc_text, profile, file, heat, planned=planned, known=known, trusted=trusted, side=side)


def _relaxed_of(plan: Plan) -> tuple[Relaxed, ...]:
    """The statements that a plan says it has relaxed."""
    return tuple(Relaxed(dropped.rule, dropped.contours) for dropped in plan.dropped if dropped.relaxed)


def thermometer_of(nest: Nest, profile: Profile) -> Thermometer | None:
    """What measures the temperatures of a sheet by simulation; None where no rule asks for any."""
    limit = profile.temperature_limit()
    if limit is None:
        return None

    def measure(stretches: Sequence[Heating]) -> tuple[HotSpot, ...] | None:
        from kerfwise.models.physics.heat.timed_path import in_order, torch_on
        from kerfwise.models.physics.heat.watch import hot_spots

        try:
            burns = [torch_on(s.name, s.points, s.begin_s, s.end_s, s.pierce_s, s.slowness) for s in stretches]
            path = in_order(burns, 0.0)
        except InputError:  # times that contradict each other are judged as such
            return None
        heat = replace(profile.heat, model="physical")
        return hot_spots(nest, path, heat, profile.material.thickness_mm, limit.most_c)

    return measure


def judge(nest: Nest, plan: Plan, program: str, profile: Profile, trusted: Trusted | None = None) -> CheckResult:
    """Judge a plan and the program written from it: a rule holds if it holds in both.

    A program in a dialect without comments is held against the plan, as `check --plan` does.

    Raises
    ------
    InputError
        If the program that the profile's dialect makes of the plan cannot be read back: with the block, for nobody has
        the program.
    """
    planned = check_plan(nest, plan, profile)
    written = _check_written(nest, plan, program, profile, planned.by_rules, trusted)
    of_program = {judgement.id: judgement for judgement in written.rules}
    rules = []
    for judgement in planned.rules:
        other = of_program.pop(judgement.id, None)
        more = () if other is None else other.violations
        rules.append(replace(judgement, violations=judgement.violations or more))
        if other is not None and other.must_be_judged and judgement.unjudged is None:
            rules[-1] = replace(rules[-1], unjudged=other.unjudged)
    warnings = tuple(dict.fromkeys(planned.warnings + written.warnings))
    result = CheckResult((*of_program.values(), *rules), warnings, written.measured)
    return result if result.ok else _by_block(result, program)


def _check_written(
    nest: Nest,
    plan: Plan,
    program: str,
    profile: Profile,
    known: JudgedCuts | None,
    trusted: Trusted | None = None,
) -> CheckResult:
    silent = load_dialect(profile.machine.dialect).comment is None
    try:
        return check_program(nest, program, profile, plan=plan if silent else None, known=known, trusted=trusted)
    except InputError as error:
        block = f" ({_block(program, error.line)})" if error.line is not None else ""
        message = f"the program that dialect {profile.machine.dialect} makes here cannot be read back{block}"
        raise InputError(f"{message}: {error.message}; nothing is written", file=profile.file or None) from error


def _by_block(result: CheckResult, program: str) -> CheckResult:
    """The verdict on a program that is not written: for its lines, the blocks themselves."""

    def told(text: str) -> str:
        return re.sub(r"\bline (\d+)", lambda found: _block(program, int(found.group(1))), text)

    rules = tuple(
        replace(j, violations=tuple(replace(v, text=told(v.text)) for v in j.violations)) for j in result.rules
    )
    return replace(result, rules=rules, warnings=tuple(map(told, result.warnings)))


def _block(program: str, line: int) -> str:
    lines = program.split("\n")
    return f"block {lines[line - 1].strip()!r}" if 0 < line <= len(lines) else f"line {line}"


def report_of(result: CheckResult, profile: Profile) -> tuple[RuleReport, ...]:
    """The verdicts on the profile's rules as a plan states them."""
    book, files = profile.rulebook(), profile.rule_files()
    return tuple(
        RuleReport(
            judgement.id,
            judgement.strength,
            judgement.holds,
            tuple((excused.violation.contours, excused.why) for excused in judgement.excused),
            tuple((v.contours, v.text) for v in judgement.violations if judgement.strength == "soft"),
            *_told_of(files.get(judgement.id)),
        )
        for judgement in result.rules
        if judgement.id in book and judgement.strength != "off"
    )


def _told_of(file: RuleFile | None) -> tuple[str, str, bool]:
    """What a plan says of the file that a rule stands in: its name, its sha256, and whether it took a shipped place."""
    return ("", "", False) if file is None else (shown(file.path.name), file.sha256, file.in_place_of_shipped)
