"""A nest from burns: which rounds are parts, which their holes, where marks belong, and what makes no nest."""

import dataclasses

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.check.reader.program import Burn
from kerfwise.postproc.old.contours import fits_kerf, name_by_comments, nest_of
from kerfwise.postproc.old.loops import AmbiguousNest
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.tests.postproc.plans import plate


def burns_of(plan: Nest, kerf_mm: float = 0.0) -> list[Burn]:
    """A burn once round each contour."""
    from kerfwise.encoder.torch_path import compensated

    made = []
    for k, contour in enumerate(plan.contours, 1):
        path = compensated(contour, kerf_mm).opened_at(0.0) if contour.encloses else contour.curve
        tool = 0 if contour.encloses else 1
        made.append(Burn(tool, 10 * k, path, 0.0, 0.0, f"CUT {k} {contour.id} ZONE 1 CW"))
    return made


@pytest.mark.parametrize("kerf_mm", [0.0, 1.5])
def test_kinds_parts_and_shapes_come_back(kerf_mm: float) -> None:
    drawn = plate()
    burns = burns_of(drawn, kerf_mm)
    told = nest_of(burns, kerf_mm, (600, 200))
    assert fits_kerf(told, kerf_mm)
    named = name_by_comments(told, [burn.comment for burn in burns])
    assert named is not None
    assert set(named.nest.index) == set(drawn.index)
    for contour in drawn.contours:
        again = named.nest.contour(contour.id)
        assert (again.kind, again.part) == (contour.kind, contour.part)
        rounded_mm = 0.21 * kerf_mm  # the kerf leaves the corners of holes round
        assert again.line.hausdorff_distance(contour.line) < 0.01 + rounded_mm
        assert burns[named.burn_of[contour.id]].comment.split()[2] == contour.id


def test_names_that_do_not_fit_what_is_cut_are_not_taken() -> None:
    burns = burns_of(plate())
    wrong = [dataclasses.replace(burn, comment=burn.comment.replace("hole1", "outer")) for burn in burns]
    assert name_by_comments(nest_of(wrong, 0.0), [burn.comment for burn in wrong]) is None


def test_square_corners_outside_are_no_path_of_a_kerf() -> None:
    burns = burns_of(nest(200, 200, part("A", rect(20, 20, 100, 100))))
    assert not fits_kerf(nest_of(burns, 1.5), 1.5)


def test_a_sheet_is_laid_around_the_burns_and_that_is_said() -> None:
    told = nest_of(burns_of(nest(200, 200, part("A", rect(20, 30, 100, 60)))), 0.0)
    assert told.nest.sheet.bounds == (0, 10, 140, 110)
    assert not told.nest.sheet.stated
    assert "--sheet" in told.nest.notes[0].text


def test_a_sheet_that_does_not_hold_the_burns_is_refused() -> None:
    burns = burns_of(nest(200, 200, part("A", rect(20, 30, 100, 60))))
    with pytest.raises(InputError, match="beyond that sheet"):
        nest_of(burns, 0.0, (100, 100))


@pytest.mark.parametrize(
    ("contours", "line", "why"),
    [
        ([Curve.of(rect(0, 0, 50, 50)), Curve.of(rect(30, 30, 50, 50))], 10, "overlap"),
        ([Curve.of(rect(0, 0, 50, 50)), Curve.of([(0, 0), (9, 9)], closed=False)], 20, "does not close"),
        ([Curve.of(rect(0, 0, 50, 50)), Curve.of(rect(0, 0, 50, 50))], 20, "the burn of line 10 has cut"),
    ],
)
def test_burns_that_make_no_nest(contours: list[Curve], line: int, why: str) -> None:
    paths = [c.opened_at(0.0) if c.closed else c for c in contours]
    burns = [Burn(0, 10 * k, path, 0.0, 0.0, "") for k, path in enumerate(paths, 1)]
    with pytest.raises(AmbiguousNest, match=why) as caught:
        nest_of(burns, 0.0)
    assert caught.value.unclear[0].line == line


def test_a_mark_beside_all_parts_is_of_no_nest() -> None:
    burns = burns_of(nest(200, 200, part("A", rect(20, 20, 50, 50), [circle(45, 45, 9)])))
    burns.append(Burn(1, 99, Curve.of([(100, 100), (120, 100)], closed=False), 0.0, 0.0, ""))
    with pytest.raises(AmbiguousNest, match="marks no part"):
        nest_of(burns, 0.0)
