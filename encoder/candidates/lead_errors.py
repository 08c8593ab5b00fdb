"""Why contours have no lead, which one option would free them, in one message; questions on what a kerf cannot cut."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, Protocol

import numpy as np

from kerfwise.arrays import Floats
from kerfwise.encoder.display import join_names
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.measures import largest_circle
from kerfwise.encoder.narrow_features import MOST_TOLD, Narrow
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.questions import NARROW, SMALL_HOLES, Choice, Question, Questions
from kerfwise.encoder.slits import slits_of
from kerfwise.encoder.small_holes import EXACT_MM, HoleLimits, Under, diameter_under, kept_hole_reason

from .candidate import LEAST_WASTE_MM, LeadOptions
from .entries import IN_PROFILE, Joints, Outline, shaped, ways
from .lead_search import LeadAttempt, dense, longest_lead_mm, try_leads
from .leads import lead_ins, least_clearance_mm, shapes
from .obstacles import Surroundings

MOST_GROUPS = 8
"""With more groups than this, contours that the same options free at different values are taken together."""

_NAMED = 3


@dataclass(frozen=True, slots=True)
class _Alike:
    """Contours with the same cause that the same options free."""

    contours: tuple[int, ...]
    remedies: tuple[Remedy, ...]


def refusal(nest: Nest, tried: LeadAttempt, around: Surroundings, options: LeadOptions) -> InputError:
    """The error that tells of every contour at fault, a line a group, and first which option frees all of them.

    Where nobody has said what is done with deep slots and small holes, and nothing else is wrong, these are questions.
    """
    why = reasons(tried, around, options)
    remedies = Remedies(nest, tried, why, around, options)
    of_each = remedies.of_each()
    if questions := cut_questions(nest, tried, of_each, remedies, options):
        return Questions(questions, file=nest.file or None)
    message = cannot_be_cut(len(why))
    groups = _groups(why, of_each, remedies)
    if len(why) > 1:
        for_all = [remedy for remedy in _common(list(of_each.values())) if remedies.frees_nest(remedy)]
        if for_all:
            message += f"; {_either(for_all)} frees all of them"
        elif len(groups) > 1:
            message += "; no single option frees all of them"
    return InputError(message, file=nest.file or None, details=tuple(_line(nest, group, why) for group in groups))


def cannot_be_cut(count: int) -> str:
    """The beginning of the message for so many contours."""
    contours = "a contour" if count == 1 else f"{count} contours"
    return f"{contours} of the nest cannot be cut as the options ask"


def _common(rows: Sequence[Sequence[Remedy]]) -> list[Remedy]:
    """Of every option that is a remedy of all contours the value that would free all."""
    found = [_hardest(key, [remedy for row in rows for remedy in row if remedy.key == key]) for key in ORDER]
    return [remedy for remedy in found if remedy and all(any(r.key == remedy.key for r in row) for row in rows)]


def _hardest(key: Key, remedies: Sequence[Remedy]) -> Remedy | None:
    """The one of several values of an option that frees what all of them do: the smallest; to skip rather than spot."""
    if key == "under":
        values = {remedy.value for remedy in remedies}
        return Remedy(key, "skip" if "skip" in values else "spot") if values else None
    return min(remedies, key=lambda remedy: remedy.value, default=None)


def _groups(why: Mapping[int, Reason], of_each: Mapping[int, tuple[Remedy, ...]], remedies: Remedies) -> list[_Alike]:
    """Contours with the same cause and remedies, the largest group first."""
    exact: dict[tuple[str, tuple[Remedy, ...]], list[int]] = {}
    for k in sorted(why):
        alone = why[k].text if why[k].cause in ALONE else why[k].cause
        exact.setdefault((alone, of_each[k]), []).append(k)
    groups = [_Alike(tuple(contours), of) for (_, of), contours in exact.items()]
    if len(groups) > MOST_GROUPS:
        alike: dict[tuple[str, tuple[Key, ...]], list[int]] = {}
        for (text, of), contours in exact.items():
            cause = text if why[contours[0]].cause == "narrow" else why[contours[0]].cause
            alike.setdefault((cause, tuple(remedy.key for remedy in of)), []).extend(contours)
        groups = []
        for (_, keys), contours in alike.items():
            listed = [_hardest(key, [r for k in contours for r in of_each[k] if r.key == key]) for key in keys]
            holds = (r for r in listed if r is not None and len(remedies.freed(r, contours)) == len(contours))
            groups.append(_Alike(tuple(sorted(contours)), tuple(holds)))
    return sorted(groups, key=lambda group: (-len(group.contours), group.contours))


def _line(nest: Nest, group: _Alike, why: Mapping[int, Reason]) -> str:
    """One group: how many and which, what frees them, and why not as it is."""
    first = why[group.contours[0]]
    one = len(group.contours) == 1
    frees = "" if first.cause not in WITHOUT_ROOM else f"{'it needs' if one else 'they need'} more room in the nest"
    if group.remedies:
        frees = f"{_either(group.remedies)} frees {'it' if one else 'them'}"
    if one:
        return "; ".join(text for text in (first.text, frees) if text)
    kinds = {nest.contours[k].kind for k in group.contours}
    named = [nest.contours[k].id for k in group.contours]
    what = f"{len(named)} {'holes' if kinds == {'hole'} else 'contours'} ({join_names(named, _NAMED)})"
    return f"{what}: {'; '.join(text for text in (frees, f'such as {first.text}') if text)}"


def _either(remedies: Sequence[Remedy]) -> str:
    return ", or ".join(remedy.text for remedy in remedies)


# Which one option, at which value, frees contours that cannot be cut as the options ask.
#
# Every remedy is tried, alone, before it is named.

Key = Literal["pierce_clearance_mm", "under", "least_mm", "lead_in_min_mm", "narrow", "corner_mm"]

ORDER: tuple[Key, ...] = ("pierce_clearance_mm", "under", "least_mm", "lead_in_min_mm", "narrow", "corner_mm")
"""The order in which remedies are named."""

_SHARES = (0.5, 0.25, 0.1)
"""How much smaller an option is tried."""

_VALUES = 12
"""Values of one option that are tried at the most; contours that would do with a little more share the least."""


@dataclass(frozen=True, slots=True)
class Remedy:
    """One option at one value."""

    key: Key
    value: float | Under | Narrow

    @property
    def text(self) -> str:
        """As a profile has it.

        Examples
        --------
        >>> Remedy("pierce_clearance_mm", 1.48).text, Remedy("under", "spot").text
        ('`rules.pierce.clearance: 1.48 mm`', '`small_holes.under: spot`')
        """
        if self.key == "narrow":
            return f"`{IN_PROFILE[self.key]}: {self.value}` (the torch cuts straight across)"
        return f"`{IN_PROFILE[self.key]}: {self.value if isinstance(self.value, str) else f'{self.value:g} mm'}`"

    def applied(self, options: LeadOptions) -> LeadOptions:
        """The options with this one changed."""
        change: dict[str, Any] = {self.key: self.value}
        if self.key in ("under", "least_mm"):
            return replace(options, holes=replace(options.holes, **change))
        changed = replace(options, **change)
        return replace(changed, holes=_with_room(changed))


def _with_room(options: LeadOptions) -> HoleLimits:
    """The limits of holes where pierces keep another clearance."""
    if not options.holes.room_mm:
        return options.holes
    of_own = options if options.lead != "none" else replace(options, pierce_clearance_mm=0.0)
    return replace(options.holes, room_mm=2 * least_clearance_mm(of_own))


class Remedies:
    """What frees the contours at fault in one nest; `reasons` are theirs, by number."""

    def __init__(
        self, nest: Nest, tried: LeadAttempt, reasons: Mapping[int, Reason], around: Surroundings, options: LeadOptions
    ) -> None:
        self._nest, self._tried, self._reasons = nest, tried, reasons
        self._around, self._options = around, options

    def of_each(self) -> dict[int, tuple[Remedy, ...]]:
        """For every contour at fault the remedies that free it alone; none where nothing known does."""
        found: dict[int, list[Remedy]] = {k: [] for k in self._reasons}
        for remedy, contours in self._proposed():
            for k in self.freed(remedy, contours):
                found[k].append(remedy)
        of_kerf = {*self._tried.narrow, *self._tried.uncut, *self._tried.beyond}  # whatever the leads are
        for name in self._smaller_options():
            for remedy, k in self._smaller(name, [k for k in self._reasons if k not in of_kerf]):
                found[k].append(remedy)
        return {k: tuple(sorted(of, key=lambda remedy: ORDER.index(remedy.key))) for k, of in found.items()}

    def freed(self, remedy: Remedy, contours: Iterable[int]) -> list[int]:
        """Those of some contours that a remedy frees."""
        chosen, changed = list(contours), remedy.applied(self._options)
        if remedy.key == "under":
            return [k for k in chosen if self._is_treated(k, changed.holes)]
        if not chosen or not _leads_reach(changed):
            return []
        faulty = try_leads(self._nest, chosen, self._around, changed).faulty
        return [k for k in chosen if k not in faulty]

    def all_treated(self, under: Under, holes: Sequence[int]) -> bool:
        """Whether all of some holes are marked at the middle, or left out, by another option."""
        return len(self.freed(Remedy("under", under), holes)) == len(holes)

    def cut_or_left(self, limits: HoleLimits, holes: Sequence[int]) -> tuple[int, int] | None:
        """How many of some holes are cut by other limits, and how many are not; None where any cannot be cut then."""
        chosen = list(holes)
        left = [k for k in chosen if self._is_treated(k, limits)]
        cut = [k for k in chosen if k not in left]
        changed = replace(self._options, holes=limits)
        if cut and try_leads(self._nest, cut, self._around, changed).faulty & set(cut):
            return None
        return len(cut), len(left)

    def frees_nest(self, remedy: Remedy) -> bool:
        """Whether a remedy leaves no contour of the nest at fault."""
        every = remedy.key == "lead_in_min_mm"  # with other lengths every lead is another: all contours are looked at
        contours = sorted({*self._tried.outlines, *self._reasons}) if every else list(self._reasons)
        return len(self.freed(remedy, contours)) == len(contours)

    def _is_treated(self, k: int, limits: HoleLimits) -> bool:
        hole = self._nest.contours[k]
        if hole.kind != "hole" or diameter_under(hole, limits.limit_mm) is None:
            return False
        return kept_hole_reason(self._nest, hole, limits) is None

    def _proposed(self) -> Iterator[tuple[Remedy, list[int]]]:
        """Remedies to try whose values the contours themselves tell, and for which contours."""
        contours, holes = self._nest.contours, self._options.holes
        left = [k for k in self._reasons if contours[k].kind == "hole"]
        unders: tuple[Under, ...] = ("skip",) if holes.treated else ("spot", "skip")
        for under in unders:
            remedy = Remedy("under", under)
            yield remedy, left
            done = set(self.freed(remedy, left))
            left = [k for k in left if k not in done]
        within_mm = self._options.kerf_mm / 2 + LEAST_WASTE_MM
        gaps_mm = {k: r.gap_mm for k, r in self._reasons.items() if r.gap_mm is not None and r.gap_mm > within_mm}
        yield from _at_values("pierce_clearance_mm", gaps_mm)
        across_mm = {k: diameter_under(contours[k], holes.limit_mm) for k in self._tried.small}
        rounded_mm = {k: math.floor((mm + EXACT_MM / 2) * 100) / 100 for k, mm in across_mm.items() if mm is not None}
        yield from _at_values("least_mm", rounded_mm)
        yield Remedy("narrow", "leave"), sorted(self._tried.narrow)
        corners_mm = {
            k: math.ceil(max(one.left_mm for one in of.lost if one.corner_deg is not None) * 100) / 100
            for k, of in self._tried.narrow.items()
            if of.lost and all(one.corner_deg is not None for one in of.lost)
        }
        yield from ((Remedy("corner_mm", value), [k]) for k, value in corners_mm.items())

    def _smaller_options(self) -> tuple[Key, ...]:
        """Options of which smaller values are tried, because no contour tells one."""
        return ("lead_in_min_mm",) if self._options.lead != "none" else ("pierce_clearance_mm",)

    def _smaller(self, name: Key, left: list[int]) -> Iterator[tuple[Remedy, int]]:
        """The largest of some smaller values that frees each contour."""
        for share in _SHARES:
            remedy = Remedy(name, round(getattr(self._options, name) * share, 3))
            freed = self.freed(remedy, left)
            yield from ((remedy, k) for k in freed)
            left = [k for k in left if k not in freed]


def _leads_reach(options: LeadOptions) -> bool:
    """Whether the longest lead brings a pierce as far from its contour as its clearance."""
    return options.lead == "none" or options.lead_in_mm >= least_clearance_mm(options) - options.kerf_mm / 2


def _at_values(key: Key, values: Mapping[int, float]) -> Iterator[tuple[Remedy, list[int]]]:
    """An option at the value that each contour asks for; where there are many values, at some of the smaller ones."""
    known = np.unique(list(values.values()))
    tried = known[np.unique(np.arange(min(_VALUES, len(known))) * len(known) // max(min(_VALUES, len(known)), 1))]
    for i, value in enumerate(tried.tolist()):
        above = tried[i + 1] if i + 1 < len(tried) else math.inf
        yield Remedy(key, value), [k for k, asked in values.items() if value <= asked < above]


# Why contours have no lawful lead, in words.

ALONE = ("reach", "narrow", "slit")
"""Causes that are told of each contour by itself: how far it is out, or which places of it."""

WITHOUT_ROOM = ("pierce", "lead", "path")
"""Causes that more room in the nest would take away."""

BURNT = "what is already cut leaves no metal to pierce near it: all pierces and leads there would lie in older kerfs"

_LOOKS = 8
"""Entries of a contour that are looked at; some of those that the search has tried."""


@dataclass(frozen=True, slots=True)
class Reason:
    """Why a contour cannot be cut as the options ask: a whole sentence, and the cause alone, which others may share.

    `gap_mm` is how far from everything the best spot for a pierce is, where that is what stands in the way.
    """

    text: str
    cause: str
    gap_mm: float | None = None


def reasons(tried: LeadAttempt, around: Surroundings, options: LeadOptions) -> dict[int, Reason]:
    """The reason of every contour at fault, by number."""
    small = {k: Reason(text, "small") for k, text in tried.small.items()}
    small |= {k: Reason(text, "kerf") for k, text in tried.uncut.items()}
    small |= {k: Reason(one.sentence(options), "narrow") for k, one in tried.narrow.items()}
    small |= {k: Reason(text, "reach") for k, text in tried.beyond.items()}
    small |= {k: Reason(text, "slit") for k, text in tried.shut.items()}
    if tried.bare:
        joints = Joints.joined([dense(tried.outlines[k], _LOOKS) for k in tried.bare])
        burnt = _but_for_what_is_cut(tried, around, options)
        for k, (cause, why, gap_mm) in _why(joints, tried.outlines, around, options, tried.bare).items():
            if k in burnt:
                cause, why, gap_mm = "burnt", BURNT, None
            x, y = tried.outlines[k].contour.curve.start
            small[k] = Reason(f"{tried.outlines[k].contour.id} at ({x:.1f}, {y:.1f}): {why}", cause, gap_mm)
    for i in tried.unmet:
        k = int(tried.locked.contour[i])
        x, y = tried.locked.entry[i].tolist()
        cause, why, gap_mm = _why(tried.locked.take(np.array([i])), tried.outlines, around, options, [k])[k]
        small[k] = Reason(
            f"{tried.outlines[k].contour.id} at the entry asked for, ({x:.1f}, {y:.1f}): {why}", cause, gap_mm
        )
    return small


def _but_for_what_is_cut(tried: LeadAttempt, around: Surroundings, options: LeadOptions) -> set[int]:
    """Contours that have room for a lead but for metal that a stopped program has burnt away."""
    if around.void is None:
        return set()
    to_try = ways(Joints.joined([dense(tried.outlines[k]) for k in tried.bare]), tried.outlines, options.directions)
    longest_mm = np.array([longest_lead_mm(tried.outlines[k], options) for k in to_try.joints.contour.tolist()])
    found = lead_ins(to_try, longest_mm, replace(around, void=None), options, patient=True)
    return set(found.ways.joints.contour.tolist())


def _why(
    joints: Joints, outlines: Mapping[int, Outline], around: Surroundings, options: LeadOptions, contours: Sequence[int]
) -> dict[int, tuple[str, str, float | None]]:
    """Why there is no room at any of the joints, by contour: the cause, in words, and the widest gap for a pierce."""
    led = options.lead != "none"
    best = _best_pierces(joints, outlines, around, options) if led else {}
    clearance_mm = least_clearance_mm(options)
    found: dict[int, tuple[str, str, float | None]] = {}
    for k in contours:
        if k in best:
            gap_mm, what = around.nearest(best[k])
            gap_mm = math.floor(gap_mm * 100 + 1e-3) / 100
            why = (
                f"the best spot for a pierce near it is {gap_mm:g} mm from {what}, "
                f"{IN_PROFILE['pierce_clearance_mm']} asks for {clearance_mm:g} mm"
            )
            found[k] = "pierce", why, gap_mm
        elif led:
            why = (
                f"no lead from {IN_PROFILE['lead_in_min_mm']}, {options.lead_in_min_mm:g} mm, to "
                f"{IN_PROFILE['lead_in_mm']}, {options.lead_in_mm:g} mm, "
                f"keeps half the kerf, {options.kerf_mm / 2:g} mm, away from what is around it"
            )
            found[k] = "lead", why, None
        else:
            why = (
                "without a lead the pierce lies on the torch's path, and all of that is nearer to others than "
                f"{IN_PROFILE['pierce_clearance_mm']}, {clearance_mm:g} mm"
            )
            found[k] = "path", why, None
    return found


def _best_pierces(
    joints: Joints, outlines: Mapping[int, Outline], around: Surroundings, options: LeadOptions
) -> dict[int, Floats]:
    """Of the leads that are otherwise lawful, the pierce furthest from everything, by contour."""
    best: dict[int, tuple[float, Floats]] = {}
    to_try = ways(joints, outlines, options.directions)
    longest_mm = np.array([longest_lead_mm(outlines[k], options) for k in to_try.joints.contour.tolist()])
    for shape in shapes(replace(options, lead="line"), patient=True):
        leads = shaped(shape, to_try.joints, to_try.along, longest_mm, options.lead_in_min_mm)
        clear = around.clear_leads(leads, to_try.joints.contour, options.kerf_mm / 2) & around.inside_edges(leads)
        gaps_mm = around.gaps_mm(leads.pierce[clear])
        for k, gap_mm, pierce in zip(
            to_try.joints.contour[clear].tolist(), gaps_mm.tolist(), leads.pierce[clear], strict=True
        ):
            if gap_mm > best.get(k, (0.0, pierce))[0]:
                best[k] = (gap_mm, pierce)
    return {k: pierce for k, (_, pierce) in best.items()}


class Proposed(Protocol):
    """A `Remedy`, as far as it is looked at here: what it changes, and how a profile has it."""

    @property
    def key(self) -> str: ...

    @property
    def text(self) -> str: ...


class Frees(Protocol):
    """What frees contours, as far as it is asked for here; see `Remedies`."""

    def all_treated(self, under: Under, holes: Sequence[int]) -> bool: ...

    def cut_or_left(self, limits: HoleLimits, holes: Sequence[int]) -> tuple[int, int] | None: ...


def cut_questions(
    nest: Nest,
    tried: LeadAttempt,
    of_each: Mapping[int, Sequence[Proposed]],
    remedies: Frees,
    options: LeadOptions,
) -> list[Question]:
    """What is asked of contours that cannot be cut, where answers free all of them; nothing where they do not.

    `of_each`: for every contour at fault what frees it alone.
    """
    narrow = [k for k in of_each if k in tried.narrow and _asks_of_slots(tried, k, options)]
    holes = [k for k in of_each if options.holes.under == "ask" and any(r.key == "under" for r in of_each[k])]
    if len(narrow) + len(holes) < len(of_each):
        return []
    questions = [_of_holes(nest, holes, of_each, remedies, options)] if holes else []
    return [*questions, _of_slots(tried, narrow, options)] if narrow else questions


def _asks_of_slots(tried: LeadAttempt, k: int, options: LeadOptions) -> bool:
    """Whether all that a contour would lose are slots, notches and necks, of which nobody has said what is done."""
    features = tried.narrow[k]
    return options.narrow == "ask" and not features.burnt and all(one.corner_deg is None for one in features.lost)


def _of_slots(tried: LeadAttempt, contours: Sequence[int], options: LeadOptions) -> Question:
    lost = [(tried.narrow[k].contour.id, one) for k in contours for one in tried.narrow[k].lost]
    text = "; ".join(f"{name}, {one.sentence().removeprefix('the ')}" for name, one in lost[:MOST_TOLD])
    more = f"; and {len(lost) - MOST_TOLD} more" if len(lost) > MOST_TOLD else ""
    kerf = f"the kerf of {options.kerf_mm:g} mm"
    which = f"{kerf} does not enter a deep slot, notch or neck" if len(lost) == 1 else (
        f"{kerf} does not enter {len(lost)} deep slots, notches or necks"
    )  # fmt: skip
    leave = Choice("leave", "cut straight across the mouth: what is behind it is not cut")
    slit = Choice("slit", f"opened by one pass along the middle, {options.kerf_mm:g} mm wide")
    opens = all(not slits_of(tried.narrow[k].contour, options.kerf_mm)[1] for k in contours)
    choices = (slit, leave) if opens else (leave,)
    refuse = Choice("refuse", "not cut: the nest is refused, to be drawn otherwise")
    return Question(NARROW, f"{which}: {text}{more}: what should be done?", (*choices, refuse))


def _of_holes(
    nest: Nest,
    holes: Sequence[int],
    of_each: Mapping[int, Sequence[Proposed]],
    remedies: Frees,
    options: LeadOptions,
) -> Question:
    kerf_mm, limits = options.kerf_mm, options.holes
    across_mm = {k: largest_circle(nest.contours[k].curve)[1] for k in holes}
    dots = [k for k in holes if across_mm[k] < kerf_mm - EXACT_MM]
    small = [k for k in holes if k not in dots and across_mm[k] < limits.least_mm - EXACT_MM]
    rest = [k for k in holes if k not in dots and k not in small]
    groups = (
        (dots, f"no wider than the kerf of {kerf_mm:g} mm"),
        (small, f"under small_holes.min_hole, {limits.least_mm:g} mm"),
        (rest, f"without room for a pierce {limits.room_mm / 2:g} mm from their edge"),
    )
    texts = [
        f"{len(group)} {why} ({_sizes([across_mm[k] for k in group])}: "
        f"{join_names([nest.contours[k].id for k in group], 3)})"
        for group, why in groups
        if group
    ]
    skip = Choice("skip", _counted(len(holes), "left out"))
    spot = Choice("spot", _counted(len(holes), "marked at the middle"))
    ways: list[tuple[Under, Choice]] = [("spot", spot), ("skip", skip)]
    ways = ways[::-1] if dots and not small else ways
    choices = [choice for under, choice in ways if remedies.all_treated(under, holes)]
    done = remedies.cut_or_left(replace(limits, least_mm=kerf_mm, under="skip"), holes)
    if done is not None and done[0]:
        left = f", {done[1]} left out" if done[1] else ""
        choices.append(Choice("cut", f"{_counted(done[0], 'cut anyway')}{left}"))
    others = sorted({r.text for k in holes for r in of_each[k] if r.key in ("pierce_clearance_mm", "lead_in_min_mm")})
    besides = f" ({' and '.join(others[:2])} would have some of them cut)" if rest and others else ""
    which = "1 hole is too small to be cut" if len(holes) == 1 else f"{len(holes)} holes are too small to be cut"
    refuse = Choice("refuse", "not cut: the nest is refused, to be drawn otherwise")
    return Question(SMALL_HOLES, f"{which}: {'; '.join(texts)}{besides}: what should be done?", (*choices, refuse))


def _counted(count: int, done: str) -> str:
    return f"{count} hole{'s' if count != 1 else ''} {done}"


def _sizes(across_mm: Sequence[float]) -> str:
    least, most = min(across_mm), max(across_mm)
    return f"{least:.2f} mm across" if most - least < EXACT_MM else f"{least:.2f} to {most:.2f} mm across"
