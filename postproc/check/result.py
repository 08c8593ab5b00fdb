"""What a check finds: a judgement on every rule, what is excused or relaxed, and all of it as text."""

from __future__ import annotations

import re
import unicodedata
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Literal

import numpy as np

from kerfwise.encoder.cut import Cut, CutSequence, Pierce
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.graphs import path
from kerfwise.encoder.nest import Ids, Nest
from kerfwise.rules.judging.violation import Violation
from kerfwise.rules.plan_state import How, Place, PlanState
from kerfwise.rules.profile.active_rules import ActiveRules
from kerfwise.rules.rule import Strength, name_in_programs

MOST = 20
MOST_SOFT = 3


@dataclass(frozen=True, slots=True)
class Measured:
    """The check's own count: paths with the torch (or the marking tool) on, their length, and idle travel, mm."""

    paths: int
    on_mm: float
    idle_mm: float


@dataclass(frozen=True, slots=True)
class CheckResult:
    """The judgements, those on the program itself first, then the profile's rules; warnings fail nothing.

    `by_rules` are the cuts of a plan with what the rules say of them, for the check of its program. `relaxed` is what
    plan or program say is relaxed.
    """

    rules: tuple[Judgement, ...]
    warnings: tuple[str, ...]
    measured: Measured
    by_rules: JudgedCuts | None = field(default=None, compare=False, repr=False)
    relaxed: tuple[RelaxedStatement, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether every hard rule holds, but for what is excused, relaxed or dropped: see `state`."""
        return all(j.holds for j in self.rules if j.strength == "hard")

    @property
    def state(self) -> PlanState:
        """Whether every hard rule holds without exception, but for some places, or not: `kind`, `places`, `words()`."""
        hard = [judgement for judgement in self.rules if judgement.strength == "hard"]
        places = [place for judgement in hard for place in _not_kept(judgement)]
        rules = {place.rule for place in places}  # a statement that is relaxed is told, whatever the rule finds there
        places += [Place("relaxed", s.rule, s.contours, WHY) for s in self.relaxed if s.rule not in rules]
        return PlanState.of(places)

    def rule(self, rule_id: str) -> Judgement:
        """The judgement on one rule (KeyError if there is none)."""
        return {j.id: j for j in self.rules}[rule_id]

    def broken(self) -> tuple[str, ...]:
        """Ids of the hard rules that are broken, or cannot be judged and have to be."""
        return tuple(j.id for j in self.rules if j.strength == "hard" and not j.holds)

    def __str__(self) -> str:
        return report(self)


def report(result: CheckResult, most: int = MOST) -> str:
    """Every rule a line, what breaks it below; the last line says how it ends.

    At most `most` sentences a rule are told, and at most `MOST_SOFT` where the rule is soft and breaking it but costs.
    """
    width = max((len(j.id) for j in result.rules), default=0)
    lines = [line for judgement in result.rules for line in _lines(judgement, width, most)]
    lines += [f"warning: {escape_text(text)}" for text in result.warnings[:most]]
    if len(result.warnings) > most:
        lines.append(f"... and {len(result.warnings) - most} more warnings")
    measured = result.measured
    paths = f"{measured.paths} path" + ("s" if measured.paths != 1 else "")
    lines.append(f"measured: {paths}, {measured.on_mm:.1f} mm torch on, {measured.idle_mm:.1f} mm idle")
    lines.append(escape_text(result.state.words()) if result.ok else f"FAILED: {_failed(result)}")
    return "\n".join(lines)


def _not_kept(judgement: Judgement) -> Iterator[Place]:
    """Where a hard rule does not hold."""
    if not judgement.holds:
        yield from (Place("broken", judgement.id, v.contours, v.text) for v in judgement.violations)
        if not judgement.violations:
            yield Place("broken", judgement.id, (), judgement.unjudged or "")
    for excused in judgement.excused:
        yield Place(excused.how, judgement.id, excused.violation.contours, excused.why)


def _failed(result: CheckResult) -> str:
    """The hard rules that fail, in words: those that are broken, and those that could not be judged."""
    failed = [result.rule(name) for name in result.broken()]
    broken = [judgement.id for judgement in failed if judgement.violations]
    unknown = [judgement.id for judgement in failed if not judgement.violations]
    texts = [f"{len(broken)} hard rules broken: {', '.join(broken)}"] if broken else []
    texts += [f"{len(unknown)} hard rules cannot be judged: {', '.join(unknown)}"] if unknown else []
    return "; ".join(texts)


def _lines(judgement: Judgement, width: int, most: int) -> Iterator[str]:
    yield f"{judgement.verdict:<10} {judgement.strength:<4} {judgement.id:<{width}}  {escape_text(judgement.sentence)}"
    if judgement.unjudged is not None:
        yield f"    {escape_text(judgement.unjudged)}"
    shown = most if judgement.strength == "hard" else min(most, MOST_SOFT)
    for violation in judgement.violations[:shown]:
        yield f"    {escape_text(violation.text)}"
    if len(judgement.violations) > shown:
        yield f"    ... and {len(judgement.violations) - shown} more"
    for excused in judgement.excused[:most]:
        yield f"    {excused.how}: {escape_text(excused.violation.text)} ({escape_text(excused.why)})"
    if len(judgement.excused) > most:
        yield f"    ... and {len(judgement.excused) - most} more excused"


# What a check says of one rule.

Verdict = Literal["holds", "broken", "excused", "not judged", "off"]


@dataclass(frozen=True, slots=True)
class Excused:
    """A violation that may stand, and why: the rule excuses it, a planner has relaxed it, or orders contradict it."""

    violation: Violation
    why: str
    how: How = "excused"


@dataclass(frozen=True, slots=True)
class Judgement:
    """One rule against one plan or program; one that is off is not judged at all.

    `unjudged` says why nothing can be said, where that is so. A rule that `must_be_judged` does not hold then.
    """

    id: str
    strength: Strength
    sentence: str
    violations: tuple[Violation, ...] = ()
    excused: tuple[Excused, ...] = ()
    unjudged: str | None = None
    must_be_judged: bool = False

    @property
    def holds(self) -> bool:
        """Whether nothing breaks the rule but what is excused, as far as it has to be known."""
        return not self.violations and not (self.must_be_judged and self.unjudged is not None)

    @property
    def verdict(self) -> Verdict:
        """The judgement in a word or two."""
        if self.strength == "off":
            return "off"
        if self.violations:
            return "broken"
        if self.unjudged is not None:
            return "not judged"
        return "excused" if self.excused else "holds"


# Cuts that were judged already: a program is written from a plan, and the rules say of both the same.

SAME = 1e-3
"""Millimetres and seconds that two cuts may differ by and be the same: what a program's decimals make of a plan's."""

DRIFT = 1e-7
"""Share of a time that it may be off besides: what the same decimals add up to over thousands of cuts."""

MIDWAY_MM = 3e-3
"""The same of the middle of a lead's arc: programs have a line for an arc that rises less."""


@dataclass(frozen=True, eq=False, slots=True)
class JudgedCuts:
    """The judgements of a profile's rules on cuts, and by what they were judged."""

    nest: Nest
    cuts: CutSequence
    profile: ActiveRules
    relaxed: tuple[RelaxedStatement, ...]
    rules: tuple[Judgement, ...]

    def known(
        self, nest: Nest, cuts: CutSequence, profile: ActiveRules, relaxed: Sequence[RelaxedStatement]
    ) -> tuple[Judgement, ...] | None:
        """The judgements on other cuts, where these are the same; None where they are not, or were measured hot."""
        alike = nest is self.nest and profile == self.profile and tuple(relaxed) == self.relaxed
        return self.rules if alike and same(self.cuts, cuts) else None


def same(one: CutSequence, other: CutSequence) -> bool:
    """Whether two sequences say the same of every cut, rounding aside, and nobody has measured temperatures."""
    measured = (one.hot_spots, other.hot_spots) != (None, None)
    if measured or one.begun or other.begun or (one.start_side, one.made) != (other.start_side, other.made):
        return False
    if len(one) != len(other) or not _near(one.home, other.home) or len(one.pierces) != len(other.pierces):
        return False
    cuts_alike = all(map(_same_cut, one, other)) and _same_times(one, other)
    return cuts_alike and all(map(_same_hole, one.pierces, other.pierces))


def _same_hole(one: Pierce, other: Pierce) -> bool:
    return (one.contour, one.before) == (other.contour, other.before) and _near(one.at, other.at)


def _same_times(one: CutSequence, other: CutSequence) -> bool:
    """Whether each cut takes as long, as long after the one before, and both get to it at the same time."""
    times = np.array([[(cut.start_s, cut.end_s) for cut in cuts] for cuts in (one, other)]).reshape(2, -1)
    off_s = np.abs(np.diff(times, axis=0))
    steps_off_s = np.abs(np.diff(np.diff(times, axis=1), axis=0))
    return bool((off_s <= SAME + DRIFT * np.abs(times[0])).all() and (steps_off_s <= SAME).all())


def _same_cut(one: Cut, other: Cut) -> bool:
    return (
        _words(one) == _words(other)
        and _near(_numbers(one), _numbers(other))
        and _same_lead(one.lead_in, other.lead_in)
        and _same_lead(one.lead_out, other.lead_out)
    )


def _words(cut: Cut) -> tuple[object, ...]:
    return (
        cut.contour, cut.direction, cut.zone, cut.excused, cut.linked, cut.span, cut.tabs, cut.torch, cut.together,
        cut.way,
    )  # fmt: skip


def _numbers(cut: Cut) -> list[float]:
    return [*cut.entry, *cut.pierce]


def _same_lead(one: Curve | None, other: Curve | None) -> bool:
    """Two leads by their ends and by how far their arcs stand off; one that goes nowhere is none."""
    first, second = _stretches(one), _stretches(other)
    return len(first) == len(second) and all(
        _near(a[:4], b[:4]) and _near(a[4:], b[4:], MIDWAY_MM) for a, b in zip(first, second, strict=True)
    )


def _stretches(lead: Curve | None) -> list[list[float]]:
    """Ends of every line or arc of a lead, and the point of it that is midway."""
    if lead is None:
        return []
    return [
        [ax, ay, bx, by, (ax + bx + bulge * (by - ay)) / 2, (ay + by - bulge * (bx - ax)) / 2]
        for (ax, ay, bulge), (bx, by, _) in pairwise(lead.vertices.tolist())
        if abs(bx - ax) + abs(by - ay) > SAME
    ]


def _near(one: Sequence[float], other: Sequence[float], by: float = SAME) -> bool:
    return all(abs(a - b) <= by for a, b in zip(one, other, strict=True))


# Statements that are relaxed because the hard rules cannot all hold: what they excuse, and nothing else.
#
# A plan lists them among what it has dropped, a program in comments such as `RELAXED 2 level-ahead P1.outer
# P2.outer`; where one comment has no room for all contours the next goes on with the same number.

WHY = "relaxed: the hard rules cannot all hold"
_RELAXED = re.compile(r"RELAXED (?P<number>\d+) (?P<rule>\S+)(?: (?P<contours>.+))?", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class RelaxedStatement:
    """One statement that is relaxed: the rule it comes from and the contours it is about."""

    rule: str
    contours: tuple[str, ...]


def read_relaxed(nest: Nest, comments: Iterable[str], rules: Iterable[str]) -> tuple[RelaxedStatement, ...]:
    """What the comments of a program say is relaxed; contours that the nest does not have are left out.

    `rules` are those that there are: what a comment cannot hold of a plant's own name, such as a space, is replaced.
    """
    comments = tuple(comments)
    ids = ids_by_name(nest, comments)
    written = {(normalize_name(_unaccented(name)), rule) for rule in rules for name in (rule, name_in_programs(rule))}
    counts = Counter(name for name, _ in written)
    named = {name: rule for name, rule in written if counts[name] == 1}
    found: dict[tuple[int, str], list[str]] = {}
    for words in filter(None, map(_RELAXED.fullmatch, comments)):
        names = (ids.get(normalize_name(name)) for name in (words["contours"] or "").split())
        rule = named.get(normalize_name(words["rule"]), words["rule"].lower())
        found.setdefault((int(words["number"]), rule), []).extend(n for n in names if n)
    return tuple(RelaxedStatement(rule, tuple(names)) for (_, rule), names in found.items())


def excuse_relaxed(
    nest: Nest,
    cuts: CutSequence,
    profile: ActiveRules,
    judged: Sequence[Judgement],
    relaxed: Sequence[RelaxedStatement],
) -> list[Judgement]:
    """The judgements, with violations of hard rules excused where a relaxed statement is all that asked for more.

    Nobody can relax what a rule promises of metal, whatever a plan or a program says.
    """
    book = profile.rulebook()
    of_rule: dict[str, list[tuple[str, ...]]] = {}
    for statement in relaxed:
        if statement.rule in book and book[statement.rule].may_be_relaxed:
            of_rule.setdefault(statement.rule, []).append(statement.contours)
    return [
        _excuse_relaxed(nest, cuts, profile, judgement, of_rule[judgement.id])
        if judgement.strength == "hard" and judgement.violations and judgement.id in of_rule
        else judgement
        for judgement in judged
    ]


def _excuse_relaxed(
    nest: Nest, cuts: CutSequence, profile: ActiveRules, judgement: Judgement, statements: Sequence[tuple[str, ...]]
) -> Judgement:
    rule, options = profile.rulebook()[judgement.id], profile.settings()[judgement.id].options
    orders = rule.pairs(nest, cuts, options)
    runs = [set(run) for run in rule.together(nest, options)]
    excused = {
        k: Excused(v, why, "relaxed")
        for k, v in enumerate(judgement.violations)
        if (why := _why(v, statements, orders, runs))
    }
    broken = [set(violation.contours) for violation in judgement.violations]
    open_for = [set(contours) for contours in statements if set(contours) not in broken]
    for k, violation in enumerate(judgement.violations) if judgement.id in profile.rule_files() else ():
        about = next((one for one in open_for if k not in excused and broken[k] < one), None)
        if about is not None:  # of a sum over ways to cut the check names those alone that the cuts have
            open_for.remove(about)
            excused[k] = Excused(violation, WHY, "relaxed")
    return replace(
        judgement,
        violations=tuple(v for k, v in enumerate(judgement.violations) if k not in excused),
        excused=(*judgement.excused, *excused.values()),
    )


def _why(
    violation: Violation, statements: Sequence[tuple[str, ...]], orders: Sequence[Ids], runs: Sequence[set[str]]
) -> str | None:
    """Why a violation may stand, if a relaxed statement is about its contours, or held them in this order."""
    named = set(violation.contours)
    for contours in statements:
        if set(contours) in (named, set(violation.asked)):
            return WHY
        if set(contours) in runs and named - set(contours) and len(named & set(contours)) > 1:
            return WHY
    gone = {frozenset(contours) for contours in statements}
    if len(named) == 1:  # such as the first of all: nothing but relaxed orders may have moved it
        moved = violation.orders
        return WHY if moved and all(frozenset(pair) in gone for pair in moved) else None
    return WHY if _is_order_relaxed(violation.contours, orders, gone) else None


def _is_order_relaxed(contours: tuple[str, ...], orders: Sequence[Ids], gone: set[frozenset[str]]) -> bool:
    """For two contours that the rule orders by way of others: whether the relaxed orders break every such way."""
    if len(contours) != 2 or not any(name in pair for name in contours for pair in gone):
        return False
    number: dict[str, int] = {}
    for pair in (contours, *orders):
        for name in pair:
            number.setdefault(name, len(number))
    links = [(number[a], number[b]) for a, b in orders]
    left = [k for k, pair in enumerate(orders) if frozenset(pair) not in gone]
    one, other = number[contours[0]], number[contours[1]]
    implied = path(links, range(len(links)), one, other) is not None
    return implied and path(links, left, one, other) is None


def relaxed_warnings(relaxed: Sequence[RelaxedStatement]) -> Iterator[str]:
    """A line for every statement that is relaxed: a check never passes over them in silence."""
    for statement in relaxed:
        yield f"relaxed: {statement.rule} about {', '.join(statement.contours) or 'the whole sheet'}"


# Names of contours as they survive in a program's comments.

_NAME = re.compile(r"NAME (?P<number>\d{1,9}) (?P<told>\S+) IS (?P<spelt>(?:[A-Za-z0-9.-]|=[0-9A-F]{2})*)")


def _unaccented(text: str) -> str:
    return "".join(c for c in unicodedata.normalize("NFKD", text) if not unicodedata.combining(c))


def normalize_name(name: str) -> str:
    """A contour's id without what a writer replaces: everything but letters, digits and dots.

    Examples
    --------
    >>> normalize_name("Plate (2)-a.hole1")
    'PLATE_2_A.HOLE1'
    """
    return re.sub(r"[^A-Za-z0-9.]+", "_", name).upper()


def ids_by_name(nest: Nest, comments: Iterable[str]) -> Mapping[str, str]:
    """Folded name → contour id: those that the program's comments map (`NAME 1 P-1.outer IS =D0=9F.outer`), and ids.

    A name that two ids fold to is left out: which of them it means nobody can say.
    """
    found: dict[str, str] = {}
    twice: set[str] = set()
    for contour in nest.contours:
        key = normalize_name(contour.id)
        if key in found:
            twice.add(key)
        found[key] = contour.id
    spelt: dict[tuple[int, str], str] = {}
    for words in filter(None, map(_NAME.fullmatch, comments)):
        mapped = (int(words["number"]), words["told"])
        spelt[mapped] = spelt.get(mapped, "") + words["spelt"]
    known = {contour.id for contour in nest.contours}
    kept = {key: name for key, name in found.items() if key not in twice}
    for (_, told), text in spelt.items():
        if (name := _unspelt(text)) in known:
            kept[normalize_name(told)] = name
    return kept


def _unspelt(text: str) -> str:
    data = re.sub(rb"=([0-9A-F]{2})", lambda found: bytes([int(found[1], 16)]), text.encode())
    return data.decode("utf-8", "replace") if b"\xed" not in data else data.decode("utf-8", "surrogatepass")
