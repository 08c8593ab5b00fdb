"""A profile as an old program has it: its feeds, its kerf, and no way to cut but that of each burn."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import replace

from kerfwise.postproc.check.reader.old import OldProgram
from kerfwise.postproc.check.reader.program import NcProgram
from kerfwise.rules.profile.corners_section import Corners
from kerfwise.rules.profile.cuts_section import Scrap
from kerfwise.rules.profile.profile import Profile


def tab_mm(profile: Profile, kerf_mm: float) -> float:
    """How far short of its begin a cut may stop for a tab: one about as wide as the profile has them, and the kerf."""
    tabs = profile.tabs()
    return 2 * tabs.width_mm + kerf_mm if tabs is not None and tabs.at_end else 0.0


def kerf_of(old: OldProgram, profile: Profile, asked_mm: float | None) -> float:
    """The kerf that is asked for, else that of the materials that the program describes, else the profile's, mm."""
    if asked_mm is not None:
        return asked_mm
    return max(old.kerfs_mm, default=profile.material.kerf_mm)


def at_its_feeds(profile: Profile, program: NcProgram) -> Profile:
    """The profile with the feeds and the pierce time that most of the program has."""
    machine = profile.machine
    cut: dict[float, float] = defaultdict(float)
    mark: dict[float, float] = defaultdict(float)
    pierce: dict[float, float] = defaultdict(float)
    for burn in program.burns:
        for segment, feed in zip(burn.path.segments, burn.step_feeds_mm_s, strict=False):
            (mark if burn.tool else cut)[feed] += segment.length_mm
        if burn.tool == 0:
            pierce[burn.held_s + burn.pierce_s] += 1
    if cut:
        machine = replace(machine, cut_feed_mm_s=_most(cut))
    if mark:
        machine = replace(machine, mark_feed_mm_s=_most(mark))
    if pierce:
        machine = replace(machine, pierce_time_s=_most(pierce))
    holes = replace(profile.small_holes, under="refuse")
    corners = profile.corners
    if len(cut) < 2:
        holes, corners = replace(holes, small_hole_feed=1.0), Corners()
    # no way to cut but that of each burn
    cuts = replace(profile.cuts, narrow="refuse", scrap=Scrap(), pierce_pass=None)
    return replace(profile, machine=machine, small_holes=holes, corners=corners, cuts=cuts)


def _most(counted: Mapping[float, float]) -> float:
    return max(counted, key=lambda value: (counted[value], -value))
