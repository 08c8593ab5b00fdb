"""How far parts lie from each other and from the sheet's edge: a kerf and the web of the profile, unless it is said."""

from __future__ import annotations

from dataclasses import replace

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.tolerance import tolerance_mm
from kerfwise.nesting.pose import Placed
from kerfwise.nesting.wanted import Common, PartType, Spacing, Wanted
from kerfwise.rules.profile.profile import Profile

BESIDE_MM = 0.02
"""Metal that stays between the torch's kerf and the edge of the sheet, at the least: the torch runs on the sheet."""
_ROUNDING_MM = 1e-9


def spacing_of(profile: Profile, gap_mm: float | None = None, edge_mm: float | None = None) -> Spacing:
    """The distances of a profile; each may be given in its place.

    Raises
    ------
    InputError
        If the torch would run off the sheet, or along its edge: `solve` refuses that.

    Examples
    --------
    >>> from kerfwise.rules.profile.load import load_profile
    >>> spacing_of(load_profile()), spacing_of(load_profile(), gap_mm=0.0)
    (Spacing(gap_mm=7.5, edge_mm=10.0, common=None), Spacing(gap_mm=0.0, edge_mm=10.0, common=None))

    The least distance to the edge that the message names is allowed:

    >>> spacing_of(load_profile("laser-st10kp-2mm"), edge_mm=0.12).edge_mm
    0.12
    """
    kerf_mm = profile.material.kerf_mm
    web_mm = profile.length_mm(profile.nesting.web_mm)
    edge = profile.length_mm(profile.nesting.edge_mm) if edge_mm is None else edge_mm
    least_mm = kerf_mm / 2 + BESIDE_MM
    if edge < least_mm - _ROUNDING_MM:
        raise InputError(
            f"{'nesting.edge' if edge_mm is None else '--edge'}: {edge:g} mm from parts to the edge of the sheet, and "
            f"the torch runs half a kerf, {kerf_mm / 2:g} mm, beside each part: give {least_mm:g} mm or more",
            file=(profile.file or None) if edge_mm is None else None,
        )
    return Spacing(kerf_mm + web_mm if gap_mm is None else gap_mm, edge, common_of(profile))


def burnt(profile: Profile, spacing: Spacing) -> str:
    """A sentence where parts lie nearer than the cut is wide; empty where they do not.

    Examples
    --------
    >>> from kerfwise.rules.profile.load import load_profile
    >>> burnt(load_profile(), Spacing(0.2, 10.0))
    'parts lie 0.2 mm apart, and the cut is 1.5 mm wide: it burns into the neighbour, which only wood bears'
    """
    kerf_mm = profile.material.kerf_mm
    if spacing.gap_mm >= kerf_mm:
        return ""
    return (
        f"parts lie {spacing.gap_mm:g} mm apart, and the cut is {kerf_mm:g} mm wide: it burns into the neighbour, "
        "which only wood bears"
    )


def common_of(profile: Profile) -> Common | None:
    """How far parts lie apart whose edges are cut once; None where the profile asks for no common cuts.

    The tolerance is the profile's, but no more than that of the torch's path: edges further off are not cut once.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from kerfwise.rules.profile.cuts_section import Common as CommonCuts
    >>> from kerfwise.rules.profile.cuts_section import Cuts
    >>> from kerfwise.rules.profile.load import load_profile
    >>> common_of(replace(load_profile("laser-st10kp-2mm"), cuts=Cuts(common=CommonCuts(20.0, gap_tolerance_mm=0.3))))
    Common(apart_mm=0.2, shortest_mm=20.0, tolerance_mm=0.05)
    """
    asked, kerf_mm = profile.common_options(), profile.material.kerf_mm
    return None if asked is None else Common(kerf_mm, asked.shortest_mm, min(asked.gap_mm, tolerance_mm(kerf_mm)))


def with_held(wanted: Wanted, profile: Profile) -> Wanted:
    """The order, with those parts marked that tabs of the profile hold, in any way that they may lie."""
    tabs = profile.tabs()
    if tabs is None:
        return wanted

    def held(kind: PartType) -> bool:
        return any(tabs.reason(Placed(0, pose, 0.0, 0.0).part(kind.part, kind.name)) for pose in kind.poses)

    return replace(wanted, types=tuple(replace(kind, held=held(kind)) for kind in wanted.types))
