"""Blocks of a torch that tilts: the passes of a contour with a bevel, each from its pierce to where it goes off."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from kerfwise.encoder.bevels.tilted_path import TiltedPath
from kerfwise.encoder.geometry.segment import Point
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.dialects import pierce_dwell_of
from kerfwise.rules.profile.technique import Technique

from .gcode import GcodeWriter, comment, number
from .toolpaths import Toolpath

_DEG_DECIMALS = 4
_SAME_DEG = 10**-_DEG_DECIMALS / 2


def bevel_passes(
    order: int, name: str, toolpath: Toolpath, corner: Point, profile: Technique, pen: GcodeWriter
) -> Iterator[str]:
    """The blocks of all passes; `corner` is the point of the drawing that is the program's zero.

    An upright pass follows the path of the cut itself. Between two passes the torch is off.
    """
    machine, words, cut = profile.machine, profile.cuts.bevel, toolpath.planned.cut
    if toolpath.passes[0].aside_mm is not None:
        yield from _by_block(order, name, toolpath, corner, profile, pen)
        return
    small_hole = toolpath.small_hole_share
    waits = pierce_dwell_of(profile, pen.dialect) == "program"
    for count, one in enumerate(toolpath.passes, 1):
        lean = f"TILT {number(one.tilt_deg, 3)}" if one.tilt_deg else "UPRIGHT"
        lean = lean if one.steady else f"{lean} TO UPRIGHT"
        text = f"ZONE {cut.zone} {cut.direction.upper()} PASS {count} OF {len(toolpath.passes)} {lean}"
        yield comment(pen.dialect, f"CUT {order}", name, text)
        feed_mm_s = machine.cut_feed_mm_s * small_hole
        yield from pen.select(False)
        if one.tilt_deg:
            path = one.moved(-corner[0], -corner[1])
            first = path.steps[0]
            pen.upright = f"{words.tilt}{number(first.tilt_deg, 3)}"
            yield from _there(path, words.turn, pen)
            yield from pen.start(False, machine.pierce_time_s if waits else 0.0, feed_mm_s * first.feed_share)
            yield from _followed(path, feed_mm_s, (words.tilt, words.turn), profile.material.thickness_mm, pen)
            yield from pen.stop(False)
            pen.upright = f"{words.tilt}0"
        else:
            yield pen.rapid(toolpath.path.point_at(0.0))
            yield from pen.start(False, machine.pierce_time_s if waits else 0.0, feed_mm_s)
            yield from pen.path(toolpath.path, feed_mm_s)
            yield from pen.stop(False)


def _there(path: TiltedPath, turn: str, pen: GcodeWriter) -> Iterator[str]:
    """Travel to where a path begins, and turn the head as it begins there."""
    word = f"{turn}{_degrees(path.steps[0].begin_deg)}"
    if pen.dialect.turning is None:
        pen.upright = f"{pen.upright} {word}".lstrip()
        yield pen.rapid(path.start)
        return
    if not pen.turned:
        yield from pen.dialect.turning.before
    pen.turned = True
    yield pen.rapid(path.start)
    yield f"{pen.dialect.rapid} {word}"


UPRIGHT, OPEN_TO_TOP, OPEN_TO_BOTTOM = 2, 3, 4
"""The torches of a block, as programs name them: the first is that of a machine without one."""
BLOCK_TORCHES = {UPRIGHT: "UPRIGHT", OPEN_TO_TOP: "OPEN TO THE TOP", OPEN_TO_BOTTOM: "OPEN TO THE BOTTOM"}


def _by_block(
    order: int, name: str, toolpath: Toolpath, corner: Point, profile: Technique, pen: GcodeWriter
) -> Iterator[str]:
    """The blocks of a contour that a block of torches cuts at once; how these are set by hand stands before."""
    machine, words, cut = profile.machine, profile.cuts.bevel, toolpath.planned.cut
    lit = set()
    for one in toolpath.passes:
        torch = UPRIGHT if not one.tilt_deg else OPEN_TO_TOP if one.tilt_deg > 0 else OPEN_TO_BOTTOM
        lit.add(torch)
        left, out = one.aside_mm or (0.0, 0.0)
        stands = f"TILT {number(one.tilt_deg, 3)} LEFT {number(left, 3)} OUT {number(out, 3)}"
        yield comment(pen.dialect, f"BLOCK TORCH {torch} {BLOCK_TORCHES[torch]}", "", stands)
    text = f"ZONE {cut.zone} {cut.direction.upper()} BLOCK OF {len(toolpath.passes)}"
    yield comment(pen.dialect, f"CUT {order}", name, text)
    share = toolpath.small_hole_share * min(one.feed_share for one in toolpath.passes)
    feed_mm_s = machine.cut_feed_mm_s * share
    waits = pierce_dwell_of(profile, pen.dialect) == "program"
    path = toolpath.passes[0].moved(-corner[0], -corner[1])
    path = replace(path, steps=tuple(replace(step, tilt_deg=0.0, end_tilt_deg=0.0) for step in path.steps))
    yield from pen.select(False)
    yield from pen.leave(lit)
    pen.upright = ""  # the block turns from one contour to the next
    yield from _there(path, words.turn, pen)
    yield from pen.add(lit)
    yield from pen.start(False, machine.pierce_time_s if waits else 0.0, feed_mm_s)
    yield from _followed(path, feed_mm_s, (words.tilt, words.turn), profile.material.thickness_mm, pen)
    yield from pen.stop(False)
    pen.upright = f"{words.turn}0" if pen.dialect.turning is None else ""


def kerf_assumptions(plan: Plan, profile: Technique) -> Iterator[str]:
    """What is taken for the kerf at angles that the plant has no row for: as upright, square to the jet."""
    rows = {angle for angle, _ in profile.cuts.bevel.kerfs}
    for angle in sorted({abs(one.tilt_deg) for planned in plan.cuts for one in planned.passes} - rows - {0.0}):
        if not rows or not min(rows) < angle < max(rows):
            options = profile.bevel_options()
            kerf = number(profile.material.kerf_mm if options is None else options.kerf_mm(angle), 3)
            yield f"THE KERF AT {number(angle, 3)} DEGREES IS {kerf} MM, SQUARE TO THE JET: NOBODY HAS MEASURED IT"


def _followed(
    path: TiltedPath, feed_mm_s: float, axes: tuple[str, str], thickness_mm: float, pen: GcodeWriter
) -> Iterator[str]:
    """The blocks that follow a path, the head tilting and turning with it: its angles stand where they change."""
    said: tuple[float, ...] = (path.steps[0].tilt_deg, path.steps[0].begin_deg)
    in_force = ""

    def turned(*angles: float) -> str:
        nonlocal said
        words = [
            f" {axis}{_degrees(a)}" for axis, a, b in zip(axes, angles, said, strict=True) if abs(a - b) > _SAME_DEG
        ]
        said = tuple(a if abs(a - b) > _SAME_DEG else b for a, b in zip(angles, said, strict=True))
        return "".join(words)

    for step in path.steps:
        step_mm_s = feed_mm_s * step.feed_share
        if step.segment.length_mm == 0:
            swept_deg = math.hypot(step.end_deg - step.begin_deg, step.end_tilt_deg - step.tilt_deg)
            deg_min = swept_deg * step_mm_s / step.swing_mm(thickness_mm) * 60  # no point of the jet moves faster
            speed = deg_min / 360 if pen.dialect.turning is not None and pen.dialect.turning.feed == "rpm" else deg_min
            yield f"{pen.dialect.line}{turned(step.end_tilt_deg, step.end_deg)} F{number(speed, 3)}"
            in_force = ""
            continue
        for block, share in pen.shares_of(step.segment):
            tilt = step.tilt_deg + (step.end_tilt_deg - step.tilt_deg) * share
            block += turned(tilt, step.begin_deg + (step.end_deg - step.begin_deg) * share)
            if in_force != (word := pen.feed_word(step_mm_s)):
                block, in_force = f"{block} {word}", word
            yield block


def _degrees(value: float) -> str:
    return number(value, _DEG_DECIMALS)
