"""What an own rule can ask of the contours it selects: each demand as conditions over the order and the ways to cut."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any, ClassVar

import shapely
import yaml

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.display import first_and_last
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nearest_name import unknown
from kerfwise.encoder.nest import Nest
from kerfwise.rules.expression.node import Apart, Condition, Gate, Lit, NotNext, Run, Stays, ahead
from kerfwise.rules.options.kind import Choice, Number, Text, Unfit
from kerfwise.rules.options.quantities import DURATION, LENGTH
from kerfwise.rules.options.yaml_positions import Problems
from kerfwise.rules.statements import Pick

from .criteria import FREE, LENGTHS, ROUNDING_MM, TRUE, Form, Group, NumberSpan, Scalar, number_of
from .known_nest import ATTRIBUTE, NAMED_FACTS, KnownNest, named_fact
from .selector import SELECTOR, Selector

Forms = Mapping[str, tuple[Form, str]]
"""Key → the form of its value, and a line of help."""
MOST = 250_000
"""Own rules that come to more single statements than this on one nest are refused; they would outgrow any solver."""


@dataclass(frozen=True, eq=False, slots=True)
class Chosen:
    """Which contours of a nest a rule is about: its id, and group by group (selected, all of the group)."""

    rule: str
    known: KnownNest
    groups: tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]

    @property
    def nest(self) -> Nest:
        """The nest that contours are numbered in."""
        return self.known.nest

    @property
    def selected(self) -> list[int]:
        """The selected contours of all groups."""
        return [k for selected, _ in self.groups for k in selected]

    def ids(self, *contours: int) -> tuple[str, ...]:
        """Ids of contours by number."""
        return tuple(self.nest.contours[k].id for k in contours)

    def check_size(self, count: int) -> None:
        """Refuse a rule that comes to more than `MOST` statements."""
        if count > MOST:
            raise InputError(
                f"{self.rule} comes to {count:,} statements on this nest, at most {MOST:,} are taken; select fewer "
                "contours or narrow its scope"
            )


@dataclass(frozen=True, slots=True)
class Demand(ABC):
    """One kind of demand: the key that it stands under, and the value; `FORMS` are its keys, their forms and help.

    `MINDS_WHAT_IS_OUT` is that of a rule, see there.
    """

    FORMS: ClassVar[Forms]
    MINDS_WHAT_IS_OUT: ClassVar[bool] = False

    key: str
    value: Any = True

    @abstractmethod
    def conditions(self, chosen: Chosen) -> Iterator[Condition]:
        """What it asks, over facts of either source."""

    def wrong(self) -> str | None:
        """What is wrong with the value as a whole, though each part can be read; from the end of its key on."""
        return None

    def selectors(self) -> tuple[Selector, ...]:
        """The further selectors it has."""
        members = self.value if isinstance(self.value, tuple) else (("", self.value),)
        return tuple(one for _, one in members if isinstance(one, Selector))

    def facts(self) -> set[str]:
        """Names of the facts that it looks at, beside those of its selectors."""
        return set()

    def pairs(self, chosen: Chosen) -> list[tuple[int, int]]:
        """Contour numbers (before, after) that it orders."""
        return []

    def together(self, chosen: Chosen) -> list[tuple[int, ...]]:
        """Sets of contour numbers that it keeps free of others."""
        return []

    def unjudged(self, cuts: CutSequence) -> str | None:
        """Why it cannot be judged on these cuts, where that is so."""
        return None


class Order(Demand):
    """Whom the selected come before or after: those of a selector, or all others."""

    FORMS: ClassVar[Forms] = {
        "before": (SELECTOR, "every selected contour is cut before every contour of this selector"),
        "after": (SELECTOR, "every selected contour is cut after every contour of this selector"),
        "first": (TRUE, "true: the selected contours are cut before all others"),
        "last": (TRUE, "true: the selected contours are cut after all others"),
    }

    def pairs(self, chosen: Chosen) -> list[tuple[int, int]]:
        others = set(self.value.chosen(chosen.known)) if isinstance(self.value, Selector) else None
        sides = []
        for selected, members in chosen.groups:
            inside = set(selected)
            rest = [k for k in members if (k not in inside if others is None else k in others)]
            sides.append((selected, rest) if self.key in ("before", "first") else (rest, selected))
        chosen.check_size(sum(len(first) * len(then) for first, then in sides))
        return [(a, b) for first, then in sides for a in first for b in then if a != b]

    def conditions(self, chosen: Chosen) -> Iterator[Condition]:
        for a, b in self.pairs(chosen):
            first, then = chosen.ids(a, b)
            yield Condition(ahead(a, b), (a, b), f"{first} is cut before {then}")


class Together(Demand):
    """The selected contours of each group make one run of cuts."""

    FORMS: ClassVar[Forms] = {
        "together": (TRUE, "true: the selected contours follow each other without another between")
    }

    def together(self, chosen: Chosen) -> list[tuple[int, ...]]:
        return [selected for selected, _ in chosen.groups if len(selected) > 1]

    def conditions(self, chosen: Chosen) -> Iterator[Condition]:
        for run in self.together(chosen):
            yield Condition(Run(run), run, f"{first_and_last(chosen.ids(*run))} follow each other")


class Ends(Demand):
    """How a group begins or ends. Where it holds only selected contours nothing can be asked of it."""

    FORMS: ClassVar[Forms] = {
        "not_first": (TRUE, "true: cutting does not begin with a selected contour"),
        "not_last": (TRUE, "true: cutting does not end with a selected contour"),
    }

    def conditions(self, chosen: Chosen) -> Iterator[Condition]:
        chosen.check_size(sum(len(selected) * (len(group) - len(selected)) for selected, group in chosen.groups))
        end, last = self.key.removeprefix("not_"), self.key == "not_last"
        for selected, group in chosen.groups:
            rest = [k for k in group if k not in set(selected)]
            for k in selected if rest else ():
                terms = tuple((ahead(k, i) if last else ahead(i, k), 1) for i in rest)
                sentence, wrong = f"{chosen.ids(k)[0]} is not the {end} to be cut", f"must not be the {end}"
                yield Condition(Gate(terms, 1), (k,), sentence, wrong, beside=selected)


class OneStays(Demand):
    """As long as all contours of a selector are still in, at least one of the selected is too."""

    FORMS: ClassVar[Forms] = {
        "one_stays_while": (SELECTOR, "one of the selected is left in as long as all of this selector are in"),
    }
    MINDS_WHAT_IS_OUT = True

    def conditions(self, chosen: Chosen) -> Iterator[Condition]:
        held = set(self.value.chosen(chosen.known))
        for out, group in chosen.groups:
            left = tuple(k for k in group if k in held and k not in out)
            if out and left:
                names, stay = (first_and_last(chosen.ids(*some)) for some in (out, left))
                yield Condition(Stays(out, left), (*out, *left), f"{names} are not all cut while {stay} stay in")


class KeepApart(Demand):
    """Between any two of the selected, or a selected and one of `from`, lie some cuts or seconds."""

    FORM = Group(
        {
            "cuts": (Scalar(Number(0, whole=True)), "how many other cuts lie between at least"),
            "time": (Scalar(DURATION), "how much time lies between at least"),
            "within": (Scalar(LENGTH), "asked only of contours that lie no further apart than this"),
            "from": (SELECTOR, ""),
        },
        any_of=("cuts", "time"),
    )
    FORMS: ClassVar[Forms] = {
        "apart": (FORM, "between two selected contours lie other cuts, or seconds: {cuts, time, within, from}")
    }

    def wrong(self) -> str | None:
        given = dict(self.value)
        asks = given.get("cuts") or given.get("time")
        return None if asks else ": say how far apart: cuts, time or both, such as {cuts: 2}"

    def conditions(self, chosen: Chosen) -> Iterator[Condition]:
        given = dict(self.value)
        for a, b in self._couples(chosen):
            first, second = chosen.ids(a, b)
            asked = Apart(a, b, given.get("cuts", 0), given.get("time", 0.0))
            yield Condition(Lit(asked), (a, b), f"between {first} and {second} lie {asked.words}")

    def unjudged(self, cuts: CutSequence) -> str | None:
        timed = not dict(self.value).get("time") or any(cut.end_s for cut in cuts)
        return None if timed else "the times of the cuts are not stated"

    def _couples(self, chosen: Chosen) -> list[tuple[int, int]]:
        """Each pair of contours once, by number."""
        given = dict(self.value)
        others = set(given["from"].chosen(chosen.known)) if "from" in given else None
        lines = [c.line for c in chosen.nest.contours]
        found: set[tuple[int, int]] = set()
        for selected, group in chosen.groups:
            partners = selected if others is None else tuple(k for k in group if k in others)
            if "within" not in given:
                chosen.check_size(len(selected) * len(partners))
                near = [(a, b) for a in selected for b in partners]
            else:
                tree = shapely.STRtree([lines[k] for k in partners])
                reach = given["within"] + ROUNDING_MM
                hits = tree.query([lines[k] for k in selected], predicate="dwithin", distance=reach)
                near = [(selected[a], partners[b]) for a, b in hits.T.tolist()]
            found.update((min(a, b), max(a, b)) for a, b in near if a != b)
        chosen.check_size(len(found))
        return sorted(found)


DIRECTION = "direction"
"""The one thing beside facts that two cuts can have alike: the way round."""
MOST_SHOWN = 4


class _FactName(Scalar):
    """The name of a fact, or direction."""

    def read(self, node: yaml.Node, problems: Problems, what: str) -> Any:
        name = super().read(node, problems, what)
        if name is None or name == DIRECTION or named_fact(name) is not None:
            return name
        problems.add(node, f"{what}: {unknown('fact', name, [DIRECTION, *NAMED_FACTS, f'{ATTRIBUTE}<name>'])}")
        return None

    def schema(self) -> dict[str, Any]:
        return {"anyOf": [{"enum": [DIRECTION, *NAMED_FACTS]}, {"type": "string", "pattern": r"^attribute\..+"}]}


class NextCut(Demand):
    """What directly follows a selected contour, within each group.

    Of `same` and `differs` both cuts are selected, and the fact is known of both. With `within`, lengths that differ by
    no more are the same. Of `to` and `never` the second may be any contour of the group.
    """

    WAYS = ("same", "differs", "to", "never")
    FORM = Group(
        {
            "same": (_FactName(Text()), "the fact that both have alike, or direction"),
            "differs": (_FactName(Text()), "the fact that the two do not have alike, or direction"),
            "to": (SELECTOR, "what may follow a selected contour: a selector"),
            "never": (SELECTOR, "what may not follow a selected contour: a selector"),
            "within": (Scalar(LENGTH), "lengths that differ by no more are the same"),
        },
        one_of=WAYS,
    )
    FORMS: ClassVar[Forms] = {
        "next": (FORM, "which contour may directly follow a selected one: {same, differs, to, never, within}")
    }

    @property
    def _asked(self) -> tuple[str, Any, float]:
        """The way in which the next cut is told, the fact or selector, and how near is the same."""
        given = dict(self.value)
        way = next(way for way in self.WAYS if way in given)
        return way, given[way], given.get("within", 0.0)

    def wrong(self) -> str | None:
        if not any(way in dict(self.value) for way in self.WAYS):
            return f": say what may follow: one of {', '.join(self.WAYS)}, such as {{same: layer}}"
        _, of, _ = self._asked
        fact = named_fact(of) if isinstance(of, str) else None
        nearly = "within" in dict(self.value) and (fact is None or fact.kind not in (LENGTHS, FREE))
        return ".within: only lengths such as y_mm, and attributes, are nearly the same" if nearly else None

    def facts(self) -> set[str]:
        _, of, _ = self._asked
        return {of} - {DIRECTION} if isinstance(of, str) else set()

    def conditions(self, chosen: Chosen) -> Iterator[Condition]:
        way, of, _ = self._asked
        if of != DIRECTION:
            for leave, reach, words in self._sides(chosen):
                yield Condition(NotNext(leave, reach), tuple(dict.fromkeys((*leave, *reach))), words)
            return
        by: dict[str, set[int]] = defaultdict(set)
        for c, (_, cut) in enumerate(chosen.known.ways):
            by[cut.direction].add(c)
        for selected, _ in chosen.groups:
            for one, other in product(sorted(by), repeat=2):
                if (one == other) != (way == "same"):
                    asked = NotNext(selected, selected, frozenset(by[one]), frozenset(by[other]))
                    yield Condition(asked, selected, f"what is cut {other} does not directly follow what is cut {one}")

    def _sides(self, chosen: Chosen) -> Iterator[tuple[tuple[int, ...], tuple[int, ...], str]]:
        """Contours, those that may not directly follow them, and what may in words."""
        way, of, _ = self._asked
        for selected, group in chosen.groups:
            if isinstance(of, Selector):
                wanted = set(of.chosen(chosen.known))
                reach = tuple(k for k in group if (k in wanted) == (way == "never"))
                if reach:
                    yield selected, reach, self._words(", ".join(chosen.ids(*selected[:MOST_SHOWN])))
                continue
            values = chosen.known.values(of)
            known = [k for k in selected if values[k] is not None]
            alike: dict[object, list[int]] = defaultdict(list)
            for k in known:
                alike[values[k]].append(k)
            for value, members in alike.items():
                near = {k for k in known if self._alike(value, values[k])}
                reach = tuple(k for k in known if (k in near) == (way == "differs"))
                if set(reach) - set(members) or len(members) > len(reach) > 0 or len(reach) > 1:
                    yield tuple(members), reach, self._words(f"{of} {value}")

    def _words(self, leave: str) -> str:
        way, of, within_mm = self._asked
        near = f" to {within_mm:g} mm" if within_mm else ""
        if isinstance(of, str):
            return f"what directly follows {leave} has {'the same' if way == 'same' else 'another'}{near}"
        words = " and ".join(f"{name} {value}" for name, value in of.plain().items()) or "any contour"
        return f"what directly follows {leave} is {'not ' if way == 'never' else ''}of {words}"

    def _alike(self, one: Any, other: Any) -> bool:
        first, second, within_mm = number_of(one), number_of(other), self._asked[2]
        if within_mm and first is not None and second is not None:
            return abs(first - second) <= within_mm + ROUNDING_MM
        return bool(one == other)


_MS = 1000


@dataclass(frozen=True, slots=True)
class Most:
    """A share of the whole, else so many seconds."""

    share: float | None
    seconds: float = 0.0

    def of(self, whole_ms: int) -> int:
        """How many milliseconds that is."""
        return round(self.seconds * _MS) if self.share is None else int(self.share * whole_ms)

    def __str__(self) -> str:
        return f"{self.seconds:g} s" if self.share is None else f"{100 * self.share:.3g} % of the cutting time"


class _ShareOrTime:
    """A share such as 40 %, or a time."""

    def read(self, node: yaml.Node, problems: Problems, what: str) -> Any:
        text = str(node.value) if isinstance(node, yaml.ScalarNode) else ""
        share = re.fullmatch(r"\s*([0-9.]+)\s*%\s*", text)
        try:
            if share and 0 < float(share[1]) <= 100:
                return Most(float(share[1]) / 100)
            if (seconds := DURATION.read(node)) > 0:
                return Most(None, seconds)
        except (Unfit, ValueError):
            pass
        problems.add(node, f"{what}: expected a share such as 40 %, or a time such as 5 min, got {text!r}")
        return None

    def plain(self, value: Most) -> object:
        return DURATION.write(value.seconds) if value.share is None else f"{100 * value.share:.10g} %"

    def schema(self) -> dict[str, Any]:
        return {"anyOf": [{"type": "string", "pattern": r"^\s*[0-9.]+\s*%\s*$"}, DURATION.schema()]}


class WithinTime(Demand):
    """Every selected contour is out within a share of the cutting time of all, or within so many seconds of it.

    Counted is what cuts take by themselves, without leads and travel: see the fact `cut_s`. Plan and check count it in
    whole milliseconds.
    """

    FORMS: ClassVar[Forms] = {
        "within_time": (
            _ShareOrTime(),
            "every selected contour is out within a share of the cutting time, such as 40 %, or 5 min of it",
        )
    }

    def conditions(self, chosen: Chosen) -> Iterator[Condition]:
        if chosen.known.resumed:
            return  # what was cut before took time that nobody knows
        taken = [round(seconds * _MS) for seconds in chosen.known.values("cut_s")]
        whole, most = sum(taken), self.value
        chosen.check_size(len(chosen.selected))

        def wrong(later: int) -> str:
            return f"is out after {(whole - later) / _MS:.1f} s of cutting, not {most}"

        for k in chosen.selected:
            terms = tuple((ahead(k, i), ms) for i, ms in enumerate(taken) if i != k)
            asked = Gate(terms, whole - most.of(whole))
            yield Condition(asked, (k,), f"{chosen.ids(k)[0]} is out within {most}", wrong, uncut_follow=True)

    def unjudged(self, cuts: CutSequence) -> str | None:
        return "what was cut before a stop took time that nobody knows" if cuts.made else None


class Direction(Demand):
    """The selected contours are cut in one direction."""

    FORMS: ClassVar[Forms] = {
        "direction": (
            Scalar(Choice(("cw", "ccw"))),
            "the way round that the selected contours are cut, cw or ccw as seen with y up",
        )
    }

    def conditions(self, chosen: Chosen) -> Iterator[Condition]:
        selected = set(chosen.selected)
        for c, (k, cut) in enumerate(chosen.known.ways):
            if k in selected and cut.direction != self.value:
                sentence = f"{chosen.ids(k)[0]} is cut {self.value}"
                yield Condition(Lit(Pick(c), False), (k,), sentence, f"is cut {cut.direction}, not {self.value}")


PLACES = {
    "x_mm": "its x",
    "y_mm": "its y",
    "left_gap_mm": "distance from the left side of the sheet",
    "right_gap_mm": "distance from the right side of the sheet",
    "bottom_gap_mm": "distance from the bottom side of the sheet",
    "top_gap_mm": "distance from the top side of the sheet",
    "edge_gap_mm": "distance from the nearest side of the sheet",
}
"""What can be said of a pierce or an entry, each a length."""


class EntryPlace(Demand):
    """The selected contours are pierced, or entered, only in a place, or anywhere but there."""

    FORM = Group(
        {name: (Scalar(LENGTHS.single), help) for name, help in PLACES.items()},
        example="a place such as {left_gap_mm: '< 50'}",
    )
    FORMS: ClassVar[Forms] = {
        "pierce": (FORM, "the selected contours are pierced only where this holds: {x_mm, y_mm, left_gap_mm, …}"),
        "no_pierce": (FORM, "the selected contours are not pierced where this holds"),
        "entry": (FORM, "the torch joins the selected contours only where this holds"),
        "no_entry": (FORM, "the torch does not join the selected contours where this holds"),
    }

    def conditions(self, chosen: Chosen) -> Iterator[Condition]:
        selected, refuses = set(chosen.selected), self.key.startswith("no_")
        where = " and ".join(f"{name} {criterion.plain()}" for name, criterion in self.value)
        done = "pierced" if "pierce" in self.key else "entered"
        asked = f"not {done} where {where}" if refuses else f"{done} only where {where}"
        slack_mm = -chosen.known.slack_mm if refuses else chosen.known.slack_mm
        for c, (k, cut) in enumerate(chosen.known.ways):
            point = cut.pierce if "pierce" in self.key else cut.entry
            if k in selected and self._met(chosen.nest, point, slack_mm) == refuses:
                wrong = f"is {done} at ({point[0]:.2f}, {point[1]:.2f}); it must be {asked}"
                yield Condition(Lit(Pick(c), False), (k,), f"{chosen.ids(k)[0]} is {asked}", wrong)

    def _met(self, nest: Nest, point: Point, slack_mm: float) -> bool:
        """Whether a point lies in the place; a slack above 0 takes in what is near, one below 0 leaves it out."""
        (xmin, ymin, xmax, ymax), (x, y) = nest.sheet.bounds, point
        gaps = (x - xmin, xmax - x, y - ymin, ymax - y)
        values = dict(zip(PLACES, (x, y, *gaps, min(gaps)), strict=True))
        spans = [(values[name], span) for name, span in self.value if isinstance(span, NumberSpan)]
        if slack_mm < 0:
            return all(span.surely_met(value, -slack_mm) for value, span in spans)
        return all(span.perhaps_met(value, slack_mm) for value, span in spans)


KINDS = (Order, Ends, Together, KeepApart, NextCut, WithinTime, OneStays, Direction, EntryPlace)
ASKS: Mapping[str, type[Demand]] = {key: kind for kind in KINDS for key in kind.FORMS}
"""Key in a profile → the kind of demand that stands under it."""
DEMANDS: Mapping[str, tuple[Form, str]] = {key: form for kind in KINDS for key, form in kind.FORMS.items()}
"""Key in a profile → the form of its value, and a line of help."""
