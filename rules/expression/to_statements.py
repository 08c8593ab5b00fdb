"""Nodes brought to the statements that engines know, none of them changed in what it asks."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

from kerfwise.encoder.display import join_names
from kerfwise.encoder.nest import Nest
from kerfwise.rules.statements import (
    About,
    AtLeast,
    Before,
    Contiguous,
    Enough,
    Forbid,
    Lag,
    Literal,
    Move,
    NoGood,
    Pick,
    Precede,
    Statement,
    Steps,
)

from .node import (
    MOST_TOLD,
    Apart,
    Asked,
    Gate,
    Lit,
    Next,
    Node,
    NotNext,
    Run,
    Stays,
    any_of,
    gate,
    holds_under,
    literals,
    order,
    parts,
)


def statement_of(asked: Asked, about: About) -> Statement:
    """The hard statement of what is asked: that of a word, and of all else a sum."""
    match asked:
        case Run(contours):
            return Contiguous(contours, about)
        case Stays(out, left):
            return NoGood(frozenset(out), frozenset(left), about)
        case NotNext(leave, reach, leaving, reaching):
            return Move(leave, reach, about, None, leaving, reaching)
        case Lit(Before(), _):
            return Precede(*asked.ends, about)
        case Lit(Pick(c), False):
            return Forbid(c, about)
        case Lit(Apart(i, j, cuts, seconds), True):
            return Lag(i, j, about, cuts, seconds)
        case bool():
            return AtLeast((), (), 1 - asked, about)
    terms, bound = (asked.terms, asked.bound) if isinstance(asked, Gate) else (((asked, 1),), 1)
    enough = _enough(terms, bound)
    return AtLeast(enough.literals, enough.weights, enough.bound, about)


LagsOfPairs = dict[tuple[int, int], tuple[int, int]]
"""Pair of contours → how many cuts lie between them, and the number of the element that says so."""


class NotExpressible(ValueError):
    """A condition that no statement holds: the number of the element, from 1 (0 for a constraint), and why."""

    def __init__(self, element: int, why: str) -> None:
        super().__init__(why)
        self.element = element


@dataclass(frozen=True, slots=True)
class Way:
    """A candidate, as sentences name it: its contour, from 0, and words such as `entered at (10, 20), cw`."""

    contour: int
    words: str


@dataclass(frozen=True, slots=True)
class Writer:
    """Writes the statements of one rule about one nest.

    `in_parts` says that a condition breached in two places may count twice, as where the rule is hard. `why` ends the
    sentences that the rule does not give itself. `about` are the contours, from 0, that the author's comprehension runs
    over in each element, where that is known.
    """

    rule: str
    nest: Nest
    ways: Sequence[Way]
    why: str
    in_parts: bool
    about: Sequence[tuple[int, ...]] = ()

    def written(self, elements: Sequence[Node], says: Sequence[str], further: Sequence[Node]) -> Iterator[Statement]:
        """The statements of an array's elements, with the sentences that go with them, and of further conditions.

        Raises NotExpressible for an element that no statement holds.
        """
        runs, rest = contiguous_runs(elements)
        for members in runs:
            run = tuple(sorted(members))
            ids = [self.nest.contours[k].id for k in run]
            yield statement_of(Run(run), About(self.rule, tuple(ids), self._sentence(None, ids, "follow each other")))
        lags, rest = self._lags(rest, elements)
        for (i, j), (cuts, k) in lags.items():
            yield self._apart(Apart(i, j, cuts), _said(says, k))
        for k in rest:
            sentence, about = _said(says, k), self.about[k] if k < len(self.about) else ()
            if elements[k] is False:
                yield self._impossible(k, about, sentence)
            else:
                yield from self.of_part(elements[k], says, k)
        for node in further:
            yield from self.of_part(node, says, -1)

    def _impossible(self, k: int, about: tuple[int, ...], sentence: str | None) -> AtLeast:
        """An element that no order holds, told with its contours, and where one of them stands for two."""
        ids = [self.nest.contours[c].id for c in dict.fromkeys(about)]
        words = f"element {k + 1} of the file's array can hold in no order"
        of = f", that of {', '.join(ids)}" if ids and not sentence else ""
        if len(ids) == 1 and len(about) == 2:
            of = f", where both contours are {ids[0]} (write `where i != j`)"
        return AtLeast((), (), 1, About(self.rule, tuple(ids), f"{words}{of}: {sentence or self.why}"))

    def _lags(self, numbers: Iterable[int], elements: Sequence[Node]) -> tuple[LagsOfPairs, list[int]]:
        """What elements ask to lie between contours, and the numbers of those left."""
        found: dict[tuple[int, int], dict[int, int]] = defaultdict(dict)
        rest: list[int] = []
        for k in numbers:
            node = elements[k]
            if isinstance(node, Lit) and node.holds and isinstance(node.atom, Apart) and node.atom.cuts:
                found_lags = found[node.atom.i, node.atom.j]
                if node.atom.cuts in found_lags:
                    rest.append(k)  # asked twice, it counts twice
                else:
                    found_lags[node.atom.cuts] = k
            else:
                rest.append(k)
        lags: LagsOfPairs = {}
        for pair, found_lags in found.items():
            most = max(found_lags)
            if self.in_parts or sorted(found_lags) == list(range(1, most + 1)):
                lags[pair] = (most, found_lags[most])
            else:
                rest += found_lags.values()
        return lags, sorted(rest)

    def of_part(self, node: Node, says: Sequence[str], k: int) -> Iterator[Statement]:
        """The statements of a part of element k, or of a constraint where k is -1; raises as `written` does."""
        try:
            sentence, about = (None, ()) if k < 0 else (_said(says, k), self.about[k] if k < len(self.about) else ())
            yield from self._of_node(node, sentence, about)
        except NotExpressible as error:
            raise NotExpressible(k + 1, str(error)) from None

    def _of_node(self, node: Node, sentence: str | None, about: tuple[int, ...] = ()) -> Iterator[Statement]:
        if not self.in_parts:
            yield from self._single(node, sentence, about)
            return
        for part in parts(node):
            yield from self._single(part, sentence, about)

    def _single(self, node: Node, sentence: str | None, about: tuple[int, ...]) -> Iterator[Statement]:
        if node is True:
            return
        moves = self._moves(node, sentence)
        if moves is not None:
            yield from moves
            return
        if self.in_parts and isinstance(node, Gate) and any(isinstance(lit.atom, Next) for lit in literals(node)):
            fallen = clauses(node)
            if len(fallen) > 1:
                for clause in fallen:
                    yield from self._single(clause, sentence, about)
                return
        if isinstance(node, Lit) and node.holds and isinstance(node.atom, Apart):
            if self.in_parts:
                yield self._apart(node.atom, sentence)
                return
            if not node.atom.cuts:
                raise NotExpressible(
                    0,
                    "a soft rule cannot ask for pause_ms, since each breach costs the same, however long: make the "
                    "rule hard, or ask softly for cuts_between; missing seconds have a price in own_rules, by apart",
                )
        plain = merged(node)
        if self.in_parts:
            for clause in clauses(plain):
                yield from self._simple(merged(clause), sentence, about)
            return
        yield from self._simple(plain, sentence, about)

    def _moves(self, node: Node, sentence: str | None) -> list[Move] | None:
        """A condition about nothing but one move and the ways to cut its two contours; None where it is more."""
        found = [lit for lit in literals(node) if isinstance(lit.atom, Next)]
        if len(found) != 1 or found[0].holds:
            return None
        straight = found[0].atom
        assert isinstance(straight, Next)
        i, j = straight.i, straight.j
        names = [self.nest.contours[k].id for k in (i, j)]
        words = self._sentence(sentence, names, "do not follow each other directly in this order")
        about = About(self.rule, tuple(names), words)
        if node == found[0]:
            return [Move((i,), (j,), about)]
        picks = {lit.atom.c for lit in literals(node) if isinstance(lit.atom, Pick)}
        others = sum(1 for lit in literals(node) if not isinstance(lit.atom, Pick)) > 1
        if others or any(self.ways[c].contour not in (i, j) for c in picks):
            return None
        ways = [[c for c, way in enumerate(self.ways) if way.contour == k] for k in (i, j)]
        known = {Lit(Pick(c)): False for of in ways for c in of}
        if holds_under(node, {Lit(straight): False}) is not True:
            return None
        refused: dict[frozenset[int], list[int]] = defaultdict(list)
        for c in ways[0]:
            told = {**known, Lit(straight): True, Lit(Pick(c)): True}
            refused[frozenset(d for d in ways[1] if holds_under(node, {**told, Lit(Pick(d)): True}) is False)].append(c)
        return [
            Move((i,), (j,), about, leaving=frozenset(some), reaching=then) for then, some in refused.items() if then
        ]

    def _apart(self, atom: Apart, sentence: str | None) -> Statement:
        ids = [self.nest.contours[k].id for k in (atom.i, atom.j)]
        cuts, seconds = f"have at least {atom.cuts} cuts between them", f"are at least {atom.seconds:g} s apart"
        sentence = self._sentence(sentence, ids, cuts if atom.cuts else seconds)
        return statement_of(Lit(atom), About(self.rule, tuple(ids), sentence))

    def _simple(self, node: Node, sentence: str | None, of: tuple[int, ...]) -> Iterator[Statement]:
        contours = self.nest.contours
        if node is True:
            return
        if node is False:
            yield statement_of(node, About(self.rule, (), self._sentence(sentence, [], "")))
        elif isinstance(node, Lit) and isinstance(node.atom, Before):
            ids = tuple(contours[k].id for k in node.ends)
            sentence = sentence or f"{ids[0]} is cut before {ids[1]}: {self.why}"
            yield statement_of(node, About(self.rule, ids, sentence))
        elif isinstance(node, Lit) and isinstance(node.atom, Pick) and not node.holds:
            way = self.ways[node.atom.c]
            name = contours[way.contour].id
            yield statement_of(node, About(self.rule, (name,), sentence or f"{name} is not {way.words}: {self.why}"))
        else:
            terms = ((node, 1),) if isinstance(node, Lit) else node.terms
            yield self._at_least(terms, 1 if isinstance(node, Lit) else node.bound, sentence, of)

    def _at_least(
        self, terms: Sequence[tuple[Lit | Gate, int]], bound: int, sentence: str | None, of: tuple[int, ...]
    ) -> AtLeast:
        when = self._when(terms, bound)
        rest = [(term, weight) for term, weight in terms if when is None or term != Lit(Pick(when), False)]
        statement = _enough(rest, bound)
        about = self._about([*rest, *(((Lit(Pick(when)), 1),) if when is not None else ())], sentence, of)
        return AtLeast(statement.literals, statement.weights, statement.bound, about, when=when)

    def _when(self, terms: Sequence[tuple[Lit | Gate, int]], bound: int) -> int | None:
        """The candidate without which nothing is asked: best one whose contour every order is about."""
        free = [
            term.atom.c
            for term, weight in terms
            if isinstance(term, Lit) and isinstance(term.atom, Pick) and not term.holds and weight >= bound
        ]
        orders = [term.ends for term, _ in terms if isinstance(term, Lit) and isinstance(term.atom, Before)]
        if not free or len(terms) == 1:
            return None

        def fit(c: int) -> tuple[bool, bool, int]:
            of = self.ways[c].contour
            return (not all(of in ends for ends in orders), not all(of == ends[0] for ends in orders), c)

        return min(free, key=fit)

    def _about(self, terms: Iterable[tuple[Lit | Gate, int]], sentence: str | None, of: tuple[int, ...]) -> About:
        numbers: dict[int, None] = {}
        for lit in (lit for term, _ in terms for lit in literals(term)):
            if of and len(numbers) > MOST_TOLD:
                break
            if isinstance(lit.atom, Pick):
                numbers[self.ways[lit.atom.c].contour] = None
            else:
                numbers |= dict.fromkeys(lit.ends if isinstance(lit.atom, Before) else (lit.atom.i, lit.atom.j))
        named = dict.fromkeys(of) if of and len(numbers) > MOST_TOLD else numbers
        ids = [self.nest.contours[k].id for k in named]
        return About(self.rule, tuple(ids), self._sentence(sentence, ids, ""))

    def _sentence(self, sentence: str | None, ids: Sequence[str], words: str) -> str:
        if sentence:
            return sentence
        shown = join_names(ids, MOST_NAMED)
        return f"{shown} {words}: {self.why}" if words else f"{shown}: {self.why}" if shown else self.why


MOST_NAMED = 6
MOST_SHARED = 20_000
"""Conditions within others that are kept for whoever names them again."""


def _said(says: Sequence[str], k: int) -> str | None:
    return says[k] if k < len(says) else None


def _literal(term: Lit | Gate) -> tuple[Literal, int]:
    """The statement's literal for a term; with a sign of -1 where the term is its opposite."""
    if isinstance(term, Gate):
        return _within(term), 1
    if isinstance(term.atom, Before):
        return term.atom if term.holds else Before(*term.ends), 1
    sign = 1 if term.holds else -1
    match term.atom:
        case Next(i, j):
            return Steps(i, j), sign
        case Apart(i, j, cuts) if cuts:
            return Steps(i, j, -cuts, cuts), -sign
        case Pick():
            return term.atom, sign
    raise NotExpressible(0, "pause_ms stands by itself only: pause_ms(i, j) >= a number, as a condition of its own")


@lru_cache(maxsize=MOST_SHARED)
def _within(term: Gate) -> Enough:
    """A condition in another; those that stand in many are one and the same there."""
    inner = merged_gate(term)
    return _enough(inner.terms, inner.bound)


def _enough(terms: Iterable[tuple[Lit | Gate, int]], bound: int) -> Enough:
    """Terms as literals: where a literal stands for its opposite, its weight is turned and the bound lowered."""
    literals_, weights = [], []
    for term, weight in terms:
        literal, sign = _literal(term)
        bound -= weight if sign < 0 else 0
        literals_.append(literal)
        weights.append(sign * weight)
    return Enough(tuple(literals_), tuple(weights), bound)


def merged_gate(node: Gate) -> Gate:
    """The gate with a gate of its own written into it, where that leaves a gate."""
    gate = merged(node)
    return gate if isinstance(gate, Gate) else node


def contiguous_runs(elements: Sequence[Node]) -> tuple[list[frozenset[int]], list[int]]:
    """Sets of contours that elements keep together, one element for each contour; and the numbers of the others.

    Contour i of a set is cut before all others of it, or comes directly after one of them.
    """
    of_set: dict[frozenset[int], dict[int, int]] = defaultdict(dict)
    rest: list[int] = []
    for k, node in enumerate(elements):
        found = _run_element(node)
        if found is None or found[0] in of_set[found[1]]:
            rest.append(k)
        else:
            of_set[found[1]][found[0]] = k
    runs = []
    for members, numbers in of_set.items():
        if set(numbers) == members:
            runs.append(members)
        else:
            rest += numbers.values()
    return runs, sorted(rest)


def _run_element(node: Node) -> tuple[int, frozenset[int]] | None:
    """The contour and the set that an element is about, where it is one of a run."""
    if not isinstance(node, Gate) or not node.is_or:
        return None
    after = [t.atom for t, _ in node.terms if isinstance(t, Lit) and t.holds and isinstance(t.atom, Next)]
    first = [t for t, _ in node.terms if not (isinstance(t, Lit) and isinstance(t.atom, Next))]
    if not after or len(first) != 1 or len({atom.j for atom in after}) != 1:
        return None
    own = after[0].j
    others = {atom.i for atom in after}
    ahead = set(parts(first[0]))
    if ahead != {order(own, other) for other in others} or len(after) + 1 != len(node.terms):
        return None
    return own, frozenset(others | {own})


MOST_CLAUSES = 5_000
"""Conditions that one element may fall apart into."""


def clauses(node: Node) -> list[Node]:
    """Conditions that all hold where the node does, with no `and` within an `or`; sums stay as they are.

    Raises NotExpressible if they are too many.

    Examples
    --------
    >>> from kerfwise.rules.expression.node import all_of
    >>> a, b, c, d = order(0, 1), order(1, 2), order(2, 3), order(3, 4)
    >>> len(clauses(any_of([all_of([a, b]), all_of([c, d])])))
    4
    """
    if not isinstance(node, Gate):
        return [] if node is True else [node]
    if node.is_and:
        return [clause for term, _ in node.terms for clause in clauses(term)]
    if not node.is_or or all(not isinstance(term, Gate) or not _falls_apart(term) for term, _ in node.terms):
        return [node]
    conjunction: list[Node] = [False]
    for term, _ in node.terms:
        found = clauses(term)
        if len(conjunction) * len(found) > MOST_CLAUSES:
            raise NotExpressible(0, f"it comes to more than {MOST_CLAUSES:,} conditions")
        conjunction = [any_of([one, other]) for one in conjunction for other in found]
    return [clause for clause in dict.fromkeys(conjunction) if clause is not True]


def _falls_apart(node: Gate) -> bool:
    """Whether there is an `and` in it, but within sums."""
    if node.is_and:
        return True
    return node.is_or and any(isinstance(term, Gate) and _falls_apart(term) for term, _ in node.terms)


def merged(node: Node) -> Node:
    """The node with the one gate among its terms written into it, where that says the same.

    Of `a or (sum of w >= b)` that is `b * a + sum of w >= b`; of `a and (sum of w >= b)` it is the same with the
    weight of a so great that nothing makes up for it.

    Examples
    --------
    >>> from kerfwise.rules.expression.node import all_of
    >>> a, b, c = order(0, 1), order(1, 2), order(2, 3)
    >>> sorted(weight for _, weight in merged(any_of([a, all_of([b, c])])).terms)
    [1, 1, 2]
    """
    if not isinstance(node, Gate):
        return node
    inner = [term for term, _ in node.terms if isinstance(term, Gate)]
    if len(inner) != 1 or not (node.is_or or node.is_and):
        return node
    nested = merged(inner[0])
    if not isinstance(nested, Gate):
        return node
    others = [term for term, _ in node.terms if term is not inner[0]]
    weights: dict[Node, int] = {}
    for term, weight in nested.terms:
        weights[term] = weights.get(term, 0) + weight
    if node.is_or:
        least, bound = nested.bound, nested.bound
    else:
        least = sum(weight for _, weight in nested.terms) - nested.bound + 1
        bound = nested.bound + least * len(others)
    for term in others:
        weights[term] = weights.get(term, 0) + least
    return gate(weights, bound)
