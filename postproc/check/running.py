"""How a program has the machine run: its feeds, its waits at pierces, its torch on travel, and its way home."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence

import numpy as np
import shapely

from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.check.reader.controls import Control
from kerfwise.postproc.check.reader.on_machine import control_of
from kerfwise.postproc.check.reader.program import Burn, NcProgram, at_holes, of_all_torches
from kerfwise.postproc.dialects import fitting_dialect, pierce_dwell_of
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.rule import Violation

from .corners import slow_at_corners, wrong_at_corners
from .judgement import Judgement
from .program_rules import judgement, tolerance_mm, written_from_profile
from .small_holes import Shares
from .torch_run import TorchRun

_FEED_SHARE, _WAIT_S, _POWER = 1e-3, 2e-3, 0.51


def judge_running(
    nest: Nest,
    program: NcProgram,
    profile: Profile,
    runs: Sequence[TorchRun] = (),
    shares: Mapping[str, Shares] | None = None,
    in_kerfs: Collection[tuple[str, int]] = (),
) -> list[Judgement]:
    """What a program does with the machine.

    `runs` say which contour each burn follows, `shares` at which shares of the cut feed a small hole may be cut. Burns
    that are `in_kerfs` ("line 40", and the torch) begin in the kerf of an older one, where there is nothing to pierce.
    """
    control, _ = control_of(profile)
    found = {
        "torch-off-travel": [
            (hot.line, f"the torch is on during a rapid of {hot.length_mm:.1f} mm") for hot in program.hot_rapids
        ],
        "program-state": [],
        "feeds": list(_feeds(program, profile, control, runs, shares or {})),
        "pierce-delay": list(_waits(nest, program, profile, in_kerfs)),
        "returns-home": list(_home(program, profile.home_on(nest))),
    }
    corner = profile.frame_on(nest).corner
    if program.zero is not None and math.dist(program.zero, corner) > tolerance_mm():
        said, is_at = (f"({x:g}, {y:g})" for x, y in (program.zero, corner))
        text = f"it says that its zero is at {said} of the drawing, by its origin it is at {is_at}"
        found["program-state"].append((0, text))
    found["program-state"] += _powers(program, profile, control)
    for fault in program.faults:
        found[fault.rule].append((fault.line, fault.text))
    return [
        judgement(rule, [Violation(rule, (), f"line {line}: {text}" if line else text) for line, text in sorted(lines)])
        for rule, lines in found.items()
    ]


def _feeds(
    program: NcProgram,
    profile: Profile,
    control: Control,
    runs: Sequence[TorchRun],
    shares: Mapping[str, Shares],
) -> Iterator[tuple[int, str]]:
    machine, slack = profile.machine, control.feed_step_mm_min / 120
    names: dict[str, list[str]] = defaultdict(list)
    for run in runs:
        names[run.where].append(run.contour.id if run.contour is not None else "")
    for burn in program.burns:
        cuts, cut = burn.tool == 0, names[f"line {burn.line}"] or [""]
        name = cut[0]
        asked = machine.cut_feed_mm_s if cuts else machine.mark_feed_mm_s
        allowed = [shares.get(one, (1.0, 1.0)) if cuts else (1.0, 1.0) for one in cut]
        low, high = asked * min(least for least, _ in allowed), asked * max(most for _, most in allowed)
        if cuts and slow_at_corners(profile):
            for text in wrong_at_corners(burn, (low, high), profile, slack):
                yield burn.line, text
            continue
        for feed in burn.feeds_mm_s:
            if not low * (1 - _FEED_SHARE) - slack <= feed <= high * (1 + _FEED_SHARE) + slack:
                where = f" in {name}" if high < asked else ""
                says = f"the profile says {high * 60:.0f} mm/min{where}"
                yield burn.line, f"it {'cuts' if cuts else 'marks'} at {feed * 60:.0f} mm/min, {says}"
    for slow in program.slow_travel:
        yield slow.line, f"it travels {slow.length_mm:.1f} mm at cutting feed with the torch off"


def _powers(program: NcProgram, profile: Profile, control: Control) -> Iterator[tuple[int, str]]:
    """Powers of a laser that are not the profile's, where that says one; else the dialect's, in programs from it."""
    material, full = profile.material, control.full_power
    if not full:
        return
    pierces = material.power if material.pierce_power is None else material.pierce_power
    own = fitting_dialect(profile).powers if written_from_profile(program.comments) else None
    words: Mapping[str, float] = {} if own is None else {"cut": own.cut, "pierce": own.pierce, "mark": own.mark}
    for burn in program.burns:
        cuts = burn.tool == 0
        asked = (
            ("cuts", "cut", burn.powers, material.power)
            if cuts
            else ("marks", "mark", burn.powers, material.mark_power),
            ("pierces", "pierce", burn.pierce_powers, pierces)
            if cuts
            else ("starts to mark", "mark", burn.pierce_powers, material.mark_power),
        )
        for does, kind, powers, share in asked:
            right = words.get(kind) if share is None else full * share / 100
            for power in powers if right is not None else ():
                if abs(power - (right or 0.0)) > _POWER:
                    by = "the dialect has" if share is None else f"the profile says {share:g} %,"
                    yield burn.line, f"it {does} with S{power:g}, {by} S{right:g}"


def _waits(
    nest: Nest, program: NcProgram, profile: Profile, in_kerfs: Collection[tuple[str, int]]
) -> Iterator[tuple[int, str]]:
    """Pierces too short or too long, of each torch: one may be over metal where another is off the sheet's edge.

    A torch that comes in from the edge pierces nothing, but may preheat.
    """
    program = of_all_torches(program, profile.machine.torches.shift)
    burns = program.burns
    if not burns:
        return
    machine = profile.machine
    waits = pierce_dwell_of(profile) == "program"
    cooling_s, flame = _longest_dwell_s(profile), machine.process == "oxyfuel"
    preheat_s = machine.edge_preheat_s or (machine.pierce_time_s if flame else 0.0)
    points = shapely.points(np.array([burn.path.vertices[0, :2] for burn in burns]))
    sheet = shapely.make_valid(nest.sheet.polygon)
    inside, near = (shapely.contains(shapely.buffer(sheet, by), points) for by in (-tolerance_mm(), tolerance_mm()))
    passes = profile.cuts.pierce_pass is not None
    holes = at_holes(program) if passes else [False] * len(burns)
    for burn, pierced, maybe, hole in zip(burns, inside.tolist(), near.tolist(), holes, strict=True):
        marks, in_kerf = burn.tool != 0, (f"line {burn.line}", burn.torch) in in_kerfs
        start_s = {machine.pierce_time_s} if pierced and not in_kerf else {preheat_s}
        start_s |= {machine.pierce_time_s} if maybe and not in_kerf else set()
        start_s = {preheat_s if flame else 0.0} if hole else start_s
        allowed = ({machine.mark_time_s} if marks else start_s) if waits else {0.0}
        if all(abs(burn.pierce_s - s) > _WAIT_S for s in allowed):
            says, torch = " or ".join(f"{s:g} s" for s in sorted(allowed)), _torch(burn)
            yield burn.line, f"{torch} stands for {burn.pierce_s:g} s before it moves, the profile asks for {says}"
        if burn.torch > 1:  # it waits with the first
            continue
        if burn.wait_s > cooling_s + _WAIT_S:
            most = f"{cooling_s:g} s at most" if cooling_s else "no such wait"
            yield burn.line, f"the torch waits for {burn.wait_s:g} s before it is lit, the profile allows {most}"
        if burn.paused_s > 0:
            yield burn.line, f"the torch stands still for {burn.paused_s:g} s in the middle of its path"


def _torch(burn: Burn) -> str:
    return "the torch" if burn.torch == 1 else f"torch {burn.torch}"


def _longest_dwell_s(profile: Profile) -> float:
    """How long the torch may wait for metal to cool, off, s."""
    limit = profile.temperature_limit()
    return 0.0 if limit is None else limit.allowed_dwell_s


def _home(program: NcProgram, home: Point) -> Iterator[tuple[int, str]]:
    if math.dist(program.end, home) > tolerance_mm():
        x, y = program.end
        yield 0, f"the program ends at ({x:.3f}, {y:.3f}), the machine's home is ({home[0]:g}, {home[1]:g})"
