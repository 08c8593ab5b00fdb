"""Whether common edges can be cut once as a profile asks."""

from __future__ import annotations

from kerfwise.encoder.errors import InputError

from .profile import Profile


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
