"""Cuts that several torches make together: what they are to be, and judgements in which none of them is the first."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from itertools import zip_longest

import numpy as np

from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.postproc.check.reader.program import NcProgram
from kerfwise.rules.profile.machine_section import Torches
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.rule import Violation

from .judgement import Judgement
from .planned import Planned
from .program_rules import tolerance_mm

_RULE = "torches"
_TIME_S = 0.01
_TOLD = re.compile(r"TORCHES (?P<count>\d+), (?P<spacing>\d+(?:\.\d+)?) MM APART ALONG (?P<axis>[XY])", re.IGNORECASE)


def stricter(one: Sequence[Judgement], *others: Sequence[Judgement]) -> list[Judgement]:
    """Of each judgement the strictest: what is cut at one time counts as cut in whichever order is worse."""
    found = []
    for judgement in one:
        same = (j for more in others for j in more if j.id == judgement.id)
        found.append(max((judgement, *same), key=_weight))
    return found


def _weight(judgement: Judgement) -> tuple[bool, bool, int]:
    return not judgement.holds, judgement.unjudged is not None, len(judgement.excused)


def most_at_once(cuts: Sequence[Cut]) -> int:
    """How many torches make cuts together, at the most."""
    return max((cut.torch for cut in cuts), default=1)


def not_together(cuts: CutSequence, profile: Profile) -> Iterator[Violation]:
    """Cuts of further torches that are not those of the first one, shifted by what the torches are apart."""
    torches, kerf_mm = profile.machine.torches, profile.material.kerf_mm
    first = {cut.contour: (k, cut) for k, cut in enumerate(cuts, 1) if cut.torch == 1}
    for position, cut in enumerate(cuts, 1):
        if cut.torch == 1:
            continue
        text = None
        leader_at, leader = first.get(cut.together, (0, cut))
        between = cuts[leader_at : position - 1]
        if cut.torch > torches.count:
            have = "one torch" if torches.count == 1 else f"{torches.count} torches"
            text = f"is made by torch {cut.torch}, the profile has {have}"
        elif not leader_at:
            text = f"is to be made together with {cut.together or 'nothing'}, which torch 1 does not cut"
        elif any(one.together != cut.together or one.torch >= cut.torch for one in between) or leader_at > position:
            text = f"does not follow {leader.contour}, with which it is made"
        elif (off_mm := _apart_mm(cut, leader, torches)) > tolerance_mm(kerf_mm) or cut.direction != leader.direction:
            x, y = torches.shift(cut.torch)
            text = f"is not the cut of {leader.contour} shifted by ({x:g}, {y:g}): it is {off_mm:.2f} mm off"
        elif max(abs(cut.start_s - leader.start_s), abs(cut.end_s - leader.end_s)) > _TIME_S:
            text = f"has other times than {leader.contour}, with which it is made"
        if text is not None:
            yield Violation(_RULE, (cut.contour,), f"cut {position} of {cut.contour} {text}", (position,))


def _apart_mm(cut: Cut, leader: Cut, torches: Torches) -> float:
    """How far the leads and the entry are from those of the first torch, shifted."""
    rows = zip_longest(_points(cut), _points(leader))
    shift = np.array(torches.shift(cut.torch))
    apart = [
        math.inf if a is None or b is None else float(np.hypot(*(np.array(a) - np.array(b) - shift))) for a, b in rows
    ]
    return max(apart)


def _points(cut: Cut) -> list[tuple[float, float]]:
    def of(lead: Curve | None) -> list[tuple[float, float]]:
        return [] if lead is None else [(x, y) for x, y in lead.vertices[:, :2].tolist()]

    return [cut.entry, cut.pierce, *of(cut.lead_in), *of(cut.lead_out)]


def wrong_spacing(program: NcProgram, profile: Profile, told_by_plan: bool) -> Iterator[Violation]:
    """Where a program does not say that it is for the profile's torches, though it lights several.

    One that says nothing may have a plan, which the program is held against.
    """
    torches = profile.machine.torches
    has = f"{torches.count} {torches.apart}" if torches.several else "one"
    told = _told(program)
    for words in told:
        spacing_mm, axis = float(words["spacing"]), words["axis"].lower()
        there = profile.at_spacing(spacing_mm).machine.torches
        same = abs(spacing_mm - there.spacing_mm) <= 1e-3 and axis == there.axis and there.up_to_mm is None
        same = same and words["spacing"] == told[0]["spacing"]
        if not same or int(words["count"]) != torches.count:
            says = f"{words['count']} torches {spacing_mm:g} mm apart along {axis.upper()}"
            yield Violation(_RULE, (), f"the program is for {says}, the profile has {has}")
    lit = next((burn for burn in program.burns if burn.torches), None)
    if lit is not None and not told and not told_by_plan:
        text = f"line {lit.line}: torch {lit.torches[0]} burns too, and no comment says how far it is from the first: "
        yield Violation(_RULE, (), f"{text}expected {_comment(torches)}, or --plan")


def stated_spacing(program: NcProgram, planned: Planned | None, torches: Torches) -> float | None:
    """How far torches stand apart by the program's comment, else by its plan; None where neither says."""
    for words in _told(program):
        return float(words["spacing"])
    return None if planned is None else planned.cuts.spacing_mm(torches.axis)


def _told(program: NcProgram) -> list[re.Match[str]]:
    return [found for found in map(_TOLD.fullmatch, program.comments) if found]


def _comment(torches: Torches) -> str:
    spacing = f"{torches.spacing_mm:g}" if torches.up_to_mm is None else "…"
    return f"(TORCHES {torches.count}, {spacing} MM APART ALONG {torches.axis.upper()})"
