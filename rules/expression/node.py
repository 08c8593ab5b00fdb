"""Expressions over what a plan decides: conditions on literals, and what a rule asks by them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from kerfwise.rules.statements import Before, Pick

# Conditions over what a plan decides: literals, and gates, which add up the weights of what is true.
#
# Every boolean expression is a gate: `or` adds up to at least one, `and` to all, `not` is pushed down to the
# literals. Literals are orders and picks, and two words that only some statements know: how many cuts, or how much
# time, lie between two contours, and that one comes directly after another. Three words more stand by themselves.


@dataclass(frozen=True, slots=True)
class Apart:
    """At least `cuts` other cuts and `seconds` s lie between contours `i` and `j`, whichever is cut first; i < j."""

    i: int
    j: int
    cuts: int = 0
    seconds: float = 0.0

    @property
    def words(self) -> str:
        """How much lies between, such as `at least 2 cuts and 5 s`."""
        wanted = [f"{self.cuts} cuts"] * bool(self.cuts) + [f"{self.seconds:g} s"] * bool(self.seconds)
        return f"at least {' and '.join(wanted)}"


@dataclass(frozen=True, slots=True)
class Next:
    """Contour `j` is the next cut after contour `i`."""

    i: int
    j: int


Atom = Before | Pick | Apart | Next


@dataclass(frozen=True, slots=True)
class Lit:
    """An atom, or with `holds` False its opposite. Of two contours' orders the atom is that with i < j."""

    atom: Atom
    holds: bool = True

    @property
    def ends(self) -> tuple[int, int]:
        """The two contours of an order, the one that is cut first at the head."""
        assert isinstance(self.atom, Before), f"no order: {self}"
        return (self.atom.i, self.atom.j) if self.holds else (self.atom.j, self.atom.i)


@dataclass(frozen=True, slots=True)
class Gate:
    """The weights of the terms that are true, each above 0, come to at least `bound`."""

    terms: tuple[tuple[Lit | Gate, int], ...]
    bound: int
    digest: int = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "digest", hash((self.terms, self.bound)))

    def __hash__(self) -> int:
        """Worked out once: a gate of hundreds of terms is looked up in many others."""
        return self.digest

    @property
    def is_or(self) -> bool:
        """Whether one true term is enough."""
        return all(weight >= self.bound for _, weight in self.terms)

    @property
    def is_and(self) -> bool:
        """Whether every term must be true."""
        total = sum(weight for _, weight in self.terms)
        return all(total - weight < self.bound for _, weight in self.terms)


Node = bool | Lit | Gate


@dataclass(frozen=True, slots=True)
class Run:
    """These contours follow each other without another between."""

    contours: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Stays:
    """At no moment are all of `out` cut while all of `left` are still in; both ascending."""

    out: tuple[int, ...]
    left: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class NotNext:
    """None of `reach` is cut directly after one of `leave`; of these candidates only, where some are given."""

    leave: tuple[int, ...]
    reach: tuple[int, ...]
    leaving: frozenset[int] | None = None
    reaching: frozenset[int] | None = None


Asked = Node | Run | Stays | NotNext


@dataclass(frozen=True, slots=True)
class Condition:
    """One thing that a rule asks, the contours that it is told of, and what it asks as a sentence without its end.

    Of a gate or a pick, `wrong` says what the first of the contours breaks, given the sum of the weights that hold; an
    order before a contour that is not cut holds where `uncut_follow`. A gate about being the first or the last is told
    of one contour only among those `beside`, the outermost.
    """

    asked: Asked
    contours: tuple[int, ...]
    sentence: str
    wrong: str | Callable[[int], str] = ""
    uncut_follow: bool = False
    beside: tuple[int, ...] = ()


def ahead(i: int, j: int) -> Lit:
    """Contour `i` is cut before contour `j`, another one."""
    return Lit(Before(i, j)) if i < j else Lit(Before(j, i), False)


def order(i: int, j: int) -> Node:
    """Contour `i` is cut before contour `j`."""
    return False if i == j else ahead(i, j)


def opposite(node: Node) -> Node:
    """The node's negation."""
    if isinstance(node, bool):
        return not node
    if isinstance(node, Lit):
        return Lit(node.atom, not node.holds)
    total = sum(weight for _, weight in node.terms)
    return gate({opposite(term): weight for term, weight in node.terms}, total - node.bound + 1)


def all_of(nodes: Iterable[Node]) -> Node:
    """All of them hold."""
    distinct = dict.fromkeys(nodes)
    return gate(dict.fromkeys(distinct, 1), len(distinct))


def any_of(nodes: Iterable[Node]) -> Node:
    """One of them holds."""
    return gate(dict.fromkeys(nodes, 1), 1)


def iff(one: Node, other: Node) -> Node:
    """Both hold, or neither."""
    return any_of([all_of([one, other]), all_of([opposite(one), opposite(other)])])


def gate(weights: Mapping[Node, int], bound: int) -> Node:
    """The weights, of any sign, of the nodes that hold come to at least `bound`; as simple as it can be said.

    Examples
    --------
    >>> a, b = order(0, 1), order(1, 2)
    >>> gate({a: 2, b: 3, True: 1}, 3) == any_of([a, b]), gate({a: 1, b: -1}, 1) == all_of([a, opposite(b)])
    (True, True)
    >>> any_of([a, opposite(a)]), all_of([a, order(1, 0)]), any_of([any_of([a, b]), False]) == any_of([a, b])
    (True, False, True)
    """
    terms: dict[Lit | Gate, int] = {}
    for node, weight in weights.items():
        if isinstance(node, bool):
            bound -= weight * node
        elif weight > 0:
            terms[node] = terms.get(node, 0) + weight
        elif weight < 0:
            other = opposite(node)
            bound -= weight
            assert not isinstance(other, bool), "what is simple has an opposite"
            terms[other] = terms.get(other, 0) - weight
    terms, bound = _without_both(terms, bound)
    if bound <= 0:
        return True
    if sum(terms.values()) < bound:
        return False
    terms = {node: min(weight, bound) for node, weight in terms.items()}
    shared = math.gcd(*terms.values())
    terms, bound = {node: weight // shared for node, weight in terms.items()}, -(-bound // shared)
    if all(weight >= bound for weight in terms.values()):
        return _flattened(terms, any_=True)
    least = min(terms.values())
    if sum(terms.values()) - least < bound:
        return _flattened(terms, any_=False)
    return Gate(tuple(terms.items()), bound)


def _without_both(terms: dict[Lit | Gate, int], bound: int) -> tuple[dict[Lit | Gate, int], int]:
    """Of a literal and its opposite one is true whatever happens."""
    for node in list(terms):
        if isinstance(node, Lit) and node.holds and (other := Lit(node.atom, False)) in terms:
            sure = min(terms[node], terms[other])
            bound -= sure
            for one in (node, other):
                terms[one] -= sure
                if not terms[one]:
                    del terms[one]
    return terms, bound


def _flattened(terms: Iterable[Lit | Gate], any_: bool) -> Node:
    """Any, or all, of the terms; what is within a term of the same kind stands beside the others."""
    nodes = list(terms)
    if len(nodes) == 1:
        return nodes[0]
    flat: dict[Lit | Gate, int] = {}
    nested = False
    for node in nodes:
        if isinstance(node, Gate) and (node.is_or if any_ else node.is_and):
            nested = True
            flat |= dict.fromkeys((term for term, _ in node.terms), 1)
        else:
            flat[node] = 1
    if nested:
        return any_of(flat) if any_ else all_of(flat)
    return Gate(tuple(flat.items()), 1 if any_ else len(flat))


def parts(node: Node) -> Iterator[Node]:
    """What all has to hold for the node to hold: itself, or its terms."""
    if isinstance(node, Gate) and node.is_and:
        for term, _ in node.terms:
            yield from parts(term)
    elif node is not True:
        yield node


def literals(node: Node) -> Iterator[Lit]:
    """Every literal in the node, as often as it stands there."""
    if isinstance(node, Lit):
        yield node
    elif isinstance(node, Gate):
        for term, _ in node.terms:
            yield from literals(term)


def orders(node: Node) -> list[tuple[int, int] | None]:
    """The orders that all have to hold for the node to hold, first cut first; None for each part that is no order."""
    return [part.ends if isinstance(part, Lit) and isinstance(part.atom, Before) else None for part in parts(node)]


MOST_TOLD = 12
"""Contours up to which a condition is about all that it names; one that names more is about those that its author's
comprehension runs over."""


def contours_of(node: Node) -> list[int]:
    """The numbers of the contours that orders, gaps and runs in the node are about; not those of picks."""
    found: dict[int, None] = {}
    for lit in literals(node):
        if not isinstance(lit.atom, Pick):
            found |= dict.fromkeys(lit.ends if isinstance(lit.atom, Before) else (lit.atom.i, lit.atom.j))
    return list(found) or list(dict.fromkeys(lit.atom.c for lit in literals(node) if isinstance(lit.atom, Pick)))


def holds_under(node: Node, known: Mapping[Lit, bool]) -> Node:
    """The node, with literals replaced by what is known of them."""
    if isinstance(node, bool):
        return node
    if isinstance(node, Lit):
        if node in known:
            return known[node]
        other = Lit(node.atom, not node.holds)
        return not known[other] if other in known else node
    weights: dict[Node, int] = {}
    for term, weight in node.terms:
        result = holds_under(term, known)
        weights[result] = weights.get(result, 0) + weight
    return gate(weights, node.bound)


def is_certain(node: Node) -> bool:
    """Whether the node is seen to hold whatever is decided: one term failing makes another hold."""
    if isinstance(node, bool):
        return node
    if isinstance(node, Lit) or not node.is_or:
        return False
    failing: dict[Lit, bool] = {}
    for term, _ in node.terms:
        if isinstance(term, Lit):
            failing[term] = False
        elif term.is_or:
            failing |= {lit: False for lit, _ in term.terms if isinstance(lit, Lit)}
    return holds_under(node, failing) is True
