"""What does not go together in a profile, or with a nest: common cuts, ways in stretches, and bevels, each refused."""

from __future__ import annotations

from collections.abc import Iterator

from kerfwise.encoder.bevels.cut_nest import bevelled
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest

from .profile import Profile

# Whether common edges can be cut once as a profile asks.


def expect_common_cuts(profile: Profile) -> None:
    """Refuse what does not go together with common cuts.

    Raises
    ------
    InputError
        With what to change.
    """
    strict = profile.rules_of_direction("outer")
    if profile.common_options() is not None and strict and profile.cuts.common.good_side == "part":
        raise InputError(
            f"cuts.common: {' and '.join(strict)} leaves outer contours one direction, so that of two parts with a "
            "common edge one gets the bad side of the kerf: free the direction, or accept that "
            "(cuts.common.good_side: any)",
            file=profile.file or None,
        )


# Whether rows can be cut as snakes as a profile asks.


def expect_snakes(profile: Profile, nest: Nest | None = None) -> None:
    """Refuse what does not go together with snakes.

    Raises
    ------
    InputError
        With what to change.
    """
    if (group := profile.cuts.in_stretches) and (why := next(_no_snakes(profile, nest), None)):
        raise InputError(f"cuts.{group}: {why}, or leave cuts.{group} out", file=profile.file or None)


def _no_snakes(profile: Profile, nest: Nest | None) -> Iterator[str]:
    cuts, limit = profile.cuts, profile.temperature_limit()
    if profile.tabs() is not None:
        yield "a part that tabs hold is cut in one round: turn off the rule that leaves tabs"
    if cuts.pierce_pass is not None:
        yield "what is left of a part begins at no hole: say cuts.pierce_pass: off"
    if profile.machine.torches.several:
        yield "stretches are planned for one torch: say machine: {torches: {count: 1}}"
    if cuts.scrap.grid_mm is not None or cuts.scrap.remnant is not None or (nest is not None and nest.scrap):
        yield "a way over the gaps of a row may cut metal off in which scrap lines are cut: leave these out"
    if profile.corner_feed() is not None:
        yield "slower corners are counted for whole rounds: say corners.corner_feed: 1"
    if limit is not None:
        yield f"{limit.rule} simulates whole rounds: turn it off"
    if profile.prices_overheats:
        yield "the price of heat is simulated for whole rounds: say objective: {heat: 0}"
    if profile.objective.distortion:
        yield "the price of distortion is simulated for whole rounds: say objective: {distortion: 0}"


# Whether bevels can be cut as a profile asks.


def expect_bevels(profile: Profile, nest: Nest | None = None, resumed: bool = False) -> None:
    """Refuse what does not go together with bevels: of a profile that has a head for them, or of a nest that has some.

    Raises
    ------
    InputError
        With what to change.
    """
    contours = [] if nest is None else list(bevelled(nest))
    section = profile.cuts.bevel
    if section.head is not None and section.tilt == section.turn:
        raise InputError(
            f"cuts.bevel: tilt and turn are both {section.tilt}: give each axis its own", file=profile.file or None
        )
    if not contours:
        return
    if section.head is None:
        first = contours[0]
        raise InputError(
            f"{first.id} has a bevel ({first.bevel}), and the profile has no head that tilts: say cuts: {{bevel: "
            "{head: tilting}}, or take the bevel out of the nest",
            file=(nest.file if nest is not None else "") or None,
        )
    if section.head == "block" and len(kinds := {str(b) for c in contours for b in c.bevel_of_edge if b}) > 1:
        raise InputError(
            f"the block of torches is set by hand to one bevel, and the nest has {' and '.join(sorted(kinds))}: cut it "
            "as two nests, or take a head that tilts",
            file=(nest.file if nest is not None else "") or None,
        )
    if (why := next(_no_bevels(profile, nest, resumed), None)) is not None:
        raise InputError(f"{contours[0].id} has a bevel: {why}", file=profile.file or None)


def _no_bevels(profile: Profile, nest: Nest | None, resumed: bool) -> Iterator[str]:
    cuts, limit = profile.cuts, profile.temperature_limit()
    if profile.tabs() is not None:
        yield "a tilted torch leaves no tabs: turn off the rule that leaves them"
    if cuts.pierce_pass is not None:
        yield "holes are not pierced for a tilted torch beforehand: say cuts.pierce_pass: off"
    if profile.machine.torches.several:
        yield "one head tilts: say machine: {torches: {count: 1}}"
    if cuts.links.longest_mm > 0:
        yield "the torch does not stay on from a bevel to the next contour: say cuts: {links: {longest: 0 mm}}"
    if profile.common_options() is not None:
        yield "an edge with a bevel is no common edge: say cuts: {common: {shortest: off}}"
    if cuts.in_stretches:
        yield f"a contour with a bevel is cut in whole rounds: leave cuts.{cuts.in_stretches} out"
    if cuts.narrow == "slit":
        yield "slots of parts with bevels are not opened by one pass: say cuts.narrow: refuse, or leave"
    if cuts.scrap.grid_mm is not None or cuts.scrap.remnant is not None or (nest is not None and nest.scrap):
        yield "loops lie where scrap lines are cut: leave these out"
    if nest is not None and nest.bridges:
        yield "parts with bevels are not joined by bridges: leave the bridges out"
    if profile.corner_feed() is not None:
        yield "slower corners are counted for upright torches: say corners.corner_feed: 1"
    if limit is not None:
        yield f"{limit.rule} simulates upright torches: turn it off"
    if profile.prices_overheats:
        yield "the price of heat is simulated for upright torches: say objective: {heat: 0}"
    if profile.objective.distortion:
        yield "the price of distortion is simulated for upright torches: say objective: {distortion: 0}"
    if resumed:
        yield "a nest with bevels is not gone on with after a stop: cut it from the old program"
