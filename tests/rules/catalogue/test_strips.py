"""Narrow strips and islands: what is found wrong with one order is wrong in every order that has it, and only there."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from itertools import permutations
from random import Random
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from kerfwise.arrays import Bools, Ints
from kerfwise.encoder.geometry.segment import Box
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.catalogue.no_narrow_strips import NoNarrowStrips, NoNarrowStripsOptions
from kerfwise.rules.catalogue.no_narrow_strips import strips as strips_and_islands
from kerfwise.rules.catalogue.no_narrow_strips.strips import Islands, Strips
from kerfwise.rules.judging.metal import ISLAND_STRIPS, Badly, Metal
from kerfwise.tests.rules.judging.plain_strips import told_plainly
from kerfwise.tests.rules.test_statements_agree import sheets
from kerfwise.tests.tools.amount import examples

RULE = NoNarrowStrips()
CHANNEL = [(0, 0), (84, 0), (84, 10), (10, 10), (10, 76), (84, 76), (84, 86), (0, 86)]
CHANNELS = nest(
    390, 220,
    part("L", [(x + 5, y + 5) for x, y in CHANNEL]), part("R", [(x + 230, y + 5) for x, y in CHANNEL]),
    part("S", rect(117, 115, 30, 30)), part("T", rect(117, 155, 30, 30)),
)  # fmt: skip
FAR = nest(
    2000, 100,
    part("X", rect(400, 5, 80, 90)), part("A", rect(1500, 10, 80, 80)),
    part("B", rect(10, 10, 80, 80)), part("C", rect(200, 10, 80, 80)),
)  # fmt: skip
APART = nest(
    400, 300,
    part("A", rect(20, 20, 90, 60)), part("B", rect(20, 100, 90, 60)), part("C", rect(180, 130, 30, 30)),
    part("D", rect(125, 20, 30, 30)), part("E", rect(125, 180, 100, 60)),
)  # fmt: skip


def told_alike(sheet: Nest, options: NoNarrowStripsOptions) -> int:
    """How many orders are lawful, once every order is seen to break no-goods exactly where it is unlawful itself."""
    outers = [p.outer.id for p in sheet.parts]
    found = {order: RULE.no_goods(sheet, order, options) for order in permutations(outers)}
    no_goods = {(wrong.out, wrong.left): wrong.sentence for of in found.values() for wrong in of}
    for order, wrong in found.items():
        at = {name: k for k, name in enumerate(order)}
        broken = [s for (out, left), s in no_goods.items() if max(at[x] for x in out) < min(at[x] for x in left)]
        assert bool(broken) == bool(wrong), (order, broken)
    return sum(not wrong for wrong in found.values())


@pytest.mark.parametrize(("sheet", "strip_mm"), [(CHANNELS, 140.0), (FAR, 60.0), (APART, 160.0)])
def test_a_no_good_holds_in_every_order(sheet: Nest, strip_mm: float) -> None:
    assert 0 < told_alike(sheet, NoNarrowStripsOptions(strip_mm=strip_mm)) < 120


def test_the_side_with_fewer_parts_is_left_behind() -> None:
    """Cutting X closes off B and C, and leaves A alone."""
    (wrong,) = RULE.no_goods(FAR, ["X.outer", "A.outer", "B.outer", "C.outer"], NoNarrowStripsOptions())
    assert (wrong.out, wrong.left) == (("X.outer",), ("A.outer", "C.outer"))


@examples(20)
@given(sheets(), st.sampled_from([60.0, 110.0, 160.0]))
def test_a_no_good_holds_in_every_order_of_any_sheet(sheet: Nest, strip_mm: float) -> None:
    assume(len(sheet.parts) <= 4)
    told_alike(sheet, NoNarrowStripsOptions(strip_mm=strip_mm))


def test_a_part_that_was_told_is_not_looked_at_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """In a row of twelve every other part goes first: those between lie in strips, and each is told once."""
    row = nest(800, 100, *(part(f"P{k}", rect(10 + 60 * k, 10, 50, 80)) for k in range(12)))
    looked: list[tuple[int, bool]] = []
    told: set[int] = set()
    vanishes, take_out = Strips._vanished, Strips.take_out

    def noted(strips: Strips, parts: Ints, cores: Any) -> Bools:
        found = vanishes(strips, parts, cores)
        looked.extend((int(q), int(q) in told) for q in parts)
        return found

    def followed(strips: Strips, p: int) -> Iterator[Badly]:
        for badly in take_out(strips, p):
            told.add(badly[2][0])
            yield badly

    monkeypatch.setattr(Strips, "_vanished", noted)
    monkeypatch.setattr(Strips, "take_out", followed)
    order = [f"P{k}.outer" for k in (*range(0, 12, 2), *range(1, 12, 2))]
    assert RULE.no_goods(row, order, NoNarrowStripsOptions())
    assert looked
    assert told
    assert not any(before for _, before in looked)


def test_few_looks_tell_which_of_many_parts_make_a_strip(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small parts in nine rows, the middle one last: of some dozens that are out around it few make the strip."""
    side, step = 15, 21
    field = nest(
        20 + 9 * step, 20 + 9 * step,
        *(part(f"P{k}", rect(10 + step * (k % 9), 10 + step * (k // 9), side, side)) for k in range(81)),
    )  # fmt: skip
    middle, looks = 40, list[int]()
    vanishes = Strips._vanished

    def noted(strips: Strips, parts: Ints, cores: Any) -> Bools:
        looks.extend(parts.tolist())
        return vanishes(strips, parts, cores)

    ground = next(iter(strips_and_islands._grounds(field, 60.0, 25.0)[0].values()))
    strips = Strips(ground, np.arange(1, 82))
    around = ground.around(middle)
    out = np.arange(len(around.parts))
    assert len(out) > 20
    monkeypatch.setattr(Strips, "_vanished", noted)
    needed = np.flatnonzero(np.isin(around.parts, strips._fewest(middle, around, out)))
    assert len(looks) < len(out) / 2
    assert strips._would_vanish(middle, around, needed)
    for k in needed:
        without = needed[needed != k]
        assert not (strips._on_both_sides(around, without) and strips._would_vanish(middle, around, without))


@cache
def plate(seed: int) -> Nest:
    return read_json(json.dumps(make_sheet(seed, 40, (2000.0, 900.0))).encode(), ReadOptions())


@examples(12)
@given(st.integers(1, 3), st.randoms(use_true_random=False), st.booleans())
def test_close_looks_find_the_islands_that_a_look_at_all_finds(seed: int, chance: Random, rows: bool) -> None:
    found = plate(seed)
    order = [p.outer.id for p in found.parts]
    if rows:  # as plates are cut: one side first, with a few parts out of turn
        for _ in range(4):
            k = chance.randrange(len(order))
            order.insert(chance.randrange(len(order)), order.pop(k))
    else:
        chance.shuffle(order)
    closely = sorted(
        strips_and_islands._badly(replace(found), order, 60.0, 25.0), key=repr
    )  # two islands of one cut come in either order
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Islands, "_closed_off", plainly_closed_off)
        patch.setattr(Islands, "_all_go_on", lambda islands, p: False)
        patch.setattr(Metal, "surely_wide", seen_of_none)
        assert sorted(strips_and_islands._badly(replace(found), order, 60.0, 25.0), key=repr) == closely


def seen_of_none(metal: Metal, out: Bools) -> Bools:
    return np.zeros(len(metal.parts), dtype=np.bool_)


@pytest.mark.parametrize("strip_mm", [25.0, 60.0, 110.0])
def test_boxes_show_of_most_parts_that_they_are_in_no_strip(strip_mm: float) -> None:
    """A plate cut at random: all but a few are seen to be wide, and of none of those a strip is found."""
    order = [p.outer.id for p in plate(2).parts]
    Random(7).shuffle(order)
    seen: list[int] = []
    shown = Metal.surely_wide

    def noted(metal: Metal, out: Bools) -> Bools:
        wide = shown(metal, out)
        seen.append(int(wide.sum()))
        return wide

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Metal, "surely_wide", noted)
        told = [*strips_and_islands._badly(replace(plate(2)), order, strip_mm, 25.0)]
        patch.setattr(Metal, "surely_wide", seen_of_none)
        assert [*strips_and_islands._badly(replace(plate(2)), order, strip_mm, 25.0)] == told
    assert sum(seen) > len(order) / 2


def test_metal_is_seen_to_go_on_before_its_pieces_are_looked_for() -> None:
    """A plate cut from one side on: pieces are looked for at half as many cuts, or fewer, and the same is told."""
    order = [p.outer.id for p in sorted(plate(1).parts, key=lambda p: p.outer.curve.vertices[:, 0].min())]
    looks: list[int] = []
    looked = Islands._closed_off

    def noted(islands: Islands, p: int, window: Box, left: Ints) -> Any:
        looks.append(p)
        return looked(islands, p, window, left)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Islands, "_closed_off", noted)
        told = sorted(strips_and_islands._badly(replace(plate(1)), order, 60.0, 25.0), key=repr)
        few = len(looks)
        patch.setattr(Islands, "_all_go_on", lambda islands, p: False)
        assert sorted(strips_and_islands._badly(replace(plate(1)), order, 60.0, 25.0), key=repr) == told
    assert 2 * few <= len(looks[few:])


def test_what_is_told_is_kept_with_the_drawing() -> None:
    """The nest as it is cut, and the one that the check makes of the drawing, are other nests of the same outlines."""
    order = tuple(p.outer.id for p in plate(1).parts)
    first = strips_and_islands.strips_and_islands(replace(plate(1), drawn=plate(1)), order, 60.0, 25.0)
    assert strips_and_islands.strips_and_islands(replace(plate(1), drawn=plate(1)), order, 60.0, 25.0) is first
    fewer = replace(plate(1), parts=plate(1).parts[1:], drawn=plate(1))
    assert strips_and_islands.strips_and_islands(fewer, order[1:], 60.0, 25.0) == tuple(
        strips_and_islands._badly(fewer, order[1:], 60.0, 25.0)
    )


def plainly_closed_off(islands: Islands, p: int, window: Box, left: Ints) -> Any:
    """All pieces in the window, of what every single part leaves of the ground."""
    metal = islands.metal
    gone = shapely.union_all(metal.grown[islands.out])
    return shapely.get_parts(shapely.difference(shapely.clip_by_rect(metal.ground, *window), gone))


def test_an_island_is_found_by_a_close_look() -> None:
    """The comparison above can fail: there are islands on these plates, and close looks find them."""
    closely: list[bool] = []
    looked = Islands._pieces

    def noted(islands: Islands, window: Box) -> Any:
        closely.append(window[2] - window[0] < 2 * ISLAND_STRIPS * islands.metal.strip_mm)
        return looked(islands, window)

    order = [p.outer.id for p in plate(1).parts]
    Random(2).shuffle(order)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Islands, "_pieces", noted)
        kinds = {cutting.kind for cutting in strips_and_islands._badly(replace(plate(1)), order, 60.0, 25.0)}
    assert any(closely)
    assert "island" in kinds


@cache
def crowd(seed: int) -> Nest:
    """Rectangles of many sizes, side by side in rows."""
    chance, rows, y = Random(seed), list[tuple[float, float, float, float]](), 12.0
    for _ in range(4):
        x, high = 12.0, chance.choice([50.0, 90.0, 150.0])
        while x < 900:
            wide = chance.choice([30.0, 60.0, 120.0, 200.0])
            rows.append((x, y, wide, high * chance.uniform(0.6, 1.0)))
            x += wide + chance.choice([10.0, 18.0, 40.0])
        y += high + 14
    return nest(1150, y + 12, *(part(f"P{k}", rect(*row)) for k, row in enumerate(rows)))


@examples(10)
@given(st.integers(1, 4), st.randoms(use_true_random=False), st.sampled_from([40.0, 60.0, 110.0]), st.booleans())
def test_a_plain_look_at_every_cut_tells_the_same(seed: int, chance: Random, strip_mm: float, at_random: bool) -> None:
    """Looks at one order after the other, of the same nest, tell what lies badly as one that knows nothing does."""
    sheet = crowd(seed)
    order = [p.outer.id for p in sheet.parts]
    for _ in range(2):
        for _ in range(6):
            k = chance.randrange(len(order))
            order.insert(chance.randrange(len(order)), order.pop(k))
        if at_random:
            chance.shuffle(order)
        plainly = told_plainly(sheet, order, strip_mm, 25.0)
        assert sorted(
            (c.k, c.kind, c.left[0]) for c in strips_and_islands._badly(sheet, order, strip_mm, 25.0)
        ) == sorted(plainly)


def test_the_plain_look_finds_strips_and_islands() -> None:
    """The comparison above can fail."""
    order = [p.outer.id for p in crowd(1).parts]
    Random(3).shuffle(order)
    assert {kind for mm in (60.0, 110.0) for _, kind, _ in told_plainly(crowd(1), order, mm, 25.0)} == {
        "strip",
        "island",
    }


@examples(12)
@given(st.integers(1, 4), st.randoms(use_true_random=False), st.sampled_from([40.0, 60.0, 110.0]))
def test_looks_at_many_orders_tell_what_a_first_look_does(seed: int, chance: Random, strip_mm: float) -> None:
    """What an order before has told of a part is taken only where the same parts around it are out."""
    known = replace(crowd(seed))
    order = [p.outer.id for p in known.parts]
    for _ in range(5):
        for _ in range(chance.choice([1, 2, 8])):
            order.insert(chance.randrange(len(order)), order.pop(chance.randrange(len(order))))
        told = list(strips_and_islands._badly(known, order, strip_mm, 25.0))
        assert told == list(strips_and_islands._badly(replace(known), order, strip_mm, 25.0))


@pytest.mark.parametrize(("of", "name", "least"), [(Islands, "_looked_for", 10), (Strips, "_fewest", 1)])
def test_what_one_look_has_found_is_looked_for_again_only_where_other_parts_are_out(
    of: type, name: str, least: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    looks: list[int] = []
    looked = getattr(of, name)

    def noted(looking: Any, p: int, *around: Any) -> Any:
        looks.append(p)
        return looked(looking, p, *around)

    monkeypatch.setattr(of, name, noted)
    row = nest(1220, 100, *(part(f"P{k}", rect(10 + 60 * k, 10, 50, 80)) for k in range(20)))
    sheet = replace(crowd(1) if of is Islands else row)
    order = [p.outer.id for p in sheet.parts]
    Random(3).shuffle(order)

    def looks_at(cut: list[str]) -> int:
        looks.clear()
        list(strips_and_islands._badly(sheet, cut, 60.0, 25.0))
        return len(looks)

    for_first, for_same, for_other = looks_at(order), looks_at(order), looks_at(order[::-1])
    assert for_first > least
    assert for_same == 0
    assert for_other > least


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_strips_and_islands_side_by_side_are_those_one_after_the_other(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    order = [p.outer.id for p in crowd(seed).parts]
    Random(seed).shuffle(order)
    monkeypatch.setattr(strips_and_islands, "MANY_PARTS", 1)
    beside = list(strips_and_islands._badly(replace(crowd(seed)), order, 60.0, 25.0))
    monkeypatch.setattr(strips_and_islands, "MANY_PARTS", 1000)
    assert beside == list(strips_and_islands._badly(replace(crowd(seed)), order, 60.0, 25.0))
    assert {cutting.kind for cutting in beside} == {"strip", "island"}
