"""Whether common edges can be cut once as a profile asks, on a nest."""

from __future__ import annotations

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest

from .profile import Profile


def expect_common_cuts(profile: Profile, nest: Nest, resumes: bool) -> None:
    """Refuse what does not go together with common cuts; `resumes` says that some of the nest is cut already.

    Raises
    ------
    InputError
        With what to change.
    """
    if profile.common_options() is not None and (why := _why_not(profile, nest, resumes)):
        raise InputError(f"cuts.common: {why}", file=profile.file or None)


def _why_not(profile: Profile, nest: Nest, resumes: bool) -> str | None:
    strict = profile.rules_of_direction("outer")
    if strict and profile.cuts.common.good_side == "part":
        return (
            f"{' and '.join(strict)} leaves outer contours one direction, so that of two parts with a common edge one "
            "gets the bad side of the kerf: free the direction, or accept that (cuts.common.good_side: any)"
        )
    tabs = profile.tabs()
    held = [part.id for part in nest.parts if tabs is not None and tabs.reason(part) is not None]
    if held:
        shown = ", ".join(held[:3]) + (", …" if len(held) > 3 else "")
        return f"tabs hold {shown}, and a neighbour with a common edge could cut them: turn one of the two off"
    if profile.corner_feed() is not None:
        return "slower corners (corner_feed) are worked out for whole contours only: turn one of the two off"
    if profile.cuts.pierce_pass is not None:
        return "a pierce pass has nothing to pierce where a cut begins in a kerf: turn one of the two off"
    if resumes:
        return "a program that goes on after a stop cannot have common cuts: say cuts.common.shortest: off"
    return None
