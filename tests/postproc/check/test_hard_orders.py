"""The orders of the hard rules as numbers: each pair that a rule names is there, once among the cut, of the firmest."""

from dataclasses import replace

from kerfwise.encoder.cut import CutSequence
from kerfwise.postproc.check.rule_verdicts import Forcing, HardOrders
from kerfwise.tests.postproc.plans import good_cuts, plate, profile

PLATE, PROFILE = plate(), profile()


def sequence(left_out: tuple[str, ...] = ()) -> CutSequence:
    cuts = tuple(cut for cut in good_cuts(PLATE) if cut.contour not in left_out)
    return CutSequence(cuts, "left", (0.0, 0.0))


def asked(cuts: CutSequence) -> dict[str, set[tuple[str, str]]]:
    book = PROFILE.rulebook()
    hard = {name: s for name, s in PROFILE.settings().items() if s.strength == "hard"}
    return {name: set(book[name].pairs(PLATE, cuts, s.options)) for name, s in hard.items()}


def test_pairs_are_those_of_the_rules() -> None:
    for left_out in ((), ("A.hole1", "E.outer")):
        cuts = sequence(left_out)
        orders = HardOrders(PLATE, cuts, PROFILE)
        named = {
            rule: {(orders.names[a], orders.names[b]) for a, b in pairs.tolist()}
            for rule, pairs in orders.by_rule.items()
        }
        assert named == asked(cuts)
        assert sum(map(len, named.values())) > 5
        at = cuts.positions()
        assert {name: k for name, k in zip(orders.names, orders.at.tolist(), strict=True) if k} == at
        assert set(orders.names) - set(at) <= set(left_out)


def test_pairs_of_cut_contours_come_once_with_the_firmest_rule() -> None:
    cuts, book = sequence(("E.outer",)), PROFILE.rulebook()
    orders = HardOrders(PLATE, cuts, PROFILE)
    pairs, rules = orders.of_cut()
    told = {(orders.names[a], orders.names[b]): rule for (a, b), rule in zip(pairs.tolist(), rules, strict=True)}
    assert len(told) == len(pairs)
    every = asked(cuts)
    cut = cuts.positions()
    want = {pair for of in every.values() for pair in of if set(pair) <= cut.keys()}
    assert told.keys() == want
    for pair, rule in told.items():
        assert pair in every[rule]
        assert book[rule].gives_way == min(book[name].gives_way for name, of in every.items() if pair in of)


def test_what_must_go_before_is_reached_by_the_orders_that_are_kept() -> None:
    good = sequence()
    for cuts in (good, replace(good, cuts=good.cuts[::-1])):
        forced = Forcing(HardOrders(PLATE, cuts, PROFILE))
        at = cuts.positions()
        kept = {(a, b) for of in asked(cuts).values() for a, b in of if at[a] < at[b]}
        runs = [
            set(run)
            for name, s in PROFILE.settings().items()
            if s.strength == "hard"
            for run in PROFILE.rulebook()[name].together(PLATE, s.options)
        ]
        for name in at:
            own = next((run for run in runs if name in run), {name})
            within = {name}
            while more := {a for a, b in kept if b in within and a in own} - within:
                within |= more
            reached = set(own)
            while (
                more := {c for a, b in kept if b in reached for c in next((run for run in runs if a in run), {a})}
                - reached
            ):
                reached |= more
            assert forced(name) == (within - {name}) | (reached - own)
