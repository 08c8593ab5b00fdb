"""The cheapest plan by trying every order and every candidate, judged by nothing but the check's `violations`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import chain, pairwise, permutations, product
from math import inf

import numpy as np
from numpy.typing import NDArray

from kerfwise import Profile
from kerfwise.rule_kit import CutSequence, OrderRule, RuleSetting, Violation
from kerfwise.rules.catalogue import no_islands, part_rigidity
from kerfwise.rules.catalogue.heat_lag import HeatLagOptions
from kerfwise.rules.catalogue.no_islands import NoIslandsOptions
from kerfwise.rules.catalogue.part_rigidity import PartRigidityOptions
from kerfwise.rules.statements import EXEMPTION_MM
from kerfwise.tests.agreement.cases import TURNS
from kerfwise.tests.agreement.trial import Trial

Order = tuple[int, ...]
Orders = NDArray[np.int8]
Let = frozenset[tuple[str, tuple[str, ...]]]

OF_ONE_CUT = ("cut-direction", "pierce", "locks", "part-rigidity", "hold-small-parts")
"""Rules whose violations are each of one cut (the first contour named), whatever the ways of the other cuts."""
OF_OUTERS = ("no-islands", "no-narrow-strips")
"""Rules that look at outer contours alone."""
OF_LEADS = "kerf of the lead"
"""What a violation says that is of the ways of two cuts: one meets the kerf of the other's lead."""
OF_LINKS = "the link of"
"""What a violation says of a link."""


def shifted(profile: Profile, share: float) -> Profile:
    """The profile by which the check holds the thresholds of rigid metal and of frames at `share` more than it asks.

    The check allows ALLOWANCE less than the profile asks, for it looks at boundaries in finer steps than the planner.
    What the planner sees lies between the check at ALLOWANCE less than the profile asks and at ALLOWANCE more.
    """
    rules = dict(profile.rules)
    for name, setting in rules.items():
        match setting.options:
            case PartRigidityOptions() as options:
                least = min(options.rigid_min + share, 1.0) + part_rigidity.ALLOWANCE
                rules[name] = replace(setting, options=replace(options, rigid_min=least))
            case NoIslandsOptions() as options:
                least = min(options.frame_share + share, 1.0) + no_islands.ALLOWANCE
                rules[name] = replace(setting, options=replace(options, frame_share=least))
    return replace(profile, rules=rules)


class Judge:
    """Prices plans of a trial in mm of idle travel.

    Hard rules are judged by `violations`; one that is excusable costs EXEMPTION_MM a violation. A soft rule costs its
    weight for each violation, but for those that order pairs or keep runs together: each pair that stands the wrong way
    round costs, and each piece of a run beyond the first. `dropped` are the orders (rule, contours) that contradict
    others and those that are relaxed.
    """

    def __init__(self, trial: Trial, dropped: Let) -> None:
        self.trial, self.dropped = trial, dropped
        self.rules = trial.profile.settings()
        self.outer = [c.kind == "outer" for c in trial.nest.contours]
        self.name = [c.id for c in trial.nest.contours]
        self.number = trial.nest.index
        self.known: dict[tuple[str, Order], float] = {}
        self.most = max(len(own) for own in trial.ways)
        lag = self.rules.get("heat-lag")
        timed = lag is not None and isinstance(lag.options, HeatLagOptions) and lag.options.lag_s > 0
        self.of_route = [rule for rule in self.rules if rule == "no-tip-travel" or (rule == "heat-lag" and timed)]
        if "pierce" in self.rules and trial.leads_near(self.rules["pierce"].options):
            self.of_route.append("pierce")
        self.of_route += [TURNS] * (TURNS in self.rules)
        self.timed = timed
        special = {*OF_ONE_CUT, *self.of_route}
        self.of_order = [rule for rule in self.rules if rule not in special and not self._of_pairs(rule)]
        self.of_order.sort(key=lambda rule: rule in OF_OUTERS)
        self.of_links = bool(trial.taken)
        self.exempt = self._exempt()

    def price_mm(self, order: Order, picks: Sequence[int]) -> float:
        """What one plan costs; inf where it breaks a hard rule that is not excused. `picks` are by contour number."""
        for rule, setting in self.rules.items():
            if setting.weight is None and self._of_pairs(rule) and self._violations(rule, self._plain(order)):
                return inf
        price = self._pair_prices(np.array([order], dtype=np.int8))[0] + self._of_order(order)
        stops = [self.trial.first[-1], *(self.trial.first[i] + picks[i] for i in order), self.trial.first[-1]]
        travel = float(self.trial.moves[stops[:-1], stops[1:]].sum())
        ways = self._of_ways(order)
        return float(price + travel + sum(ways[i][picks[i]] for i in order) + self._of_route_mm(order, picks))

    def cheapest_mm(self) -> float | None:
        """The least price of any plan; None if every plan breaks a hard rule."""
        orders = self._orders()
        soft = self._pair_prices(orders)
        least = soft + self._least_travel(orders)
        best = inf
        for k in np.argsort(least, kind="stable").tolist():
            if least[k] >= best:
                break
            order = tuple(orders[k].tolist())
            price = soft[k] + self._of_order(order)
            if least[k] - soft[k] + price < best:
                best = self._along(order, price, best)
        return None if best == inf else float(best)

    def _orders(self) -> Orders:
        """All orders but those that a hard rule about pairs forbids: one inverted pair forbids all that invert it.

        Nor those that part what has to follow each other after all else.
        """
        n = self.trial.n
        orders = np.array(list(permutations(range(n))), dtype=np.int8)
        at = np.argsort(orders, axis=1)
        kept = np.ones(len(orders), dtype=np.bool_)
        for rule, setting in self.rules.items():
            if setting.weight is None and self._of_pairs(rule):
                for before, after in self._inverted(rule):
                    kept &= at[:, before] < at[:, after]
            elif setting.weight is None and not self._excusable(rule):
                for before, after in self._asked(rule)[0]:
                    kept &= at[:, before] < at[:, after]
        return orders[kept]

    def _of_pairs(self, rule: str) -> bool:
        return isinstance(self.trial.profile.rulebook()[rule], OrderRule)

    def _inverted(self, rule: str) -> list[tuple[int, int]]:
        """The pairs (before, after) that some order breaks; each stands the wrong way round in one of these two."""
        found = []
        for order in (range(self.trial.n), range(self.trial.n - 1, -1, -1)):
            found += [(v.contours[0], v.contours[1]) for v in self._violations(rule, self._plain(tuple(order)))]
        return [(self.number[a], self.number[b]) for a, b in found]

    def _violations(self, rule: str, sequence: object) -> list[Violation]:
        found = self.trial.violations(rule, sequence)  # type: ignore[arg-type]
        return [v for v in found if (rule, v.contours) not in self.dropped]

    def _plain(self, order: Order) -> object:
        return self.trial.sequence(order, [0] * self.trial.n)

    def _pair_prices(self, orders: Orders) -> NDArray[np.float64]:
        """What the soft rules that order pairs, or keep runs together, cost in every order."""
        prices = np.zeros(len(orders))
        at = np.argsort(orders, axis=1)
        for rule, setting in self.rules.items():
            if setting.weight is None:
                continue
            pairs, runs = self._asked(rule)
            breaches = np.zeros(len(orders), dtype=np.int64)
            for before, after in pairs:
                breaches += at[:, before] > at[:, after]
            for run in runs:
                inside = np.isin(orders, run)
                breaches += inside[:, 0].astype(np.int64) + (inside[:, 1:] & ~inside[:, :-1]).sum(axis=1) - 1
            prices += setting.weight * breaches
        return prices

    def _asked(self, rule: str) -> tuple[list[tuple[int, int]], list[list[int]]]:
        """Pairs and runs that a rule asks for, by geometry."""
        book, options = self.trial.profile.rulebook()[rule], self.rules[rule].options
        pairs = book.pairs(self.trial.nest, self._plain(tuple(range(self.trial.n))), options)  # type: ignore[arg-type]
        runs = book.together(self.trial.nest, options)
        number = self.number
        kept = [pair for pair in pairs if (rule, pair) not in self.dropped]
        return [(number[a], number[b]) for a, b in kept], [[number[name] for name in run] for run in runs]

    def _least_travel(self, orders: Orders) -> NDArray[np.float64]:
        """Moves in every order, were each the cheapest between any ways of its two contours, with what those cost."""
        first, n = self.trial.first, self.trial.n
        moves = self.trial.moves + np.array([*chain.from_iterable(self.trial.way_prices), 0.0])
        of = [slice(a, b) for a, b in pairwise([*first, first[-1] + 1])]
        least = np.array([[moves[i, j].min() for j in of] for i in of])
        home = np.full((len(orders), 1), n)
        rounds = np.hstack([home, orders, home])
        return np.asarray(least[rounds[:, :-1], rounds[:, 1:]].sum(axis=1))

    def _of_order(self, order: Order) -> float:
        """What the rules that look at the whole order cost; inf where a hard one is broken."""
        total = 0.0
        for rule in self.of_order:
            setting = self.rules[rule]
            if setting.weight is not None and any(self._asked(rule)):
                continue  # its price is among the pairs'
            seen = tuple(k for k in order if self.outer[k]) if rule in OF_OUTERS else order
            if (rule, seen) not in self.known:
                self.known[rule, seen] = self._price(rule, setting, order)
            total += self.known[rule, seen]
            if total == inf:
                return inf
        return total

    def _price(self, rule: str, setting: RuleSetting, order: Order) -> float:
        weight = setting.weight
        if weight is None:
            breaches = len(self._violations(rule, self._plain(order)))
            return (EXEMPTION_MM * breaches if self._excusable(rule) else inf) if breaches else 0.0
        if isinstance(setting.options, HeatLagOptions):  # every cut that is missing costs
            book, cuts = self.trial.profile.rulebook()[rule], self._plain(order)
            lags = [replace(setting.options, lag_cuts=k, lag_s=0.0) for k in range(1, setting.options.lag_cuts + 1)]
            return weight * sum(len(book.violations(self.trial.nest, cuts, lag)) for lag in lags)  # type: ignore[arg-type]
        return weight * len(self._violations(rule, self._plain(order)))

    def _along(self, order: Order, price: float, best: float) -> float:
        """The cheapest plan along an order, if it is cheaper than the best known."""
        trial, first = self.trial, self.trial.first
        extra = self._of_ways(order)
        ways = [[w for w in range(len(trial.ways[i])) if extra[i][w] < inf] for i in order]
        home = first[-1]
        routes = []
        for picked in product(*ways):
            stops = [home, *(first[i] + w for i, w in zip(order, picked, strict=True)), home]
            travel = float(trial.moves[stops[:-1], stops[1:]].sum())
            cost = price + travel + sum(extra[i][w] for i, w in zip(order, picked, strict=True))
            routes.append((cost, picked))
        for cost, picked in sorted(routes):
            if cost >= best:
                break
            picks = [0] * trial.n
            for i, w in zip(order, picked, strict=True):
                picks[i] = w
            best = min(best, cost + self._of_route_mm(order, picks))
        return best

    def _of_ways(self, order: Order) -> list[list[float]]:
        """For each contour, what each of its ways costs in this order by its time and by the rules of single cuts."""
        trial = self.trial
        extra = [list(own) for own in trial.way_prices]
        if trial.stretches is not None:
            for at, i in enumerate(order):
                suits = (trial.stretches.open(i, w, order[:at]) for w in range(len(extra[i])))
                extra[i] = [cost if one else inf for cost, one in zip(extra[i], suits, strict=True)]
        for turn in range(self.most):
            picks = [min(turn, len(own) - 1) for own in trial.ways]
            fresh = {self.name[i] for i in range(trial.n) if picks[i] == turn}
            sequence = trial.sequence(order, picks)
            for rule in OF_ONE_CUT:
                if rule not in self.rules:
                    continue
                for violation in trial.violations(rule, sequence):
                    name = violation.contours[0]
                    if (
                        OF_LEADS not in violation.text
                        and name in fresh
                        and not (rule == "part-rigidity" and name in self.exempt)
                    ):
                        extra[self.number[name]][turn] += self._weight(rule)
        return extra

    def _weight(self, rule: str) -> float:
        weight = self.rules[rule].weight
        if weight is not None:
            return weight
        return EXEMPTION_MM if self._excusable(rule) else inf

    def _excusable(self, rule: str) -> bool:
        return self.trial.profile.rulebook()[rule].excusable

    def _of_route_mm(self, order: Order, picks: Sequence[int]) -> float:
        """What the rules cost that look at single moves and at times; inf where a hard one is broken."""
        if not self.of_route and not self.of_links:
            return 0.0
        plain = self.trial.sequence(order, picks, timed=self.timed)
        linked = self.trial.sequence(order, picks, linked=True) if self.of_links else plain
        if self.of_links and not self._links_hold(linked):
            return inf
        total = 0.0
        for rule in self.of_route:
            weight = self.rules[rule].weight
            found = self._violations(rule, plain if rule in OF_ONE_CUT else linked)
            breaches = sum(rule not in OF_ONE_CUT or OF_LEADS in violation.text for violation in found)
            total += (inf if weight is None else weight * breaches) if breaches else 0.0
        return total

    def _links_hold(self, linked: CutSequence) -> bool:
        """Whether the check lets the links of a plan pass: what else it asks of these cuts, it asks without links, too.

        A way that a link leads to is asked for what its pierce and lead-in would be asked for.
        """
        hard = [rule for rule in OF_ONE_CUT if rule in self.rules and self.rules[rule].weight is None]
        return not any(OF_LINKS in v.text for rule in hard for v in self._violations(rule, linked))

    def _exempt(self) -> frozenset[str]:
        """Outer contours none of whose ways keeps part-rigidity even while all others are in."""
        if "part-rigidity" not in self.rules:
            return frozenset()
        found = set()
        for i, own in enumerate(self.trial.ways):
            if self.outer[i] and not any(self._rigid_at_first(i, w) for w in range(len(own))):
                found.add(self.name[i])
        return frozenset(found)

    def _rigid_at_first(self, contour: int, way: int) -> bool:
        order = (contour, *(i for i in range(self.trial.n) if i != contour))
        picks = [0] * self.trial.n
        picks[contour] = way
        found = self.trial.violations("part-rigidity", self.trial.sequence(order, picks))
        return all(v.contours[0] != self.name[contour] for v in found)
