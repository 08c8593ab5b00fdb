"""What the rules about single candidates state: pierce, cut-direction and the locks of entry and direction."""

from __future__ import annotations

from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.catalogue.cut_direction import CutDirection, CutDirectionOptions
from kerfwise.rules.catalogue.locks import Locks, LocksOptions
from kerfwise.rules.catalogue.pierce import Pierce, PierceOptions
from kerfwise.rules.lock import Lock
from kerfwise.rules.statements import About, AtLeast, Before, Forbid
from kerfwise.tests.rules.catalogue.made import facts_with

HOST = nest(400, 300, part("H", rect(50, 50, 200, 200), [rect(70, 70, 160, 160)]), part("G", rect(100, 100, 40, 40)))
WAYS = {
    "H.hole1": [((100, 70), "ccw", (100, 75))],
    "H.outer": [((100, 50), "cw", (100, 44)), ((100, 50), "ccw", (100, 44))],
    "G.outer": [((120, 100), "cw", (120, 94)), ((140, 120), "cw", (146, 120))],
}
FACTS = facts_with(HOST, WAYS)  # type: ignore[arg-type]
HOLE, G = HOST.index["H.hole1"], HOST.index["G.outer"]


def test_pierce_in_the_waste_of_a_hole_comes_before_the_hole() -> None:
    sentence = "G.outer is cut before H.hole1: it is pierced in the waste of H.hole1, which falls out when that is cut"
    about = About("pierce", ("G.outer", "H.hole1"), sentence)
    assert list(Pierce().statements(FACTS, PierceOptions())) == [
        AtLeast((Before(G, HOLE),), (1,), 1, about, when=3),
        AtLeast((Before(G, HOLE),), (1,), 1, about, when=4),
    ]


def test_pierces_of_a_sheet_without_holes_state_nothing() -> None:
    plate = nest(100, 100, part("P", rect(10, 10, 50, 50)))
    facts = facts_with(plate, {"P.outer": [((10, 10), "cw", (5, 5))]})
    assert list(Pierce().statements(facts, PierceOptions())) == []


def test_wrong_direction_is_forbidden() -> None:
    about = About("cut-direction", ("H.outer",), "H.outer is cut clockwise: that is the direction of every outer")
    assert list(CutDirection().statements(FACTS, CutDirectionOptions(outer="cw"))) == [Forbid(2, about)]
    assert list(CutDirection().statements(FACTS, CutDirectionOptions())) == []


def test_locked_entry_forbids_the_others() -> None:
    found = list(Locks().statements(FACTS, LocksOptions(locks=(Lock(contour="G.outer", entry=(140.3, 120.4)),))))
    about = About("locks", ("G.outer",), "G.outer is entered at (140.3, 120.4): locked by the operator")
    assert found == [Forbid(3, about)]


def test_locked_direction_forbids_the_other() -> None:
    found = list(Locks().statements(FACTS, LocksOptions(locks=(Lock(contour="H.outer", direction="ccw"),))))
    assert found == [Forbid(1, About("locks", ("H.outer",), "H.outer is cut ccw: locked by the operator"))]
