"""The check of a plan and of its program, word by word where the plan is known, and whether both are of the nest."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import zip_longest

import numpy as np
import shapely

from kerfwise.encoder.cut import CutSequence, HotSpot, Side
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.progress_notice import amount, long_job, notice_if_long
from kerfwise.models.plan.plan import Plan, RuleReport
from kerfwise.models.plan.read_plan import expect_named_alike
from kerfwise.postproc.check import (
    Besides,
    CheckResult,
    Claims,
    Heating,
    JudgedCuts,
    Judgement,
    PlanClaims,
    RelaxedStatement,
    Thermometer,
    check_cuts,
)
from kerfwise.postproc.check import check_program as check_nc
from kerfwise.postproc.check.check import Known, damage
from kerfwise.postproc.check.reader.program import Burn, NcProgram
from kerfwise.postproc.check.reader.read_program import Trusted
from kerfwise.postproc.check.small_features import judged_nest
from kerfwise.postproc.dialects import Dialect, fitting_dialect, load_dialect
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.nc.toolpaths import SHA_DIGITS
from kerfwise.rules.judging.violation import Violation
from kerfwise.rules.plan_state import PlanState
from kerfwise.rules.profile.technique import Technique
from kerfwise.rules.profile.values import changed_since
from kerfwise.rules.rule import RuleFile

__all__ = ["check_plan", "check_program", "judge", "report_of", "thermometer_of"]


# The check of a plan and of its program: what they hold is handed to the check, and its verdicts back to the plan.


def _of_plan(nest: Nest, plan: Plan, profile: Technique) -> str:
    return f"checking the plan of {nest.file or 'the nest'}"


@long_job(_of_plan)
def check_plan(nest: Nest, plan: Plan, profile: Technique) -> CheckResult:
    """Judge a plan by geometry and the profile alone, and what it states of itself.

    A plan whose `rules` are empty claims nothing about them; see `report_of` to fill them in.
    """
    amount(len(plan.cuts), "cut", "cuts")
    claims = _claims_of(plan, profile)
    relaxed = _relaxed_of(plan)
    thermometer = thermometer_of(nest, profile)
    profile = _as_planned(plan, profile)
    result = check_cuts(nest, plan.sequence(profile.home_on(nest)), profile, claims, relaxed, thermometer)
    told = _told_otherwise(plan, result, profile) if claims.of_all else ()
    return replace(result, warnings=(*result.warnings, *told))


def damage_of(plan: Plan, nest: Nest, profile: Technique) -> Iterator[str]:
    """What of a plan of this nest, made with this profile, is not as both have it; nothing is known of other plans.

    One that does not say which profile it was made with is held against this one.
    """
    if not plan.profile.get("sha256"):
        plan = replace(plan, profile={**plan.profile, "sha256": profile.sha256})
    claims = _claims_of(plan, profile)
    if not claims.of_all or plan.nest.get("sha256") != nest.sha256:
        return
    try:
        expect_named_alike(plan, nest)
    except InputError as error:
        yield error.message
        return
    profile = _as_planned(plan, profile)
    yield from damage(nest, plan.sequence(profile.home_on(nest)), profile, claims)


def _as_planned(plan: Plan, profile: Technique) -> Technique:
    """The profile at the origin of a plan, and its torches as far apart as there."""
    return profile.at_origin(plan.origin).at_spacing(plan.sequence().spacing_mm(profile.machine.torches.axis))


def _claims_of(plan: Plan, profile: Technique) -> Claims:
    of_all = plan.profile.get("sha256") == profile.sha256 and not any(
        changed_since(plan.made_with, profile.for_one_nest)
    )
    return Claims(
        plan.totals.cut_mm,
        plan.totals.idle_mm,
        plan.totals.pierces,
        plan.totals.time_s,
        tuple(planned.length_mm for planned in plan.cuts),
        {rule.id: rule.holds for rule in plan.rules},
        of_all,
        tuple(planned.length_mm for planned in plan.burns if planned.cut.way),
        plan.time.nc_blocks if of_all and plan.time is not None else None,
    )


def _told_otherwise(plan: Plan, result: CheckResult, profile: Technique) -> Iterator[str]:
    """What a plan says of rules and of its state, where the check of it under the same profile finds otherwise."""
    found = {rule.id: rule for rule in report_of(result, profile)}
    for said in plan.rules:
        if (rule := found.get(said.id)) is None:
            yield f"the plan says something of the rule {said.id}, which the profile does not have"
        elif rule.strength != said.strength:
            yield f"the plan says that the rule {said.id} is {said.strength}, and it is {rule.strength}"
        elif places := _unlike(_at(said.exceptions), _at(rule.exceptions)) or _unlike(
            _at(said.breaches), _at(rule.breaches)
        ):
            yield f"what the plan says of where the rule {said.id} does not hold is not what is found: {places}"
    if plan.state is not None and _unlike(_places_of(plan.state), _places_of(result.state)):
        yield f"the plan says of itself that it is {plan.state.short()}, and the check finds: {result.state.words()}"


Places = list[tuple[tuple[str, ...], str]]


def _at(places: Iterable[tuple[tuple[str, ...], str]]) -> Places:
    return [(tuple(sorted(names)), "") for names, _ in places]


def _places_of(state: PlanState) -> Places:
    return [(tuple(sorted(place.contours)), f"{place.how} {place.rule}") for place in state.places]


def _unlike(said: Places, found: Places) -> str:
    """The contours of the first place that is only said, or only found; "" where there is none."""
    counts = Counter(said)
    counts.subtract(found)
    return next((" and ".join(names) or "the sheet" for (names, _), count in counts.items() if count), "")


def check_program(
    nest: Nest,
    nc_text: str,
    profile: Technique,
    file: str = "",
    plan: Plan | None = None,
    known: Known | None = None,
    trusted: Trusted | None = None,
    side: Side | None = None,
) -> CheckResult:
    """Judge an NC program by geometry, the profile and, where a rule asks for it, temperatures.

    Given a plan, the program has to follow it, and what the program's comments do not say is taken from there. What it
    leaves to the machine's material is refused, unless that is `trusted`. `side` is the start side that it is judged by
    where it states none. The rules do not judge once more what is `known` of the same cuts. Raises InputError with the
    line, for a program that is malformed or says something the reader does not understand.
    """
    planned = None
    if plan is not None:
        time_s = None if plan.time is None else plan.totals.time_s
        planned = PlanClaims(plan.sequence(), _relaxed_of(plan), plan.origin, time_s)
    program = file or f"the program of {nest.file or 'the nest'}"
    with notice_if_long(f"checking {program}"):
        amount(nc_text.count("\n"), "line", "lines")
        heat = thermometer_of(nest, profile)
        besides = Besides(heat, planned=planned, known=known, trusted=trusted, side=side)
        return check_nc(nest, nc_text, profile, file, besides)


def _relaxed_of(plan: Plan) -> tuple[RelaxedStatement, ...]:
    """The statements that a plan says it has relaxed."""
    return tuple(RelaxedStatement(dropped.rule, dropped.contours) for dropped in plan.dropped if dropped.relaxed)


def thermometer_of(nest: Nest, profile: Technique) -> Thermometer | None:
    """What measures the temperatures of a sheet by simulation; None where no rule asks for any."""
    limit = profile.temperature_limit()
    if limit is None:
        return None

    def measure(stretches: Sequence[Heating]) -> tuple[HotSpot, ...] | None:
        from kerfwise.models.physics.heat.pacing import hot_spots
        from kerfwise.models.physics.heat.timed_path import in_order, torch_on

        try:
            burns = [torch_on(s.name, s.points, s.begin_s, s.end_s, s.pierce_s, s.slowness) for s in stretches]
            path = in_order(burns, 0.0)
        except InputError:  # times that contradict each other are judged as such
            return None
        heat = replace(profile.heat, model="physical")
        return hot_spots(nest, path, heat, profile.material.thickness_mm, limit.most_c)

    return measure


def judge(
    nest: Nest,
    plan: Plan,
    program: str,
    profile: Technique,
    trusted: Trusted | None = None,
    planned: CheckResult | None = None,
) -> CheckResult:
    """Judge a plan and the program written from it: a rule holds if it holds in both.

    A program in a dialect without comments is held against the plan, as `check --plan` does. `planned` is the verdict
    on the plan, where that is known.

    Raises InputError if the program that the profile's dialect makes of the plan cannot be read back: with the block,
    for nobody has the program.
    """
    planned = planned or check_plan(nest, plan, profile)
    by_rules = planned.by_rules
    return judged_by_both(planned, check_written(nest, plan, program, profile, lambda: by_rules, trusted), program)


def judged_by_both(planned: CheckResult, written: CheckResult, program: str) -> CheckResult:
    """The verdict on a plan and its program, of those on each."""
    of_program = {judgement.id: judgement for judgement in written.rules}
    rules = []
    for judgement in planned.rules:
        other = of_program.pop(judgement.id, None)
        more = () if other is None else other.violations
        rules.append(replace(judgement, violations=judgement.violations or more))
        if other is not None and other.must_be_judged and judgement.unjudged is None:
            rules[-1] = replace(rules[-1], unjudged=other.unjudged)
    warnings = tuple(dict.fromkeys(planned.warnings + written.warnings))
    result = CheckResult((*of_program.values(), *rules), warnings, written.measured, relaxed=planned.relaxed)
    return result if result.ok else _by_block(result, program)


def check_written(
    nest: Nest,
    plan: Plan,
    program: str,
    profile: Technique,
    known: Known,
    trusted: Trusted | None = None,
) -> CheckResult:
    """The verdict on a program that was just made of a plan; see `judge`."""
    silent = load_dialect(profile.machine.dialect).comment is None
    try:
        return check_program(nest, program, profile, plan=plan if silent else None, known=known, trusted=trusted)
    except InputError as error:
        block = f" ({_block(program, error.line)})" if error.line is not None else ""
        if trusted is not None:  # burns of an old program, word for word: no dialect made them
            message = f"its burns in another order cannot be read back{block}: {error.message}; nothing is written"
            raise InputError(message, file=nest.file or None) from error
        message = f"the program that dialect {profile.machine.dialect} makes here cannot be read back{block}"
        raise InputError(f"{message}: {error.message}; nothing is written", file=profile.file or None) from error


# A verdict that another process finds: what both have of nest and profile does not go from one to the other.

Handed = tuple[CheckResult, CutSequence, tuple[Judgement, ...]]


def handed_on(result: CheckResult) -> Handed:
    """A verdict on a plan without nest and profile."""
    assert result.by_rules is not None
    return replace(result, by_rules=None), result.by_rules.cuts, result.by_rules.rules


def taken_over(handed: Handed, nest: Nest, plan: Plan, profile: Technique) -> CheckResult:
    """The verdict that was handed on, of a plan of this nest under this profile."""
    result, cuts, rules = handed
    profile = _as_planned(plan, profile)
    by_rules = JudgedCuts(judged_nest(nest, profile).nest, cuts, profile, result.relaxed, rules)
    return replace(result, by_rules=by_rules)


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


def report_of(result: CheckResult, profile: Technique) -> tuple[RuleReport, ...]:
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
    return ("", "", False) if file is None else (escape_text(file.path.name), file.sha256, file.in_place_of_shipped)


# A program held, word by word, against what the writer makes of its plan: whatever was changed by hand is told.
#
# The check judges what a program burns. What else its words do (powers, height control, the process, stations, waits
# of the machine) it knows only in part; here every block has to be the plan's own. Comments, line numbers, blanks and
# how a number is spelt do not count, and neither do pauses (M0, M1), which the reader judges.

_RULE = "follows-plan"
_COMMENT = re.compile(r"\([^()]*\)|;.*")
_TOKEN = re.compile(r"[A-Z$%]+|[+-]?(?:\d+\.?\d*|\.\d+)|\S")
_PAUSES = ({("M", 0.0)}, {("M", 1.0)})
_LENGTHS = frozenset("XYIJR")
_OFF_MM, _SHARE, _NAMED = 0.1, 1e-3, 3

Word = tuple[str, float]


def held_to_plan(result: CheckResult, nest: Nest, text: str, plan: Plan, profile: Technique) -> CheckResult:
    """The verdict on a program, and where its words are others than those of its plan under this profile.

    A plan that was told from an older program has that one's words: it is not asked.
    """
    if not plan.nest.get("sha256"):
        return result
    dialect = fitting_dialect(profile)
    try:
        own = write_program(plan, nest, profile)
    except InputError:  # of another nest, say: the cuts differ, then
        return result
    found = [Violation(_RULE, (), words) for words in _differences(text, own, dialect)]
    rules = tuple(
        replace(rule, violations=(*rule.violations, *found)) if rule.id == _RULE else rule for rule in result.rules
    )
    return replace(result, rules=rules)


def _differences(text: str, own: str, dialect: Dialect) -> Iterator[str]:
    shown = 0
    for mine, other in zip_longest(_blocks(text, dialect), _blocks(own, dialect)):
        if mine is None or other is None:
            yield (
                f"it ends before {_spelt(other)}, which the plan's own program says"
                if mine is None
                else f"line {mine[0]}: it says {_spelt(mine)} where the plan's own program has ended"
            )
            return
        if _same(mine[2], other[2], dialect):
            continue
        shown += 1
        yield f"line {mine[0]}: it says {_spelt(mine)}, the plan's own program says {_spelt(other)} there"
        if shown >= _NAMED or [letter for letter, _ in mine[2]] != [letter for letter, _ in other[2]]:
            return


Row = tuple[int, str, list[Word]]


def _spelt(row: Row | None) -> str:
    return "" if row is None else f"`{escape_text(row[1])}`"


def _blocks(text: str, dialect: Dialect) -> Iterator[Row]:
    """Line, text and words of each block that a control acts on."""
    for line, raw in enumerate(text.split("\n"), 1):
        row = (raw if dialect.comment is None else _COMMENT.sub(" ", raw)).strip().upper()
        words = _words(row, dialect)
        if words and {*words} not in _PAUSES and row != "%":
            yield line, row, words


def _words(row: str, dialect: Dialect) -> list[Word]:
    letter, words = "", list[Word]()
    for token in _TOKEN.findall(row.replace(" ", "")):
        try:
            value = float(token)
        except ValueError:
            if letter:
                words.append((letter, math.nan))
            letter = token
            continue
        words.append((letter, value))
        letter = ""
    if letter:
        words.append((letter, math.nan))
    return words[1:] if words and words[0][0] == "N" else words


def _same(mine: list[Word], other: list[Word], dialect: Dialect) -> bool:
    if len(mine) != len(other):
        return False
    lengths = not mine[0][0] and dialect.signed  # a move of signed numbers
    return all(
        one == two and _near(a, b, _OFF_MM * dialect.scale if lengths or one in _LENGTHS else 0.0)
        for (one, a), (two, b) in zip(mine, other, strict=True)
    )


def _near(a: float, b: float, off: float) -> bool:
    return (math.isnan(a) and math.isnan(b)) or abs(a - b) <= max(off, _SHARE * abs(b) if off else 1e-6 + 1e-4 * abs(b))


# Whether a program is one of the nest that it is given with: times and temperatures of another's mean nothing.

_MADE_FROM = re.compile(rf"(?:^|[(;]) ?NEST (?P<file>.*?) ?SHA256 (?P<sha>[0-9a-f]{{{SHA_DIGITS}}})", re.IGNORECASE)
_SAMPLES = 16
_BESIDE_MM = 3.0
"""How far beside a contour a path may run that cuts it, besides the kerf."""


def other_nest_named(comments: Iterable[str], nest: Nest) -> str:
    """That comments of a program name another nest than this one; "" where they do not."""
    for found in filter(None, map(_MADE_FROM.search, comments)):
        sha = found["sha"].lower()
        if nest.sha256 and sha != nest.sha256[:SHA_DIGITS]:
            return (
                f"the program was made from another nest: it names {found['file'] or 'one'} with sha256 {sha}, that "
                f"of {nest.file} begins {nest.sha256[:SHA_DIGITS]}"
            )
    return ""


def cuts_elsewhere(program: NcProgram, nest: Nest, kerf_mm: float, file: str = "") -> int:
    """How many cuts of a program run along no contour of the nest; holes that are only pierced are no cuts.

    Raises InputError if most do, or the program says itself that it was made from another nest.
    """
    if named := other_nest_named(program.comments, nest):
        raise InputError(f"{named}; give the nest it was made from", file=file or None)
    if not nest.contours:
        return len(program.burns)
    if not program.burns:
        raise InputError("the program cuts nothing: the torch is never on", file=file or None)
    burns = [burn for burn in program.burns if not burn.pierces_only] or program.burns
    burns = [burn for burn in burns if not burn.tilted]  # what bevels these are of the check finds at their roots
    if not burns:
        return 0
    along = along_contours(burns, nest, kerf_mm)
    count, of_it = len(along), int(along.sum())
    if of_it < count / 2:
        share = f"only {of_it}" if of_it else "none"
        raise InputError(
            f"{share} of the {count} cuts of the program run along contours of {nest.file or 'the nest'}: is it the "
            "nest of this program?",
            file=file or None,
        )
    return count - of_it


def along_contours(burns: Sequence[Burn], nest: Nest, kerf_mm: float) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Of each burn, whether at least half of it runs beside contours of the nest."""
    paths = [burn.path.flatten(_BESIDE_MM / 10) for burn in burns]
    lines = [shapely.LineString(path if len(path) > 1 else np.repeat(path, 2, axis=0)) for path in paths]
    shares = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    points = shapely.line_interpolate_point(np.repeat(lines, _SAMPLES), np.tile(shares, len(lines)), normalized=True)
    tree = shapely.STRtree([contour.line for contour in nest.contours])
    near, _ = tree.query(points, predicate="dwithin", distance=kerf_mm + _BESIDE_MM)
    beside = np.zeros(len(points), dtype=np.bool_)
    beside[near] = True
    return np.asarray(beside.reshape(-1, _SAMPLES).mean(axis=1) >= 0.5)
