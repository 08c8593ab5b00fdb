"""Order rules that contradict each other: what a plan may break, and what not."""

from kerfwise.encoder.cut import CutSequence
from kerfwise.postproc.check import CheckResult, check_cuts
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.lock import Lock
from kerfwise.tests.postproc.plans import cut_of, profile

# a channel open to the right with a disc in its mouth: from the left, level-ahead asks for the channel first (its
# centroid sees the disc), hull-before for the disc; the plate F stands alone behind them
CHANNEL = [(20, 20), (120, 20), (120, 40), (40, 40), (40, 140), (120, 140), (120, 160), (20, 160)]
SHEET = nest(400, 180, part("C", CHANNEL), part("D", circle(90, 90, 25)), part("F", rect(160, 20, 60, 140)))
ALONG = {"C": 0.02, "D": 0.3, "F": 0.05}


def checked(order: str, locks: tuple[Lock, ...] = ()) -> CheckResult:
    cuts = [cut_of(SHEET.contour(f"{name}.outer"), ALONG[name], "cw") for name in order]
    return check_cuts(SHEET, CutSequence(tuple(cuts), "left"), profile(locks=locks))


def test_the_weaker_rule_gives_way_and_says_why() -> None:
    result = checked("CDF")
    assert result.ok
    judgement = result.rule("hull-before")
    assert judgement.verdict == "excused"
    assert judgement.excused[0].why == (
        "the order rules contradict each other here: C.outer before D.outer (level-ahead)"
    )


def test_the_firmer_rule_does_not() -> None:
    assert checked("DCF").broken() == ("level-ahead",)


def test_an_order_on_no_cycle_is_never_excused() -> None:
    result = checked("FCD")
    assert result.broken() == ("level-ahead",)
    assert {v.contours for v in result.rule("level-ahead").violations} == {
        ("C.outer", "F.outer"),
        ("D.outer", "F.outer"),
    }


def test_a_lock_is_firmer_than_both() -> None:
    locks = (Lock(contour="D.outer", before="C.outer"),)
    assert checked("DCF", locks).ok
    assert checked("DCF", locks).rule("level-ahead").verdict == "excused"
    assert checked("CDF", locks).broken() == ("hull-before", "locks")
