"""Expressions of a program: numbers, parameters, brackets, operators by their precedence, functions in degrees."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Protocol

from kerfwise.encoder.errors import InputError

_NUMBER = re.compile(r"(?:[0-9]+\.?[0-9]*|\.[0-9]+)")
_SAME = 1e-4


class Parameters(Protocol):
    """What a program has set."""

    def get(self, name: str, line: int) -> float:
        """The value of a parameter: by its number, or its name in < >."""

    def knows(self, name: str) -> bool:
        """Whether a named parameter exists."""


def _mod(left: float, right: float) -> float:
    rest = math.fmod(left, right)
    return rest + abs(right) if rest < 0 else rest


_OPERATORS: Mapping[str, tuple[int, Callable[[float, float], float]]] = {
    "**": (6, lambda a, b: a**b),
    "*": (5, lambda a, b: a * b),
    "/": (5, lambda a, b: a / b),
    "MOD": (5, _mod),
    "+": (4, lambda a, b: a + b),
    "-": (4, lambda a, b: a - b),
    "EQ": (3, lambda a, b: float(abs(a - b) < _SAME)),
    "NE": (3, lambda a, b: float(abs(a - b) >= _SAME)),
    "GT": (3, lambda a, b: float(a > b)),
    "GE": (3, lambda a, b: float(a >= b)),
    "LT": (3, lambda a, b: float(a < b)),
    "LE": (3, lambda a, b: float(a <= b)),
    "AND": (2, lambda a, b: float(a != 0 and b != 0)),
    "OR": (2, lambda a, b: float(a != 0 or b != 0)),
    "XOR": (2, lambda a, b: float((a != 0) != (b != 0))),
}
_FUNCTIONS: Mapping[str, Callable[[float], float]] = {
    "ABS": abs,
    "ACOS": lambda v: math.degrees(math.acos(v)),
    "ASIN": lambda v: math.degrees(math.asin(v)),
    "COS": lambda v: math.cos(math.radians(v)),
    "EXP": math.exp,
    "FIX": lambda v: float(math.floor(v)),
    "FUP": lambda v: float(math.ceil(v)),
    "LN": math.log,
    "ROUND": lambda v: float(math.trunc(v + math.copysign(0.5, v))),
    "SIN": lambda v: math.sin(math.radians(v)),
    "SQRT": math.sqrt,
    "TAN": lambda v: math.tan(math.radians(v)),
}


@dataclass(slots=True)
class ExpressionReader:
    """Reads names and values off the code of a row; `at` is the place that comes next."""

    code: str
    line: int
    run: Parameters
    at: int = 0

    def take(self, text: str) -> bool:
        """Go on behind a text, if it comes next."""
        if self.code.startswith(text, self.at):
            self.at += len(text)
            return True
        return False

    def letter(self) -> str:
        """The letter of a word."""
        char = self.code[self.at]
        if not (char.isalpha() or char in "$@^"):
            raise self._unread()
        self.at += 1
        return char

    def name(self) -> str:
        """The name or the number of the parameter that comes next, behind its #."""
        self.take("#")
        if self.code.startswith("<", self.at):
            end = self.code.find(">", self.at)
            if end < 0:
                raise self._unread()
            name = self.code[self.at : end + 1]
            self.at = end + 1
            return name
        return str(round(self.value()))

    def value(self) -> float:
        """A number, a parameter, a function, or an expression in brackets, with its sign."""
        if self.take("-"):
            return -self.value()
        if self.take("+"):
            return self.value()
        if self.take("["):
            return self._expression()
        if self.code.startswith("#", self.at):
            return self.run.get(self.name(), self.line)
        if found := _NUMBER.match(self.code, self.at):
            self.at = found.end()
            return float(found[0])
        return self._function()

    def _function(self) -> float:
        if self.take("EXISTS["):
            name = self.name()
            if not self.take("]"):
                raise self._unread()
            return float(self.run.knows(name))
        if self.take("ATAN"):
            rise = self.value()
            if not self.take("/"):
                raise self._unread()
            return math.degrees(math.atan2(rise, self.value()))
        for name, function in _FUNCTIONS.items():
            if self.code.startswith(f"{name}[", self.at):
                self.at += len(name)
                value = self.value()
                return self._worked_out(partial(function, value))
        raise self._unread()

    def _expression(self) -> float:
        """What stands up to the closing bracket: operators of one precedence from left to right."""
        values, waiting = [self.value()], list[str]()
        while True:
            sign = next((name for name in _OPERATORS if self.code.startswith(name, self.at)), "")
            sign = "**" if self.code.startswith("**", self.at) else sign
            ends = not sign and self.take("]")
            if not sign and not ends:
                raise self._unread()
            while waiting and (ends or _OPERATORS[waiting[-1]][0] >= _OPERATORS[sign][0]):
                right, left = values.pop(), values.pop()
                operator = _OPERATORS[waiting.pop()][1]
                values.append(self._worked_out(partial(operator, left, right)))
            if ends:
                return values[0]
            self.at += len(sign)
            waiting.append(sign)
            values.append(self.value())

    def _worked_out(self, work: Callable[[], float]) -> float:
        try:
            value = work()
        except (ArithmeticError, ValueError):
            value = math.nan
        if isinstance(value, complex) or not math.isfinite(value):
            why = "it divides by zero, or has a root or an angle that is none"
            raise _wrong(self.line, f"'{self.code}' cannot be worked out: {why}")
        return value

    def _unread(self) -> InputError:
        shown = self.code[self.at : self.at + 20]
        return _wrong(self.line, f"cannot read '{shown or self.code}' in '{self.code[:60]}': not supported here")


def _wrong(line: int, message: str) -> InputError:
    return InputError(message, line=line)
