"""The heat that cutting each contour leaves in the sheet, known before anything is planned: zones may have a budget.

The torch leaves the profile's absorbed power in the sheet while it is on, as the simulation has it. For how long
depends on where and how a contour is entered and, by the model `blocks`, on the length of the program: the longest
time counts.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.compensation import compensated
from kerfwise.encoder.cut import Pierce
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest
from kerfwise.models.physics.timing.acceleration import Accelerated
from kerfwise.models.physics.timing.choose import machine_feeds, motion_of
from kerfwise.models.physics.timing.constant import ConstantFeed
from kerfwise.models.physics.timing.motion import Motion
from kerfwise.models.plan.plan import PlannedCut
from kerfwise.postproc.nc.body import count_blocks
from kerfwise.postproc.nc.plan_paths import Toolpath
from kerfwise.postproc.nc.toolpath import torch_path, unlit_on
from kerfwise.rules.profile.profile import Profile

J_PER_KJ = 1000.0


def contour_heat_kj(nest: Nest, candidates: Sequence[Candidate], profile: Profile) -> NDArray[np.float64]:
    """The most heat that cutting each contour leaves in the sheet, kJ, (n,); none for marks.

    No plan of these candidates, and no program of it, leaves more. At constant feeds it is exact for the entry that
    takes longest, where there are no links; with them a link as long as may be counts, for outer contours.
    """
    motion, machine = _slowest(nest, candidates, profile), profile.machine
    # On an axis that takes time to stop, a path that begins elsewhere stops there instead of where it was timed from.
    law, feed_mm_s = profile.corner_feed(), machine_feeds(profile).cut_mm_s
    if isinstance(motion, ConstantFeed):
        feed_mm_s = motion.feeds.cut_mm_s
    # The corner at which a ring is opened here, and the one that a lead makes with it, which no part of it shows.
    corner_mm = 0.0 if law is None else 4 * law.reach_mm * (1 / law.share - 1)
    stop_s = motion.feeds.cut_mm_s / motion.acceleration_mm_s2 if isinstance(motion, Accelerated) else 0.0
    links = profile.link_options()
    link_s = 0.0 if links is None else motion.run_s(_straight(links.longest_mm), False)
    rounds_s: dict[int, float] = {}
    longest_s = np.zeros(len(nest.contours))
    for candidate in candidates:
        number, contour = candidate.contour, nest.contours[candidate.contour]
        if contour.kind == "mark":
            continue
        if number not in rounds_s:
            ring = compensated(contour, profile.material.kerf_mm)
            corner_s = corner_mm / (feed_mm_s * contour.feed_share)
            rounds_s[number] = motion.run_s(ring.opened_at(0.0), False, contour.feed_share) + stop_s + corner_s
        leads = (lead for lead in (candidate.lead_in, candidate.lead_out) if lead is not None)
        leads_s = sum(motion.run_s(lead, False, contour.feed_share) for lead in leads)
        on_s = rounds_s[number] + leads_s + (machine.unpierced_s if candidate.unpierced else machine.pierce_time_s)
        if contour.kind == "outer" and links is not None:
            out_s = 0.0 if candidate.lead_out is None else motion.run_s(candidate.lead_out, False, contour.feed_share)
            on_s = max(on_s, rounds_s[number] + out_s + link_s / contour.feed_share)
        longest_s[number] = max(longest_s[number], on_s)
    return np.asarray(profile.heat.absorbed_power_w * longest_s / J_PER_KJ)


def _straight(length_mm: float) -> Curve:
    return Curve.of([(0.0, 0.0), (length_mm, 0.0)], closed=False)


def _slowest(nest: Nest, candidates: Sequence[Candidate], profile: Profile) -> Motion:
    """How the machine moves through the longest program that a plan of these candidates may have.

    A program states the feed that was set, and is simulated at that: where it is lower than what the machine would
    reach, it counts.
    """
    feeds, law = machine_feeds(profile), profile.time.feed_by_blocks
    if profile.time.model != "blocks" or law is None:
        return motion_of(profile, 0)
    feed = law.mm_s(_most_blocks(nest, candidates, profile))
    return ConstantFeed(replace(feeds, cut_mm_s=min(feeds.cut_mm_s, feed)))


def _most_blocks(nest: Nest, candidates: Sequence[Candidate], profile: Profile) -> int:
    """How many blocks a program has at the most: an entry may divide a line or arc, and the torch may have to wait."""
    limit = profile.temperature_limit()
    dwells = limit is not None and limit.dwells
    paths = list(_paths(nest, candidates, profile))
    each = profile.cuts.pierce_pass is not None
    pierces = [Pierce("", made.planned.cut.pierce, k) for k, made in enumerate(paths, 1) if each and not made.marks]
    return count_blocks(paths, nest, profile, pierces) + (2 if dwells else 1) * len(nest.contours)


def _paths(nest: Nest, candidates: Sequence[Candidate], profile: Profile) -> Iterator[Toolpath]:
    """A path for every contour, of the candidate whose leads have most lines and arcs."""
    chosen: dict[int, Candidate] = {}
    for candidate in candidates:
        if candidate.contour not in chosen or _lead_moves(candidate) > _lead_moves(chosen[candidate.contour]):
            chosen[candidate.contour] = candidate
    for number, candidate in chosen.items():
        contour = nest.contours[number]
        cut = candidate.as_cut(contour.id)
        kerf_mm = profile.material.kerf_mm
        path, unlit = torch_path(contour, cut, kerf_mm), unlit_on(contour, cut, kerf_mm)
        planned = PlannedCut(cut, contour.part, contour.kind, candidate.cut_mm)
        yield Toolpath(planned, path, contour.kind == "mark", candidate.unpierced, contour.feed_share, unlit)


def _lead_moves(candidate: Candidate) -> int:
    return sum(len(lead.segments) for lead in (candidate.lead_in, candidate.lead_out) if lead is not None)
