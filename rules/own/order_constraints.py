"""Own rules about the order: before, after, first, last, together, apart, one_stays_while."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import shapely
import yaml

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.text import unknown
from kerfwise.rules.options.kind import Number, Unfit
from kerfwise.rules.options.option import option, options_of
from kerfwise.rules.options.quantities import DURATION, LENGTH
from kerfwise.rules.options.yaml_positions import Problems, entries
from kerfwise.rules.statements import AtLeast, Before, Contiguous, Lag, NoGood, Precede

from .constraint import Breach, Chosen, Constraint, read_true
from .criteria import ROUNDING_MM
from .selector import Selector, read_selector

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts


@dataclass(frozen=True, slots=True)
class OrderConstraint(Constraint):
    """`key` is one of `KEYS`; `other` whom the selected come before or after, None for first and last."""

    KEYS = {  # noqa: RUF012
        "before": "every selected contour is cut before every contour of this selector",
        "after": "every selected contour is cut after every contour of this selector",
        "first": "true: the selected contours are cut before all others",
        "last": "true: the selected contours are cut after all others",
    }

    key: str
    other: Selector | None = None

    @classmethod
    def read(cls, key: str, node: yaml.Node, problems: Problems, what: str) -> OrderConstraint:
        if key in ("before", "after"):
            return OrderConstraint(key, read_selector(node, problems, what))
        read_true(node, problems, what)
        return OrderConstraint(key)

    @classmethod
    def schema(cls, key: str) -> dict[str, Any]:
        return {"$ref": "#/$defs/selector"} if key in ("before", "after") else {"const": True}

    def plain(self) -> tuple[str, object]:
        return self.key, self.other.plain() if self.other else True

    def selectors(self) -> tuple[Selector, ...]:
        return (self.other,) if self.other else ()

    def pairs(self, chosen: Chosen) -> list[tuple[int, int]]:
        others = set(self.other.chosen(chosen.known)) if self.other else None
        sides = []
        for selected, members in chosen.groups:
            inside = set(selected)
            rest = [k for k in members if (k not in inside if others is None else k in others)]
            sides.append((selected, rest) if self.key in ("before", "first") else (rest, selected))
        chosen.check_size(sum(len(first) * len(then) for first, then in sides))
        return [(a, b) for first, then in sides for a in first for b in then if a != b]

    def statements(self, facts: Facts, chosen: Chosen) -> Iterator[Precede]:
        for a, b in self.pairs(chosen):
            first, then = chosen.ids(a, b)
            yield Precede(a, b, chosen.about((a, b), f"{first} is cut before {then}"))

    def broken(self, cuts: CutSequence, chosen: Chosen) -> Iterator[Breach]:
        at = cuts.positions()
        for a, b in self.pairs(chosen):
            first, then = chosen.ids(a, b)
            if first in at and then in at and at[first] > at[then]:
                text = f"{first} (cut {at[first]}) must be cut before {then} (cut {at[then]})"
                yield (first, then), text, (at[then], at[first])


# Own rules that keep contours together: together.


@dataclass(frozen=True, slots=True)
class Together(Constraint):
    """The selected contours of each group make one run of cuts."""

    KEYS = {"together": "true: the selected contours follow each other without another between"}  # noqa: RUF012

    @classmethod
    def read(cls, key: str, node: yaml.Node, problems: Problems, what: str) -> Together:
        read_true(node, problems, what)
        return Together()

    @classmethod
    def schema(cls, key: str) -> dict[str, Any]:
        return {"const": True}

    def plain(self) -> tuple[str, object]:
        return "together", True

    def together(self, chosen: Chosen) -> list[tuple[int, ...]]:
        return [selected for selected, _ in chosen.groups if len(selected) > 1]

    def statements(self, facts: Facts, chosen: Chosen) -> Iterator[Contiguous]:
        for run in self.together(chosen):
            ids = chosen.ids(*run)
            listed = ", ".join(ids) if len(ids) <= 6 else f"{ids[0]} … {ids[-1]}"
            yield Contiguous(run, chosen.about(run, f"{listed} follow each other"))

    def broken(self, cuts: CutSequence, chosen: Chosen) -> Iterator[Breach]:
        at = cuts.positions()
        for run in self.together(chosen):
            places = sorted(at[name] for name in chosen.ids(*run) if at.get(name, 0) > cuts.made)
            for a, b in pairwise(places):
                if b == a + 1:
                    continue
                before, stranger, after = (cuts[k - 1].contour for k in (a, a + 1, b))
                text = f"{stranger} (cut {a + 1}) comes between {before} (cut {a}) and {after} (cut {b})"
                yield (before, stranger, after), text, (a, a + 1, b)
                break


# Own rules about how a sheet, a part, a zone begins and ends: not_first, not_last.


@dataclass(frozen=True, slots=True)
class Ends(Constraint):
    """`key` says which end. Where a group holds only selected contours nothing can be asked of it."""

    KEYS = {  # noqa: RUF012
        "not_first": "true: cutting does not begin with a selected contour",
        "not_last": "true: cutting does not end with a selected contour",
    }

    key: str

    @classmethod
    def read(cls, key: str, node: yaml.Node, problems: Problems, what: str) -> Ends:
        read_true(node, problems, what)
        return Ends(key)

    @classmethod
    def schema(cls, key: str) -> dict[str, Any]:
        return {"const": True}

    def plain(self) -> tuple[str, object]:
        return self.key, True

    def statements(self, facts: Facts, chosen: Chosen) -> Iterator[AtLeast]:
        chosen.check_size(sum(len(selected) * (len(group) - len(selected)) for selected, group in chosen.groups))
        for selected, rest in _asked(chosen):
            for k in selected:
                (name,) = chosen.ids(k)
                if self.key == "not_last":
                    literals, what = tuple(Before(k, other) for other in rest), "not the last to be cut"
                else:
                    literals, what = tuple(Before(other, k) for other in rest), "not the first to be cut"
                yield AtLeast(literals, (1,) * len(rest), 1, chosen.about((k,), f"{name} is {what}"))

    def broken(self, cuts: CutSequence, chosen: Chosen) -> Iterator[Breach]:
        at = cuts.positions()
        for selected, rest in _asked(chosen):
            places = {at[name]: name for name in chosen.ids(*selected, *rest) if name in at}
            if not places:
                continue
            if self.key == "not_last" and all(at.get(name, 0) <= cuts.made for name in chosen.ids(*rest)):
                continue  # nothing else is left of the group
            position = max(places) if self.key == "not_last" else min(places)
            name = places[position]
            if name in chosen.ids(*selected):
                end = "the last" if self.key == "not_last" else "the first"
                yield (name,), f"{name} (cut {position}) must not be {end}", (position,)


def _asked(chosen: Chosen) -> Iterator[tuple[tuple[int, ...], tuple[int, ...]]]:
    """Group by group the selected contours and the others, where there are both."""
    for selected, group in chosen.groups:
        inside = set(selected)
        rest = tuple(k for k in group if k not in inside)
        if selected and rest:
            yield selected, rest


# Own rules that leave one contour in to hold the others: one_stays_while.


@dataclass(frozen=True, slots=True)
class OneStays(Constraint):
    """As long as all of `held` are still in, at least one of the selected is too."""

    KEYS = {"one_stays_while": "one of the selected is left in as long as all of this selector are in"}  # noqa: RUF012

    MINDS_WHAT_IS_OUT = True

    held: Selector

    @classmethod
    def read(cls, key: str, node: yaml.Node, problems: Problems, what: str) -> OneStays:
        return OneStays(read_selector(node, problems, what))

    @classmethod
    def schema(cls, key: str) -> dict[str, Any]:
        return {"$ref": "#/$defs/selector"}

    def plain(self) -> tuple[str, object]:
        return "one_stays_while", self.held.plain()

    def selectors(self) -> tuple[Selector, ...]:
        return (self.held,)

    def statements(self, facts: Facts, chosen: Chosen) -> Iterator[NoGood]:
        for out, left in self._sets(chosen):
            text = f"{_listed(chosen.ids(*out))} are not all cut while {_listed(chosen.ids(*left))} stay in"
            yield NoGood(frozenset(out), frozenset(left), chosen.about((*out, *left), text))

    def broken(self, cuts: CutSequence, chosen: Chosen) -> Iterator[Breach]:
        at = cuts.positions()
        for out, left in self._sets(chosen):
            out_at = [at.get(name, len(cuts) + 1) for name in chosen.ids(*out)]
            first_left = min(at.get(name, len(cuts) + 1) for name in chosen.ids(*left))
            if max(out_at) < first_left:
                ids = chosen.ids(*out)
                text = f"{_listed(ids)} are all cut (cut {max(out_at)}) while {_listed(chosen.ids(*left))} are still in"
                yield (*ids, *chosen.ids(*left)), text, tuple(sorted(out_at))

    def _sets(self, chosen: Chosen) -> Iterator[tuple[tuple[int, ...], tuple[int, ...]]]:
        held = set(self.held.chosen(chosen.known))
        for selected, group in chosen.groups:
            left = tuple(k for k in group if k in held and k not in selected)
            if selected and left:
                yield selected, left


def _listed(ids: tuple[str, ...]) -> str:
    return ", ".join(ids) if len(ids) <= 6 else f"{ids[0]} … {ids[-1]}"


# Own rules that keep contours apart in time: apart.

FROM = "from"
_CLOCK_S = 0.05


@dataclass(frozen=True, slots=True)
class Apart(Constraint):
    """Between any two of the selected, or a selected and one of `other`, lie some cuts or seconds."""

    KEYS = {"apart": "between two selected contours lie other cuts, or seconds: {cuts, time, within, from}"}  # noqa: RUF012

    cuts: int = field(default=0, metadata=option(Number(0, whole=True), "how many other cuts lie between at least"))
    time_s: float = field(default=0.0, metadata=option(DURATION, "how much time lies between at least"))
    within_mm: float | None = field(
        default=None, metadata=option(LENGTH, "asked only of contours that lie no further apart than this")
    )
    other: Selector | None = None

    @classmethod
    def read(cls, key: str, node: yaml.Node, problems: Problems, what: str) -> Apart:
        options = {o.key: o for o in options_of(cls)}
        values: dict[str, Any] = {}
        so_far = len(problems.found)
        for name, key_node, value in entries(node, problems, what):
            if name == FROM:
                values["other"] = read_selector(value, problems, f"{what}.{FROM}")
            elif name not in options:
                problems.add(key_node, f"{what}: {unknown('key', name, [*options, FROM])}")
            else:
                try:
                    values[options[name].name] = options[name].kind.read(value)
                except Unfit as error:
                    problems.add(value, f"{what}.{name}: {error}")
        if len(problems.found) == so_far and not (values.get("cuts") or values.get("time_s")):
            problems.add(node, f"{what}: say how far apart: cuts, time or both, such as {{cuts: 2}}")
        return Apart(**values)

    @classmethod
    def schema(cls, key: str) -> dict[str, Any]:
        keys = {o.key: {"description": o.help, **o.kind.schema()} for o in options_of(cls)}
        return {
            "type": "object",
            "properties": {**keys, FROM: {"$ref": "#/$defs/selector"}},
            "additionalProperties": False,
            "anyOf": [{"required": ["cuts"]}, {"required": ["time"]}],
        }

    def plain(self) -> tuple[str, object]:
        result: dict[str, object] = {}
        if self.cuts:
            result["cuts"] = self.cuts
        if self.time_s:
            result["time"] = DURATION.write(self.time_s)
        if self.within_mm is not None:
            result["within"] = LENGTH.write(self.within_mm)
        return "apart", result | ({FROM: self.other.plain()} if self.other else {})

    def selectors(self) -> tuple[Selector, ...]:
        return (self.other,) if self.other else ()

    def statements(self, facts: Facts, chosen: Chosen) -> Iterator[Lag]:
        for a, b in self._couples(chosen):
            first, second = chosen.ids(a, b)
            about = chosen.about((a, b), f"between {first} and {second} lie {self._asked()}")
            yield Lag(a, b, about, self.cuts, self.time_s)

    def broken(self, cuts: CutSequence, chosen: Chosen) -> Iterator[Breach]:
        at = cuts.positions()
        for couple in self._couples(chosen):
            if any(name not in at for name in chosen.ids(*couple)):
                continue
            first, then = sorted(chosen.ids(*couple), key=at.__getitem__)
            between = at[then] - at[first] - 1
            waited_s = cuts[at[then] - 1].start_s - cuts[at[first] - 1].end_s
            if between >= self.cuts and waited_s >= self.time_s - _CLOCK_S:
                continue
            seconds = f" and {waited_s:.1f} s" if self.time_s else ""
            text = (
                f"between {first} (cut {at[first]}) and {then} (cut {at[then]}) lie {between} cuts{seconds}, "
                f"not {self._asked()}"
            )
            yield (first, then), text, (at[first], at[then])

    def unjudged(self, cuts: CutSequence) -> str | None:
        if self.time_s and not any(cut.end_s for cut in cuts):
            return "the times of the cuts are not stated"
        return None

    def _asked(self) -> str:
        parts = [f"{self.cuts} cuts"] * bool(self.cuts) + [f"{self.time_s:g} s"] * bool(self.time_s)
        return f"at least {' and '.join(parts)}"

    def _couples(self, chosen: Chosen) -> list[tuple[int, int]]:
        """Each pair of contours once, by number."""
        others = set(self.other.chosen(chosen.known)) if self.other else None
        lines = [c.line for c in chosen.nest.contours]
        found: set[tuple[int, int]] = set()
        for selected, group in chosen.groups:
            partners = selected if others is None else tuple(k for k in group if k in others)
            if self.within_mm is None:
                chosen.check_size(len(selected) * len(partners))
                near = [(a, b) for a in selected for b in partners]
            else:
                tree = shapely.STRtree([lines[k] for k in partners])
                reach = self.within_mm + ROUNDING_MM
                hits = tree.query([lines[k] for k in selected], predicate="dwithin", distance=reach)
                near = [(selected[a], partners[b]) for a, b in hits.T.tolist()]
            found.update((min(a, b), max(a, b)) for a, b in near if a != b)
        chosen.check_size(len(found))
        return sorted(found)


# Own rules about when a contour is out: within_time.

_MS = 1000
_SHARE = re.compile(r"\s*([0-9.]+)\s*%\s*")


@dataclass(frozen=True, slots=True)
class WithinTime(Constraint):
    """Every selected contour is out within a share of the cutting time of all, or within so many seconds of it.

    Counted is what cuts take by themselves, without leads and travel: see the fact `cut_s`.
    """

    KEYS = {  # noqa: RUF012
        "within_time": "every selected contour is out within a share of the cutting time, such as 40 %, or 5 min of it"
    }

    share: float | None = None
    time_s: float = 0.0

    @classmethod
    def read(cls, key: str, node: yaml.Node, problems: Problems, what: str) -> WithinTime:
        text = str(node.value) if isinstance(node, yaml.ScalarNode) else ""
        if (found := _SHARE.fullmatch(text)) and 0 < float(found[1]) <= 100:
            return WithinTime(share=float(found[1]) / 100)
        try:
            seconds = DURATION.read(node)
            if seconds > 0:
                return WithinTime(time_s=seconds)
        except (Unfit, ValueError):
            pass
        problems.add(node, f"{what}: expected a share such as 40 %, or a time such as 5 min, got {text!r}")
        return WithinTime(share=1.0)

    @classmethod
    def schema(cls, key: str) -> dict[str, Any]:
        return {"anyOf": [{"type": "string", "pattern": r"^\s*[0-9.]+\s*%\s*$"}, DURATION.schema()]}

    def plain(self) -> tuple[str, object]:
        return "within_time", DURATION.write(self.time_s) if self.share is None else f"{100 * self.share:.10g} %"

    def statements(self, facts: Facts, chosen: Chosen) -> Iterator[AtLeast]:
        if facts.already_cut:
            return  # what was cut before took time that nobody knows
        taken = _milliseconds(chosen)
        after = sum(taken) - self._most(taken)
        chosen.check_size(sum(len(selected) for selected, _ in chosen.groups))
        for k in _members(chosen):
            others = tuple(i for i in range(len(taken)) if i != k)
            (name,) = chosen.ids(k)
            about = chosen.about((k,), f"{name} is out within {self._said()}")
            yield AtLeast(tuple(Before(k, i) for i in others), tuple(taken[i] for i in others), after, about)

    def broken(self, cuts: CutSequence, chosen: Chosen) -> Iterator[Breach]:
        taken, index = _milliseconds(chosen), chosen.nest.index
        most, spent = self._most(taken), 0
        contours = {chosen.ids(k)[0] for k in _members(chosen)}
        for position, one in enumerate(cuts, 1):
            spent += taken[index[one.contour]] if one.contour in index else 0
            if one.contour in contours and spent > most:
                text = f"{one.contour} (cut {position}) is out after {spent / _MS:.1f} s of cutting, not {self._said()}"
                yield (one.contour,), text, (position,)

    def unjudged(self, cuts: CutSequence) -> str | None:
        return "what was cut before a stop took time that nobody knows" if cuts.made else None

    def _most(self, taken: Sequence[int]) -> int:
        return round(self.time_s * _MS) if self.share is None else int(self.share * sum(taken))

    def _said(self) -> str:
        return f"{self.time_s:g} s" if self.share is None else f"{100 * self.share:.3g} % of the cutting time"


def _milliseconds(chosen: Chosen) -> list[int]:
    """What each contour takes, whole milliseconds: plan and check count alike."""
    return [round(seconds * _MS) for seconds in chosen.known.values("cut_s")]


def _members(chosen: Chosen) -> list[int]:
    return [k for selected, _ in chosen.groups for k in selected]
