"""Questions about what a kerf cannot cut as it is drawn: deep slots narrower than it, and holes that are too small."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Protocol

from kerfwise.encoder.display import join_names
from kerfwise.encoder.geometry.measures import largest_circle
from kerfwise.encoder.narrow_features import MOST_TOLD
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.questions import NARROW, SMALL_HOLES, Choice, Question
from kerfwise.encoder.slits import slits_of
from kerfwise.encoder.small_holes import EXACT_MM, HoleLimits, Under

from .candidate import LeadOptions
from .lead_search import LeadAttempt


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
