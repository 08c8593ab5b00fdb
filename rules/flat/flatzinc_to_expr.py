"""What a flat model says: each element of a rule's array, and every constraint of its file, as a node over literals."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from kerfwise.rules.expression.node import Lit, Next, Node, all_of, any_of, iff, is_certain, opposite, order, parts
from kerfwise.rules.expression.numbers import (
    MOST_MS,
    ChoiceSum,
    OwnNumber,
    Sum,
    TooMuch,
    at_least,
    at_most,
    equal,
    function_of,
    greatest,
    in_values,
    of_node,
    plus,
    position,
    product,
    times_node,
    without_word,
)
from kerfwise.rules.statements import Pick

from .compiler import Constraint, FlatZinc, Value, expect_in_time


class UnsupportedModel(ValueError):
    """Something in a flat model that is said of nothing a plan decides, or by a constraint that is not known."""


@dataclass(frozen=True, slots=True)
class Words:
    """The arrays of `words.mzn` that a model was compiled with, and what their elements stand for.

    `contour_of` maps candidates to contours, both from 0; arrays that a model does not use are not there.
    """

    n: int
    contour_of: Sequence[int]

    def bools(self, array: str) -> list[Node]:
        """What each element of an array of bools stands for."""
        n = self.n
        if array == "flat_before":
            return [order(i, j) for i in range(n) for j in range(i + 1, n)]
        if array == "flat_next":
            return [Lit(Next(i, j)) if i != j else False for i in range(n) for j in range(n)]
        return [Lit(Pick(c)) for c in range(len(self.contour_of))]

    def sums(self, array: str) -> list[Sum]:
        """What each element of an array of ints stands for."""
        n = self.n
        if array == "position":
            return [position(i, n) for i in range(n)]
        if array == "pick":
            ways: list[dict[Node, int]] = [{} for _ in range(n)]
            for c, contour in enumerate(self.contour_of):
                ways[contour][Lit(Pick(c))] = c + 1
            return [ChoiceSum(0, own, n=n) for own in ways]
        kind = "cuts" if array == "flat_between" else "ms"
        return [Sum(0, {}, OwnNumber(kind, i, j), 1, n) for i in range(n) for j in range(i + 1, n)]


BOOLS = ("flat_before", "flat_next", "flat_picked")
SUMS = ("position", "pick", "flat_between", "flat_pause")


PARTIAL = ("int_div", "int_mod", "int_pow", "array_int_element", "array_var_int_element")


MOST_MULTIPLIED = 40_000
"""Terms that the products of a file come to together: three of two positions each on 115 contours."""


class Meaning:
    """Reads one flat model. `elements` of an array, and `further`: what constraints of the file ask besides.

    `about` is the rule file: reading it ends with an InputError once the time for it is over, as `expect_in_time`.
    """

    def __init__(self, flat: FlatZinc, words: Words, about: Path | None = None) -> None:
        self._flat, self._n, self._about = flat, words.n, about
        self._bools: dict[str, Node] = {}
        self._sums: dict[str, Sum] = {}
        self._asked: list[Node] = []
        self._multiplied = 0
        self._defined = {c.defines: c for c in flat.constraints if c.defines}
        for c in flat.constraints:  # MiniZinc does not mark what may have no value as defined
            result = c.args[-1] if c.args else None
            if not c.defines and c.name in PARTIAL and isinstance(result, str) and result not in self._defined:
                self._defined[result] = c
        for array in BOOLS:
            if array in flat.arrays:
                for value, node in zip(flat.arrays[array], words.bools(array), strict=True):
                    self._bool_word(value, node)
        for array in SUMS:
            if array in flat.arrays:
                for value, one in zip(flat.arrays[array], words.sums(array), strict=True):
                    self._int_word(value, one)

    def elements(self, array: str) -> list[Node]:
        """What each element of an array of bools says.

        Raises NotUnderstood, TooMuch if one says something that no statement can hold.
        """
        return [self._node(value) for value in self._flat.arrays.get(array, [])]

    def further(self) -> list[Node]:
        """What constraints ask beside the arrays, one thing each; nothing that holds anyway."""
        nodes = [*self._asked, *(self._told(c) for c in self._flat.constraints if not self._is_definition(c))]
        nodes += [
            iff(self._node(name), self._node(v.value))
            for name, v in self._flat.variables.items()
            if v.is_bool and v.value is not None and name in self._bools
        ]
        found = (part for node in nodes for part in parts(node) if not is_certain(part))
        return list(dict.fromkeys(found))

    def _is_definition(self, constraint: Constraint) -> bool:
        name = constraint.defines or constraint.args[-1]
        if not isinstance(name, str) or self._defined.get(name) is not constraint:
            return False
        return name not in self._word_names

    @cached_property
    def _word_names(self) -> frozenset[str]:
        arrays = [self._flat.arrays[a] for a in (*BOOLS, *SUMS) if a in self._flat.arrays]
        return frozenset(v for values in arrays for v in values if isinstance(v, str))

    def _bool_word(self, value: Value, node: Node) -> None:
        if isinstance(value, bool):
            self._asked.append(node if value else opposite(node))
        elif isinstance(value, str) and value in self._bools:
            self._asked.append(iff(node, self._bools[value]))
        elif isinstance(value, str):
            self._bools[value] = node

    def _int_word(self, value: Value, one: Sum) -> None:
        if isinstance(value, int):
            self._asked.append(equal(one, value))
        elif isinstance(value, str) and value in self._sums:
            self._asked.append(equal(plus([(1, one), (-1, self._sums[value])]), 0))
        elif isinstance(value, str):
            self._sums[value] = one
            values = self._flat.variables[value].values
            if values is not None and (one.word is None or one.word.kind == "cuts"):
                lowest, highest = (1, self._n) if one.word is None else (0, max(0, self._n - 2))
                if isinstance(one, ChoiceSum) and one.terms:
                    lowest, highest = min(one.terms.values()), max(one.terms.values())
                if not all(value in values for value in range(lowest, highest + 1)):
                    self._asked.append(in_values(one, sorted(v for v in values if lowest <= v <= highest)))
            elif values != range(-MOST_MS, MOST_MS + 1):
                raise UnsupportedModel("pause_ms: a constraint of its own")

    def _node(self, value: Value) -> Node:
        if isinstance(value, bool):
            return value
        if not isinstance(value, str):
            raise UnsupportedModel(f"{value!r} where something true or false was expected")
        if value not in self._bools:
            declared = self._flat.variables.get(value)
            if declared is not None and declared.value is not None:
                self._bools[value] = self._node(declared.value)
            elif value in self._defined:
                self._bools[value] = self._bool_definition(self._defined[value], value)
            else:
                raise UnsupportedModel("a variable of its own, which nothing in a plan decides")
        return self._bools[value]

    def _sum(self, value: Value) -> Sum:
        if isinstance(value, bool | int):
            return Sum(int(value), n=self._n)
        if not isinstance(value, str):
            raise UnsupportedModel(f"{value!r} where a whole number was expected")
        if value not in self._sums:
            declared = self._flat.variables.get(value)
            if declared is not None and declared.value is not None:
                self._sums[value] = self._sum(declared.value)
            elif value in self._defined:
                self._sums[value] = self._int_definition(self._defined[value], value)
            else:
                raise UnsupportedModel("a variable of its own, which nothing in a plan decides")
        return self._sums[value]

    def _product(self, one: Sum, other: Sum) -> Sum:
        """One number times the other, as long as all products together do not come to too much."""
        self._multiplied += len(without_word(one).terms) * len(without_word(other).terms)
        if self._multiplied > MOST_MULTIPLIED:
            raise TooMuch(
                f"products of what a plan decides come to more than {MOST_MULTIPLIED:,} terms on {self._n} contours: "
                "multiply by facts alone, or say the same by sums and conditions"
            )
        return product(one, other)

    def _nodes(self, value: Value) -> list[Node]:
        return [self._node(one) for one in _listed(value)]

    def _bool_definition(self, c: Constraint, name: str) -> Node:
        """The node of a bool that a constraint defines: its last argument, or the other one of two."""
        expect_in_time(self._about)
        if c.name.endswith("_reif") and c.args[-1] == name:
            return self._holds(c.name.removesuffix("_reif"), c.args[:-1])
        if c.name in ("bool_eq", "bool_not") and name in c.args:
            (other,) = [a for a in c.args if a != name]
            return self._node(other) if c.name == "bool_eq" else opposite(self._node(other))
        if c.name == "bool2int":
            return at_least(self._sum(c.args[1]), 1)
        if c.args[-1] == name:
            node = self._bool_function(c)
            if node is not None:
                return node
        raise UnsupportedModel(f"{c.name} has no meaning for rules")

    def _bool_function(self, c: Constraint) -> Node | None:
        args = c.args
        match c.name:
            case "array_bool_and":
                return all_of(self._nodes(args[0]))
            case "array_bool_or":
                return any_of(self._nodes(args[0]))
            case "bool_and":
                return all_of([self._node(args[0]), self._node(args[1])])
            case "bool_or":
                return any_of([self._node(args[0]), self._node(args[1])])
            case "bool_xor":
                return opposite(iff(self._node(args[0]), self._node(args[1])))
            case "array_bool_element" | "array_var_bool_element":
                index = self._sum(args[0])
                chosen = enumerate(self._nodes(args[1]), 1)
                return any_of([all_of([equal(index, k), node]) for k, node in chosen])
            case "fzn_if_then_else_bool" | "fzn_if_then_else_var_bool":
                return any_of([all_of([when, node]) for when, node in self._cases(args)])
        return None

    def _cases(self, args: Sequence[Value]) -> list[tuple[Node, Node]]:
        """Each condition that is the first to hold, and the node of its case."""
        cases: list[tuple[Node, Node]] = []
        before: list[Node] = []
        for condition, value in zip(self._nodes(args[0]), self._nodes(args[1]), strict=True):
            cases.append((all_of([*before, condition]), value))
            before.append(opposite(condition))
        return cases

    def _told(self, c: Constraint) -> Node:
        """The node of a constraint that is stated by itself."""
        function = self._bool_function(c) if isinstance(c.args[-1], str | bool) else None
        if function is not None:
            return iff(function, self._node(c.args[-1]))
        if c.name in ("bool2int",):
            return equal(plus([(1, of_node(self._node(c.args[0]))), (-1, self._sum(c.args[1]))]), 0)
        if c.name.endswith("_reif"):
            return iff(self._holds(c.name.removesuffix("_reif"), c.args[:-1]), self._node(c.args[-1]))
        return self._holds(c.name, c.args)

    def _holds(self, name: str, args: Sequence[Value]) -> Node:
        """When a constraint that says no result holds."""
        match name:
            case "bool_clause":
                return any_of([*self._nodes(args[0]), *(opposite(node) for node in self._nodes(args[1]))])
            case "bool_eq":
                return iff(self._node(args[0]), self._node(args[1]))
            case "bool_not" | "bool_xor" | "bool_ne":
                return opposite(iff(self._node(args[0]), self._node(args[1])))
            case "bool_le":
                return any_of([opposite(self._node(args[0])), self._node(args[1])])
            case "bool_lt":
                return all_of([opposite(self._node(args[0])), self._node(args[1])])
            case "bool_and":
                return all_of([self._node(args[0]), self._node(args[1])])
            case "bool_or":
                return any_of([self._node(args[0]), self._node(args[1])])
            case "set_in":
                values = args[1]
                if not isinstance(values, range | frozenset):
                    raise UnsupportedModel("a set that is not known beforehand")
                return in_values(self._sum(args[0]), sorted(values))
            case "int_le" | "int_lt" | "int_eq" | "int_ne":
                if _single(args):
                    return self._against_constant(name[4:], args)
                return _compared(name[4:], plus([(1, self._sum(args[0])), (-1, self._sum(args[1]))]), 0)
            case "int_lin_le" | "int_lin_eq" | "int_lin_ne" | "bool_lin_le" | "bool_lin_eq" | "int_lin_lt":
                weights, values = _listed(args[0]), _listed(args[1])
                sums = [of_node(self._node(v)) if name.startswith("bool") else self._sum(v) for v in values]
                bound = args[2]
                if not isinstance(bound, int):
                    raise UnsupportedModel(f"{name} with a bound that is decided")
                if len(sums) == 1 and weights[0] in (1, -1):  # a choice stays one
                    return _compared(name[-2:], sums[0], bound, int(weights[0] == -1))
                return _compared(name[-2:], plus([(_int(w), s) for w, s in zip(weights, sums, strict=True)]), bound)
            case "array_bool_and":
                return all_of(self._nodes(args[0]))
            case "array_bool_or":
                return any_of(self._nodes(args[0]))
            case "array_bool_xor":
                odd: Node = False
                for node in self._nodes(args[0]):
                    odd = opposite(iff(odd, node))
                return odd
        raise UnsupportedModel(f"{name} has no meaning for rules")

    def _against_constant(self, how: str, args: Sequence[Value]) -> Node:
        """A number compared with a constant, on either side."""
        if isinstance(args[1], int):
            return _compared(how, self._sum(args[0]), args[1])
        one, value = self._sum(args[1]), _int(args[0])
        if how in ("eq", "ne"):
            return _compared(how, one, value)
        return at_least(one, value if how == "le" else value + 1)

    def _int_definition(self, c: Constraint, name: str) -> Sum:
        """The number that a constraint defines."""
        expect_in_time(self._about)
        args, one = c.args, self._sum
        functions: Mapping[str, Callable[[int, int], int]] = {"int_div": _div, "int_mod": _mod, "int_pow": pow}
        match c.name:
            case "bool2int":
                return of_node(self._node(args[0]))
            case "int_lin_eq":
                weights, names = [_int(w) for w in _listed(args[0])], _listed(args[1])
                at = names.index(name)
                sign = -weights[at]
                if sign not in (1, -1):
                    raise UnsupportedModel("a number that is a share of another")
                rest = [(sign * w, one(v)) for k, (w, v) in enumerate(zip(weights, names, strict=True)) if k != at]
                return plus(rest, -sign * _int(args[2]))
            case "int_eq":
                (other,) = [a for a in args if a != name]
                return one(other)
            case "int_plus" | "int_minus":
                return plus([(1, one(args[0])), (1 if c.name == "int_plus" else -1, one(args[1]))])
            case "int_times":
                if isinstance(args[0], int) or isinstance(args[1], int):
                    factor, other = (args[0], args[1]) if isinstance(args[0], int) else (args[1], args[0])
                    return plus([(_int(factor), one(other))])
                return self._product(one(args[0]), one(args[1]))
            case "int_abs":
                return function_of(without_word(one(args[0])), abs)
            case "int_max" | "int_min" | "array_int_maximum" | "array_int_minimum":
                if c.name.startswith("array"):
                    sums = [one(v) for v in _listed(args[1])]
                else:
                    sums = [one(args[0]), one(args[1])]
                if c.name.endswith(("max", "maximum")):
                    return greatest(sums)
                return plus([(-1, greatest([plus([(-1, s)]) for s in sums]))])
            case "int_div" | "int_mod" | "int_pow":
                by = one(args[1])
                if by.terms or by.word:
                    raise UnsupportedModel(f"{c.name} by a number that is decided")
                return function_of(without_word(one(args[0])), lambda value: functions[c.name](value, by.const))
            case "array_int_element":
                values = [_int(v) for v in _listed(args[1])]
                return function_of(without_word(one(args[0])), lambda k: values[k - 1] if 0 < k <= len(values) else 0)
            case "array_var_int_element":
                index = without_word(one(args[0]))
                chosen = [times_node(equal(index, k), one(v)) for k, v in enumerate(_listed(args[1]), 1)]
                return plus([(1, s) for s in chosen])
            case "fzn_if_then_else_int" | "fzn_if_then_else_var_int":
                terms: list[tuple[int, Sum]] = []
                before: list[Node] = []
                for condition, value in zip(self._nodes(args[0]), _listed(args[1]), strict=True):
                    terms.append((1, times_node(all_of([*before, condition]), one(value))))
                    before.append(opposite(condition))
                return plus(terms)
        raise UnsupportedModel(f"{c.name} has no meaning for rules")


def _compared(how: str, one: Sum, bound: int, flipped: int = 0) -> Node:
    """The number (times -1 if `flipped`) compared with a constant."""
    if how in ("eq", "ne"):
        node = equal(one, -bound if flipped else bound)
        return node if how == "eq" else opposite(node)
    bound -= how == "lt"
    return at_least(one, -bound) if flipped else at_most(one, bound)


def _single(args: Sequence[Value]) -> bool:
    """Whether one side is a constant."""
    return isinstance(args[0], int) or isinstance(args[1], int)


def _div(value: int, by: int) -> int:
    """Division towards zero, as MiniZinc's."""
    return int(abs(value) // abs(by)) * (1 if (value < 0) == (by < 0) else -1)


def _mod(value: int, by: int) -> int:
    return value - by * _div(value, by)


def _int(value: Value) -> int:
    if not isinstance(value, int):
        raise UnsupportedModel(f"{value!r} where a whole number was expected")
    return value


def _listed(value: Value) -> list[Value]:
    if not isinstance(value, list):
        raise UnsupportedModel(f"{value!r} where a list was expected")
    return value
