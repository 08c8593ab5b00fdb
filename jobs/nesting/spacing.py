"""How far parts lie from each other and from the sheet's edge: a kerf and the web of the profile, unless it is said."""

from __future__ import annotations

from kerfwise.nesting.wanted import Spacing
from kerfwise.rules.profile.profile import Profile


def spacing_of(profile: Profile, gap_mm: float | None = None, edge_mm: float | None = None) -> Spacing:
    """The distances of a profile; each may be given in its place.

    Examples
    --------
    >>> from kerfwise.rules.profile.profile import load_profile
    >>> spacing_of(load_profile()), spacing_of(load_profile(), gap_mm=0.0)
    (Spacing(gap_mm=7.5, edge_mm=10.0), Spacing(gap_mm=0.0, edge_mm=10.0))
    """
    web_mm = profile.length_mm(profile.nesting.web_mm)
    edge = profile.length_mm(profile.nesting.edge_mm) if edge_mm is None else edge_mm
    return Spacing(profile.material.kerf_mm + web_mm if gap_mm is None else gap_mm, edge)
