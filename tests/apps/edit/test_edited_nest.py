"""Nests that change: any way of doing and undoing gives the nest made so at once, no overlap, what is cut stays."""

from __future__ import annotations

from typing import Any

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from kerfwise.apps.edit.edited_nest import EditedNest
from kerfwise.apps.edit.edits import Add, Edit, Keep, Mirror, Move, NestAnew, OtherSheet, Turn, edit_of
from kerfwise.apps.nesting.placement.demand import PartType, Spacing
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest, Part, Sheet
from kerfwise.encoder.readers.json_nest import nest_json
from kerfwise.rules.case import circle, nest, part, rect

SPACING = Spacing(5.0, 5.0)
ELL = [(150, 20), (190, 20), (190, 32), (162, 32), (162, 60), (150, 60)]
PLATE = nest(
    300, 200,
    part("A", rect(20, 20, 50, 40)),
    part("B", rect(90, 20, 40, 40), [circle(110, 40, 8)]),
    part("C", ELL),
    part("D", rect(20, 90, 60, 30)),
)  # fmt: skip
STRIP = PartType("strip", part("strip", rect(0, 0, 70, 10)), 1)
NAMES = st.sampled_from("ABCD")
STEP = st.integers(-60, 60).map(lambda n: n / 4)
EDITS: st.SearchStrategy[Edit] = st.one_of(
    st.builds(Move, NAMES, STEP, STEP),
    st.builds(Turn, NAMES, st.sampled_from([90.0, 180.0, 270.0, 30.0])),
    st.builds(Mirror, NAMES),
    st.just(Add((STRIP,))),
    st.builds(NestAnew, st.sets(NAMES, max_size=2).map(lambda names: tuple(sorted(names)))),
    st.builds(lambda w: OtherSheet(Sheet.rectangle(w, 200)), st.sampled_from([250.0, 400.0])),
    NAMES.map(lambda name: edit_of(f"drop {name}")),
)


def edited(cut: str = "") -> EditedNest:
    """The plate, with these parts cut already."""
    return EditedNest(PLATE, SPACING, frozenset(cut), 1.5)


def expect_apart(made: Nest) -> None:
    """All parts lie on the sheet, a gap apart: by shapely alone."""
    inner = made.sheet.polygon.buffer(0.02 - SPACING.edge_mm, join_style="mitre")
    metal = [one.polygon for one in made.parts]
    for k, one in enumerate(metal):
        assert inner.covers(one), made.parts[k].id
        assert all(one.distance(other) > SPACING.gap_mm - 0.02 for other in metal[:k])


@settings(max_examples=60, deadline=None)
@given(steps=st.lists(st.one_of(EDITS, st.sampled_from(["undo", "redo"])), max_size=7), cut=st.sampled_from(["", "B"]))
def test_any_way_there_gives_the_nest_made_so_at_once(steps: list[Edit | str], cut: str) -> None:
    now = edited(cut)
    for step in steps:
        try:
            now = now.undo() if step == "undo" else now.redo() if step == "redo" else now.do(step)
        except InputError:
            continue  # it cannot be done; then nothing was done
        expect_apart(now.nest)
        assert now.nest is PLATE or now.edits
    at_once = edited(cut).do(*now.edits) if now.edits else edited(cut)
    assert nest_json(at_once.nest) == now.text()
    back = now
    while back.edits:
        back = back.undo()
    assert back.nest is PLATE
    for part_id in cut:
        assert now.nest.part_of[part_id] is PLATE.part_of[part_id]


@settings(max_examples=60, deadline=None)
@given(turns=st.lists(st.one_of(st.sampled_from([90.0, 180.0, 30.0, 45.5]), st.just("flip"), st.tuples(STEP, STEP))))
def test_a_part_lies_as_plain_geometry_has_it(turns: list[Any]) -> None:
    """The pose that is kept is what turning, mirroring and moving points one after the other gives."""
    made = EditedNest(nest(4000, 4000, part("C", [(x + 2000, y + 2000) for x, y in ELL])), SPACING)
    area = made.base.parts[0].polygon
    for turn in turns:
        if turn == "flip":
            made = made.do(Mirror("C"))
        elif isinstance(turn, float):
            made = made.do(Turn("C", turn))
        else:
            made = made.do(Move("C", *turn))
    middle = shapely.box(*area.bounds).centroid
    dx = dy = 0.0
    for turn in turns:
        if turn == "flip":
            area = shapely.transform(area, lambda p, x=middle.x + dx: p * [-1, 1] + [2 * x, 0])
        elif isinstance(turn, float):
            area = shapely.affinity.rotate(area, turn, origin=(middle.x + dx, middle.y + dy))
        else:
            dx, dy = dx + turn[0], dy + turn[1]
            area = shapely.affinity.translate(area, *turn)
    assert area.symmetric_difference(made.nest.parts[0].polygon).area < 0.01


def test_there_and_back_is_the_same_file() -> None:
    made = edited().do(Move("A", 0.1, 0.2), Turn("A", 90), Mirror("A"))
    made = made.do(Mirror("A"), Turn("A", 270), Move("A", -0.1, -0.2))
    assert made.text() == nest_json(PLATE)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("move A 15.1 0", "A lies 4.9 mm from B: 5 mm are kept"),
        ("move A 40 0", "A overlaps B by 699.6 mm²"),
        ("move A 0 -16", "A lies 4.0 mm from the edge of the sheet: 5 mm are kept"),
        ("move A -30 0", "A reaches 10.0 mm over the edge of the sheet"),
        ("drop E", "unknown part 'E'"),
        ("keep A E", "unknown part 'E'"),
        ("drop A B C D", "no part would be left"),
        ("move A ten 0", "is no change of a nest: expected drop PART…"),
        ("move A inf 0", "expected numbers from"),
        ("sheet 0x100", "is no change of a nest"),
        ("sheet 60x40", "no part would be left"),
        ('drop "A', "is no change of a nest"),
    ],
)
def test_what_cannot_be_done_is_named(line: str, said: str) -> None:
    with pytest.raises(InputError) as caught:
        edited().do(line)
    assert said in str(caught.value)


def test_two_parts_change_places_at_once() -> None:
    made = edited().do("move A 70 0", "move B -70 0")
    assert made.nest.part_of["A"].polygon.bounds[0] == 90
    with pytest.raises(InputError):
        edited().do("move A 70 0").do("move B -70 0")


def test_what_lay_too_near_before_may_stay_so_and_move_together() -> None:
    tight = EditedNest(nest(300, 100, part("A", rect(2, 20, 40, 40)), part("B", rect(43, 20, 40, 40))), SPACING)
    assert len(tight.do("move A 0 10", "move B 0 10").nest.parts) == 2
    with pytest.raises(InputError, match=r"A lies 0\.5 mm from B"):
        tight.do("move A 0.5 0")


def test_another_sheet_names_what_is_off() -> None:
    made = edited().do("sheet 140x200")
    assert (made.off, [p.id for p in made.nest.parts]) == (("C",), ["A", "B", "D"])
    assert made.undo().off == ()


SCRAP = nest(*PLATE.sheet.bounds[2:], *PLATE.parts, scrap=[[(82, 0), (82, 200)], [(200, 0), (200, 200)]])


def rows(made: Nest) -> dict[str, list[list[float]]]:
    return {line.id: line.curve.as_rows() for line in made.scrap}


def test_scrap_lines_that_can_still_be_cut_stay_and_the_others_are_named() -> None:
    base = EditedNest(SCRAP, SPACING, kerf_mm=1.5)
    kept = base.do("drop A", "move B 10 0")
    assert (rows(kept.nest), kept.scrap_left_out) == (rows(SCRAP), ())
    assert '"scrap": [[[82' in kept.text()
    for change, why in (
        ("move B -30 0", "scrap1 runs through part B at (82.0, 40.0): end it before the part, or lead it round"),
        ("move B -7 0", "scrap1 comes within 1.000 mm of B.outer at (83.0, 20.0), less than the kerf of 1.5 mm"),
    ):
        made = base.do("drop A", change)
        assert rows(made.nest) == {"scrap1": rows(SCRAP)["scrap2"]}
        assert [text.removesuffix(": keep it a kerf away") for text in made.scrap_left_out] == [why]
        assert f"scrap line left out: {why}" in str(made)
        assert made.named_as_before.scrap == ()
        assert rows(made.undo().nest) == rows(SCRAP)
    off = base.do("sheet 195x150")
    assert [text.split(":")[0] for text in off.scrap_left_out] == [
        "scrap1 runs 50.000 mm off the sheet at (82.0, 175.0)",
        "scrap2 runs 200.000 mm off the sheet at (200.0, 100.0)",
    ]


def test_scrap_lines_that_are_cut_are_not_cut_again_with_a_part() -> None:
    done = EditedNest(SCRAP, SPACING, frozenset({*"ABCD", "scrap1"}), 1.5)
    again = done.do(Keep(("D",)))
    assert again.scrap_left_out[0] == "scrap1 is cut already"
    assert rows(again.nest) == {"scrap1": rows(SCRAP)["scrap2"]}


def test_what_is_cut_stays_and_what_is_out_is_a_hole() -> None:
    for line in ("drop B", "move B 1 0", "turn B 90", "mirror B", "sheet 500x500"):
        with pytest.raises(InputError, match="B is cut already"):
            edited("B").do(line)
    anew = edited("B").do("nest-anew")
    assert anew.nest.part_of["B"] is PLATE.part_of["B"]
    kept = edited("ABCD").do(Keep(("D",))).nest
    assert [p.id for p in kept.parts] == ["D"]
    assert len(kept.sheet.holes) == 3
    assert kept.sheet.polygon.area == pytest.approx(300 * 200 - 53 * 43 - 43 * 43 - _area_out("C"), abs=1)
    assert edited().do(Keep(("D",))).nest.sheet is PLATE.sheet
    inside = nest(200, 200, part("A", rect(20, 20, 150, 150), [rect(50, 50, 80, 80)]), part("B", rect(60, 60, 30, 30)))
    with pytest.raises(InputError, match="B lies in the metal of A"):
        EditedNest(inside, SPACING, frozenset("AB"), 1.5).do("keep B")


def _area_out(name: str) -> float:
    return float(PLATE.part_of[name].outer.polygon.buffer(1.5, join_style="mitre").area)


def test_added_parts_have_names_of_their_own_and_room() -> None:
    made = edited().do(Add((STRIP,))).do(Add((STRIP,)))
    assert [p.id for p in made.nest.parts][4:] == ["strip-1", "strip-2"]
    expect_apart(made.nest)
    many = PartType("strip", STRIP.part, 500)
    with pytest.raises(InputError, match="no room on the sheet for more parts"):
        edited().do(Add((many,)))


def test_grain_that_a_list_gave_is_kept() -> None:
    grained = Part("A", PLATE.parts[0].outer, attributes={"turned": 0.0, "turns": [0.0, 180.0]})
    base = Nest(PLATE.sheet, (grained,))
    assert EditedNest(base, SPACING).do("turn A 180").nest.parts[0].attributes["turned"] == 180.0
    with pytest.raises(InputError, match="A may lie at 0, 180 degrees only"):
        EditedNest(base, SPACING).do("turn A 90")
