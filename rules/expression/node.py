"""Expressions over what a plan decides: conditions on literals, and whole numbers as sums over them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
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


# Whole numbers that a plan decides, as sums over nodes: a position is one more than the contours cut before.

MOST_STEPS = 20_000
"""Values that a number may have where something other than a sum is made of it."""
MOST_MS = 10**9


class TooMuch(ValueError):
    """What is asked for grows beyond what anything could plan by; the text says what."""


@dataclass(frozen=True, slots=True)
class OwnNumber:
    """A number with a word of its own: how many `cuts` or milliseconds (`ms`) lie between contours i and j, i < j."""

    kind: str
    i: int
    j: int


@dataclass(frozen=True, slots=True)
class Sum:
    """`const` and the weights of the nodes that hold; perhaps a word, `times` its value; of n contours."""

    const: int = 0
    terms: Mapping[Node, int] = field(default_factory=dict)
    word: OwnNumber | None = None
    times: int = 0
    n: int = 0

    @property
    def low(self) -> int:
        """No value is less."""
        least = sum(w for w in self.terms.values() if w < 0)
        return self.const + least + (min(self.times * v for v in self._span()) if self.word else 0)

    @property
    def high(self) -> int:
        """No value is more."""
        most = sum(w for w in self.terms.values() if w > 0)
        return self.const + most + (max(self.times * v for v in self._span()) if self.word else 0)

    def _span(self) -> tuple[int, int]:
        assert self.word is not None
        return (0, max(self.n - 2, 0)) if self.word.kind == "cuts" else (-MOST_MS, MOST_MS)


def position(i: int, n: int) -> Sum:
    """The position of contour `i` among n, from 1."""
    return Sum(1, {order(k, i): 1 for k in range(n) if k != i}, n=n)


def plus(sums: Sequence[tuple[int, Sum]], const: int = 0) -> Sum:
    """So many times each sum, and a constant."""
    terms: dict[Node, int] = {}
    word, times, n = None, 0, 0
    plain: list[tuple[int, Sum]] = []
    for factor, one in sums:
        if one.word is not None and factor:
            if word is None or word == one.word:
                word, times, n = one.word, times + factor * one.times, one.n
            else:
                plain.append((factor, without_word(one)))
                continue
        plain.append((factor, one))
    if word is not None and any(one.terms for _, one in plain):
        plain, word, times = [(factor, without_word(one)) for factor, one in sums], None, 0
    for factor, one in plain:
        const += factor * one.const
        for node, weight in one.terms.items():
            terms[node] = terms.get(node, 0) + factor * weight
    const, terms = _folded(const, terms)
    return Sum(const, terms, word if times else None, times, n)


def _folded(const: int, terms: Mapping[Node, int]) -> tuple[int, dict[Node, int]]:
    """Without what is certain, and with each literal the way round that its atom has."""
    found: dict[Node, int] = {}
    for node, weight in terms.items():
        if isinstance(node, bool):
            const += weight * node
        elif isinstance(node, Lit) and not node.holds:
            const += weight
            atom = Lit(node.atom)
            found[atom] = found.get(atom, 0) - weight
        else:
            found[node] = found.get(node, 0) + weight
    return const, {node: weight for node, weight in found.items() if weight}


def without_word(one: Sum) -> Sum:
    """The same without its word: the cuts between two contours by their positions.

    Raises
    ------
    TooMuch
        For seconds, which no sum over orders holds.
    """
    if one.word is None:
        return one
    if one.word.kind != "cuts":
        raise TooMuch("pause_ms stands by itself only: pause_ms(i, j) >= some number of milliseconds")
    apart = plus([(1, position(one.word.i, one.n)), (-1, position(one.word.j, one.n))])
    between = function_of(apart, lambda value: abs(value) - 1)
    return plus([(1, Sum(one.const, one.terms)), (one.times, between)])


def at_least(one: Sum, bound: int) -> Node:
    """The number is at least `bound`."""
    if one.word is None:
        chosen = _of_choices(one, lambda value: value >= bound)
        return gate(one.terms, bound - one.const) if chosen is None else chosen
    value = bound - one.const
    if one.times > 0:
        return _word_at_least(one, -(-value // one.times))
    return opposite(_word_at_least(one, value // one.times + 1))


def _word_at_least(one: Sum, value: int) -> Node:
    word = one.word
    assert word is not None
    low, high = one._span()
    if value <= low:
        return True
    if value > high:
        return False
    apart = {"cuts": value} if word.kind == "cuts" else {"seconds": value / 1000}
    return Lit(Apart(word.i, word.j, **apart))


def at_most(one: Sum, bound: int) -> Node:
    """The number is at most `bound`."""
    return opposite(at_least(one, bound + 1))


def equal(one: Sum, value: int) -> Node:
    """The number is `value`."""
    if one.word is None and (chosen := _of_choices(one, lambda of: of == value)) is not None:
        return chosen
    return all_of([at_least(one, value), at_most(one, value)])


def in_values(one: Sum, values: Sequence[int]) -> Node:
    """The number is one of `values`, sorted."""
    if one.word is None and (chosen := _of_choices(one, frozenset(values).__contains__)) is not None:
        return chosen
    runs: list[list[int]] = []
    for value in values:
        if runs and runs[-1][1] == value - 1:
            runs[-1][1] = value
        else:
            runs.append([value, value])
    return any_of([all_of([at_least(one, low), at_most(one, high)]) for low, high in runs])


@dataclass(frozen=True, slots=True)
class ChoiceSum(Sum):
    """A number by which way a contour is cut: exactly one of the nodes holds, and gives the value."""


def _of_choices(one: Sum, fits: Callable[[int], bool]) -> Node | None:
    """Where the number is a choice: one of those nodes holds whose values fit."""
    if not isinstance(one, ChoiceSum):
        return None
    fitting = [node for node, value in one.terms.items() if fits(one.const + value)]
    return True if len(fitting) == len(one.terms) else any_of(fitting)


def function_of(one: Sum, value_of: Callable[[int], int]) -> Sum:
    """What a function makes of the number, by the steps from each value to the next.

    Raises
    ------
    TooMuch
        If the number may have too many values.
    """
    if isinstance(one, ChoiceSum):
        return ChoiceSum(0, {node: value_of(one.const + value) for node, value in one.terms.items()}, n=one.n)
    low, high = one.low, one.high
    if high - low > MOST_STEPS:
        raise TooMuch(f"a number with {high - low + 1:,} values in what is no sum")
    terms: dict[Node, int] = {}
    const = before = value_of(low)
    for value in range(low + 1, high + 1):
        step, before = value_of(value) - before, value_of(value)
        if step:
            node = at_least(one, value)
            terms[node] = terms.get(node, 0) + step
    return plus([(1, Sum(const, terms, n=one.n))])


def greatest(sums: Sequence[Sum]) -> Sum:
    """The greatest of them."""
    low, high = max(one.low for one in sums), max(one.high for one in sums)
    if high - low > MOST_STEPS:
        raise TooMuch(f"max or min of numbers with {high - low + 1:,} values")
    steps = [any_of([at_least(one, value) for one in sums]) for value in range(low + 1, high + 1)]
    return plus([(1, Sum(low)), *((1, of_node(step)) for step in steps)])


def of_node(node: Node) -> Sum:
    """1 where the node holds, else 0."""
    return Sum(int(node)) if isinstance(node, bool) else Sum(0, {node: 1})


def times_node(node: Node, one: Sum) -> Sum:
    """The number where the node holds, else 0."""
    one = without_word(one)
    parts = [(weight, of_node(all_of([node, term]))) for term, weight in one.terms.items()]
    return plus([(one.const, of_node(node)), *parts])


def product(one: Sum, other: Sum) -> Sum:
    """One times the other."""
    one, other = without_word(one), without_word(other)
    if len(one.terms) * len(other.terms) > MOST_STEPS:
        raise TooMuch("a product of two sums")
    return plus([(one.const, other), *((weight, times_node(node, other)) for node, weight in one.terms.items())])
