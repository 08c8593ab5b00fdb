"""Whole numbers that a plan decides, as sums over nodes: a position is one more than the contours cut before."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from .node import Apart, Lit, Node, all_of, any_of, gate, opposite, order

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

    Raises TooMuch for seconds, which no sum over orders holds.
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

    Raises TooMuch if the number may have too many values.
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
