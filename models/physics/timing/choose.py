"""From a profile to its model of motion."""

from __future__ import annotations

from dataclasses import replace

from kerfwise.rules.profile.profile import Profile

from .acceleration import Accelerated
from .constant import ConstantFeed, Feeds
from .motion import Motion


def machine_feeds(profile: Profile) -> Feeds:
    """The machine's speeds and waits as the profile sets them."""
    machine = profile.machine
    return Feeds(
        machine.cut_feed_mm_s,
        machine.mark_feed_mm_s,
        machine.travel_mm_s,
        machine.pierce_time_s,
        machine.mark_time_s,
        machine.unpierced_s,
        profile.corner_feed(),
    )


def feeds_of(profile: Profile) -> Feeds:
    """The speeds that plans are made with: none that the machine would pass, however short the program.

    What keeps a lag in seconds at these speeds keeps it at any that is lower, so it holds by every model of time.
    """
    feeds, time = machine_feeds(profile), profile.time
    if time.model != "blocks" or time.feed_by_blocks is None:
        return feeds
    return replace(feeds, cut_mm_s=max(feeds.cut_mm_s, time.feed_by_blocks.fastest_mm_s))


def motion_of(profile: Profile, nc_blocks: int) -> Motion:
    """How the machine moves through a program of so many NC blocks, by the model that the profile names."""
    feeds, time = machine_feeds(profile), profile.time
    if time.model == "acceleration":
        return Accelerated(feeds, time.acceleration_mm_s2, time.corner_deviation_mm)
    if time.model == "blocks" and time.feed_by_blocks is not None:
        law = time.feed_by_blocks
        feed = law.mm_s(nc_blocks)
        words = f"feed by blocks, {law.name or 'own law'}, {feed * 60:.0f} mm/min at {nc_blocks}"
        return ConstantFeed(replace(feeds, cut_mm_s=feed), words)
    return ConstantFeed(feeds)
