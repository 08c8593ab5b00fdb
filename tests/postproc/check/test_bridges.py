"""Bridges are judged by what is drawn: outline, holes and strips are put together by the check itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from kerfwise.encoder.bridges import with_bridges
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Bridge, Nest, Part
from kerfwise.encoder.small_holes import Under
from kerfwise.postproc.check.loose_metal import broken_bridges
from kerfwise.postproc.check.small_features import judged_nest
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.sections import SmallHoles

A = part("A", rect(20, 20, 60, 60), holes=[rect(30, 30, 20, 20), rect(60, 60, 4, 4)])
B = part("B", rect(82, 20, 60, 60))
STRIPS = (Bridge(("A", "B"), (75, 40), (90, 40), 4.0, 1), Bridge(("A", "B"), (75, 47), (90, 47), 4.0, 2))


def joined(count: int = 1) -> Nest:
    return with_bridges(replace(nest(400, 200, A, B), bridges=STRIPS[:count]))


def told(sheet: Nest) -> list[str]:
    return [v.text for v in broken_bridges(sheet, [], 1.5)]


def with_part(sheet: Nest, change: Callable[[Part], Part]) -> Nest:
    return replace(sheet, parts=(change(sheet.parts[0]), *sheet.parts[1:]))


@pytest.mark.parametrize("count", [1, 2])
def test_what_is_as_drawn_passes(count: int) -> None:
    assert told(joined(count)) == []


WRONG_HOLES: dict[str, tuple[Callable[[Part], Part], str]] = {
    "lost": (lambda p: replace(p, holes=p.holes[1:]), "(40.0, 40.0)"),
    "moved": (
        lambda p: replace(p, holes=(replace(p.holes[0], curve=p.holes[0].curve.moved(3, 0)), *p.holes[1:])),
        "(51.5, 40.0)",
    ),
    "one more": (
        lambda p: replace(p, holes=(*p.holes, replace(p.holes[1], curve=p.holes[1].curve.moved(-38, 0)))),
        "(24.0, 62.0)",
    ),
    "pocket lost": (lambda p: replace(p, holes=p.holes[:-1]), "(81.0, 43.5)"),
}


@pytest.mark.parametrize("case", WRONG_HOLES)
def test_a_hole_that_the_joined_part_does_not_have_is_told(case: str) -> None:
    change, at = WRONG_HOLES[case]
    assert told(with_part(joined(2), change)) == [
        f"the holes in A+B.outer are not those that its parts and bridges leave at {at}"
    ]


@pytest.mark.parametrize("share", [0.5, 1.5])
def test_a_wrong_rectangle_of_strips_cannot_hide(monkeypatch: pytest.MonkeyPatch, share: float) -> None:
    """Where what reads and joins takes strips for narrower or wider than they are, the check does not follow."""
    side = Bridge.side

    def wrong(self: Bridge, left: bool, beyond_mm: float = 0.0) -> tuple[Point, Point]:
        return side(replace(self, width_mm=share * self.width_mm), left, beyond_mm)

    monkeypatch.setattr(Bridge, "side", wrong)
    (text,) = told(joined())
    assert text.startswith("A+B.outer is not the outline of its parts and bridges at (")


@pytest.mark.parametrize("under", ["spot", "skip"])
def test_small_holes_and_pockets_that_a_profile_does_not_cut_are_as_drawn(under: Under) -> None:
    profile = load_profile()
    profile = replace(profile, small_holes=SmallHoles(min_hole=5.0, under=under))
    judged = judged_nest(joined(2), profile).nest
    assert [c.id for c in judged.contours if c.kind == "hole"] == ["A.hole1"]
    assert told(judged) == []
