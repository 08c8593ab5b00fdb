"""Layouts of small orders with answers that are plain to see, and of random ones by the check."""

from __future__ import annotations

import pytest

from kerfwise.apps.nesting.nests import Nested, nests_from
from kerfwise.apps.nesting.placement.blocks import sides_on_axes
from kerfwise.apps.nesting.placement.demand import Demand, PartType, Spacing, Stock
from kerfwise.apps.nesting.placement.fill import LEFT, Room, put_best
from kerfwise.apps.nesting.placement.layout import Layout, Sheetful, allot, squeeze_last_sheet
from kerfwise.apps.nesting.placement.nofit import Placed, Pose
from kerfwise.apps.nesting.placement.rounds import Effort, Patterns, best_layout, layouts
from kerfwise.apps.nesting.placement.shapes import Shapes
from kerfwise.benchmarks.nesting_lists import least_worth
from kerfwise.encoder.nest import Part, Sheet
from kerfwise.rules.case import circle, part, rect
from kerfwise.tests.apps.nesting.placement.random_lists import random_order

ONE = Effort(1)
TOUCHING = Spacing(0.0, 0.0)


def lay_out(asked: Demand, spacing: Spacing, effort: Effort) -> Nested:
    return nests_from(best_layout(asked, spacing, effort))


def wanted(*types: PartType, stock: tuple[Stock, ...]) -> Demand:
    return Demand(types, stock)


def of(shape: Part, quantity: int, **more: object) -> PartType:
    return PartType(shape.id, shape, quantity, **more)  # type: ignore[arg-type]


def sheet(width: float, height: float, count: int | None = None, **more: object) -> Stock:
    return Stock(f"{width:g}x{height:g}", Sheet.rectangle(width, height), count, **more)  # type: ignore[arg-type]


def test_what_fits_exactly_fits() -> None:
    nested = lay_out(
        wanted(of(part("A", rect(0, 0, 50, 40)), 12, turns_deg=(0.0,)), stock=(sheet(200, 120),)), TOUCHING, ONE
    )
    assert [len(nest.parts) for nest in nested.nests] == [12]
    assert nested.faults == ()


def test_a_kerf_and_a_web_lie_between_parts_and_the_edge_is_kept() -> None:
    nested = lay_out(wanted(of(part("A", rect(0, 0, 50, 50)), 4), stock=(sheet(126, 126),)), Spacing(6.0, 10.0), ONE)
    bounds = [part.outer.polygon.bounds for part in nested.nests[0].parts]
    assert sorted((round(x, 2), round(y, 2)) for x, y, _, _ in bounds) == [(10, 10), (10, 66), (66, 10), (66, 66)]


def test_parts_lie_in_holes_of_parts_in_holes_of_parts() -> None:
    rings = [part(f"R{r}", circle(0, 0, r), [circle(0, 0, r - 8)]) for r in (90, 78, 66, 54)]
    nested = lay_out(wanted(*(of(ring, 1) for ring in rings), stock=(sheet(186, 186, 1),)), Spacing(2.0, 0.2), ONE)
    assert nested.layout.missing == (0, 0, 0, 0)
    assert nested.faults == ()


def test_remnants_go_first_and_the_smallest_first() -> None:
    stock = (sheet(1000, 1000), sheet(300, 300, 1, remnant=True), sheet(150, 150, 1, remnant=True))
    nested = lay_out(wanted(of(part("A", rect(0, 0, 100, 100)), 8), stock=stock), Spacing(2.0, 0.0), ONE)
    assert [full.stock.name for full in nested.layout.sheets] == ["150x150", "300x300", "1000x1000"]


def test_the_cheaper_sheet_is_taken_where_both_do() -> None:
    stock = (sheet(200, 200, price=50.0), sheet(220, 200, price=20.0))
    nested = lay_out(wanted(of(part("A", rect(0, 0, 90, 90)), 4), stock=stock), Spacing(2.0, 2.0), ONE)
    assert [full.stock.name for full in nested.layout.sheets] == ["220x200"]


def test_sheets_are_bought_as_a_set_where_that_is_cheaper() -> None:
    """The large sheet is the cheapest for what it holds, and leaves one part; two small ones cost less."""
    stock = (sheet(300, 100, price=30.0), sheet(200, 100, price=21.0))
    asked = wanted(of(part("A", rect(0, 0, 100, 100)), 4), stock=stock)
    first, second = allot(asked, Shapes(asked.types, 0.0), TOUCHING, [0], LEFT), best_layout(asked, TOUCHING, ONE)
    assert [full.stock.name for full in first.sheets] == ["300x100", "200x100"]
    assert [full.stock.name for full in second.sheets] == ["200x100", "200x100"]
    assert second.score[1] == least_worth(asked, TOUCHING)


def test_no_more_sheets_are_bought_than_there_are() -> None:
    stock = (sheet(300, 100, price=30.0), sheet(200, 100, 1, price=21.0), sheet(400, 100, 1, remnant=True))
    asked = wanted(of(part("A", rect(0, 0, 100, 100)), 8), stock=stock)
    nested = nests_from(best_layout(asked, TOUCHING, Effort(4)))
    assert [full.stock.name for full in nested.layout.sheets] == ["400x100", "300x100", "200x100"]
    assert nested.faults == ()


def test_what_has_no_room_is_missing_and_counted() -> None:
    nested = lay_out(wanted(of(part("A", rect(0, 0, 90, 90)), 7), stock=(sheet(200, 200, 1),)), Spacing(2.0, 2.0), ONE)
    assert nested.layout.missing == (3,)
    assert nested.faults == ()


def test_arcs_stay_arcs_and_are_turned_over() -> None:
    shape = part("A", [(0, 0), (80, 0, 0.5), (80, 20), (0, 20, -0.3)], [circle(20, 10, 4)])
    kind = of(shape, 1, turns_deg=(90.0,), mirror=True)
    nested = lay_out(wanted(kind, stock=(sheet(300, 300),)), Spacing(2.0, 2.0), ONE)
    made = nested.nests[0].parts[0]
    assert [segment.is_arc for segment in made.outer.curve.segments] == [False, True, False, True]
    assert made.polygon.area == pytest.approx(shape.polygon.area, rel=1e-6)
    assert nested.faults == ()


def test_those_of_a_lower_number_are_placed_first() -> None:
    small = of(part("small", rect(0, 0, 90, 90)), 1, priority=1)
    large = of(part("large", rect(0, 0, 100, 100)), 1, priority=2)
    nested = lay_out(wanted(large, small, stock=(sheet(110, 110, 1),)), Spacing(2.0, 2.0), Effort(3))
    assert nested.layout.missing == (1, 0)


def test_the_same_seed_gives_the_same_nests() -> None:
    asked, spacing = random_order(3)
    first, again = (nests_from(best_layout(asked, spacing, Effort(3, seed=4))).texts for _ in range(2))
    assert first == again


def test_the_best_so_far_is_kept_when_told_to_stop() -> None:
    asked, spacing = random_order(3)
    seen = []
    best_layout(asked, spacing, Effort(10), lambda number, best: seen.append(number) is not None)
    assert seen == [1]


@pytest.mark.parametrize("seed", range(4))
def test_pavlov_s_method_lays_random_orders_without_a_fault(seed: int) -> None:
    asked, spacing = random_order(seed)
    assert nests_from(best_layout(asked, spacing, Effort(2, seed=seed, method="pavlov"))).faults == ()


def test_a_part_that_may_be_turned_at_will_lies_where_no_quarter_turn_would_lay_it() -> None:
    """A bar of 120 mm drawn at 45 degrees, on a sheet of 130 × 40 mm."""
    slanted = part("bar", [(0, 0), (84.853, 84.853), (77.782, 91.924), (-7.071, 7.071)])
    asked = wanted(of(slanted, 2, free=True, turns_deg=sides_on_axes(slanted)), stock=(sheet(130, 40, 1),))
    nested = nests_from(best_layout(asked, Spacing(1.0, 1.0), Effort(1, method="pavlov")))
    assert nested.layout.missing == (0,)
    assert nested.faults == ()


@pytest.mark.parametrize("seed", range(12))
def test_the_check_finds_nothing_in_random_orders(seed: int) -> None:
    asked, spacing = random_order(seed)
    layout = best_layout(asked, spacing, Effort(1, seed=seed))
    assert nests_from(layout).faults == ()
    assert any(layout.missing) or layout.score[1] >= least_worth(asked, spacing)


def test_the_last_sheet_is_squeezed_so_that_a_larger_rectangle_is_left() -> None:
    """Two columns of five leave 100 × 1000 mm of the sheet, one row of ten leaves 1000 × 900 mm."""
    kind = of(part("A", rect(0, 0, 100, 100)), 10)
    asked = wanted(kind, stock=(sheet(1000, 1000),))
    shapes = Shapes(asked.types, 0.0)
    square = [Placed(0, Pose(), 100.0 * (k % 4), 100.0 * (k // 4)) for k in range(10)]
    first = Layout(asked, TOUCHING, (Sheetful(asked.stocks[0], 0, tuple(square)),))
    made = squeeze_last_sheet(first, shapes, 8, 1)
    assert first.remnant_mm2 == 700_000
    assert made.remnant_mm2 == 900_000
    assert nests_from(made).faults == ()


def test_sheets_of_several_rounds_are_combined_so_that_all_parts_lie_on_the_cheapest() -> None:
    """No round has both the sheet of large parts and the sheet of small ones; the cover takes them together."""
    large, small = of(part("L", rect(0, 0, 100, 100)), 1), of(part("S", rect(0, 0, 50, 100)), 3)
    asked = wanted(large, small, stock=(sheet(150, 100, price=10.0), sheet(400, 100, price=90.0)))
    stock, patterns = asked.stocks[0], Patterns(asked, Shapes(asked.types, 0.0), TOUCHING)
    one = (Placed(0, Pose(), 0.0, 0.0), Placed(1, Pose(), 100.0, 0.0))
    three = tuple(Placed(1, Pose(), 50.0 * k, 0.0) for k in range(3))
    for placed in (one, three):
        patterns.add(Sheetful(stock, 0, placed))
    made = patterns.cover(Layout(asked, TOUCHING, ()), 1)
    assert made.missing == (0, 0)
    assert made.score[1] == 20.0 == best_layout(asked, TOUCHING, ONE).score[1]
    assert nests_from(made).faults == ()


def test_the_first_round_breaks_off_too_when_told_to_stop() -> None:
    asked, spacing = random_order(3)
    calls: list[int] = []
    [made] = layouts(asked, spacing, Effort(10), stopped=lambda: calls.append(1) is None and len(calls) > 3)
    assert any(made.missing)
    assert nests_from(made).faults == ()


def test_no_place_comes_of_rounding() -> None:
    """What the edges of two hollow shapes sweep leaves slivers, in which the one would lie in the other."""
    hollow = part(
        "H", [(0, 0), (276.75, 11.3), (270.1, 215.2), (180.3, 170.7), (140.9, 60.1), (88.8, 181.3), (7.7, 199.9)]
    )
    slim = part("S", [(0, 0), (123.3, 3.1), (117.7, 30.75), (61.1, 21.9), (5.3, 33.3)])
    shapes = Shapes((of(hollow, 4), of(slim, 20)), 5.99)
    room = Room(shapes, Sheet.rectangle(700, 500), Spacing(5.99, 0.0))
    for kind in (0, 1):
        for _ in range(6):
            places = [
                (key, shift) for pose in shapes.poses(kind) for key in [(kind, pose)] for shift in room.places(key)
            ]
            assert all(Room.put(copy(room), key, shift) for key, shift in places)
            put_best(room, kind, LEFT)


def copy(room: Room) -> Room:
    """The room, so that a part can be laid on trial."""
    made = Room(room.shapes, room.sheet, room.spacing)
    made.take(room.placed)
    return made
