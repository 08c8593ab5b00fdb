"""Kinds of value an option can have: numbers, words, texts; read from YAML, written back, described to an editor."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import yaml

from kerfwise.encoder.nearest_name import nearest
from kerfwise.encoder.questions import answer_problem

from .yaml_positions import Problems, is_empty, shape

NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,2})?"
MOST = 1e9
"""No number of a profile is larger, whatever it is of."""
LONGEST = 60
"""Characters of a number and its unit."""


class Unfit(ValueError):
    """A value that its kind does not accept; the text says what was given and what was expected.

    `node` is the part of the value that is wrong, None for all of it.
    """

    def __init__(self, text: str, node: yaml.Node | None = None) -> None:
        super().__init__(text)
        self.node = node


@contextmanager
def noting(problems: Problems, node: yaml.Node, what: str) -> Iterator[None]:
    """Note a value that does not fit, and go on without it."""
    try:
        yield
    except Unfit as error:
        problems.add(error.node or node, f"{what}: {error}")


class OptionKind(ABC):
    """One kind of value."""

    @abstractmethod
    def read(self, node: yaml.Node) -> object:
        """The value of a YAML node, in the program's own units; raises `Unfit`."""

    def read_or_note(self, node: yaml.Node, problems: Problems, what: str) -> Any:
        """The same; None with a problem noted where the value does not fit."""
        with noting(problems, node, what):
            return self.read(node)
        return None

    @abstractmethod
    def write(self, value: Any) -> str:
        """The value as YAML text that reads back the same."""

    @abstractmethod
    def schema(self) -> dict[str, Any]:
        """JSON Schema of the values accepted."""

    @abstractmethod
    def expected(self) -> str:
        """What is accepted, in words."""

    def refuse(self, node: yaml.Node) -> Unfit:
        """The error for a node this kind does not accept."""
        return Unfit(f"expected {self.expected()}, got {shape(node)}{_other_spelling(node)}", node)


_MARKS = r"'’_\s"
"""What thousands are divided by, beside commas and points."""
_DIVIDED = re.compile(rf"\s*([+-]?\d[\d.,{_MARKS}]*)((?:[A-Za-z/%°][A-Za-z0-9/%]*)?)\s*")


def _other_spelling(node: yaml.Node) -> str:
    """A hint where a number has a comma, or thousands that something divides: what it may mean."""
    text = str(node.value) if isinstance(node, yaml.ScalarNode) else ""
    meant = plain_numbers(text)
    if len(meant) == 2:
        return f": is it {meant[0]} or {meant[1]}? Write it without a comma"
    if not meant:
        return ""
    return f": write decimals with a point, {meant[0]}" if "," in text else f": write {meant[0]}"


def plain_numbers(text: str) -> tuple[str, ...]:
    """What a number that is written with commas, or with divided thousands, may mean; with its unit.

    Examples
    --------
    >>> plain_numbers("3,200 mm/min"), plain_numbers("1,5 mm"), plain_numbers("1.234,5"), plain_numbers("12 000")
    (('3200 mm/min', '3.2 mm/min'), ('1.5 mm',), ('1234.5',), ('12000',))
    >>> plain_numbers("3200 mm/min"), plain_numbers("1,2,3")
    ((), ())
    """
    found = _DIVIDED.fullmatch(text) if len(text) <= LONGEST else None
    if found is None:
        return ()
    number, unit = found[1].strip(), found[2].strip()
    readings = []
    for marks, point in ((",", "."), (".", ","), (_MARKS, "."), (_MARKS, ",")):
        whole, _, rest = number.partition(point)
        if re.fullmatch(rf"[+-]?[1-9]\d{{0,2}}(?:[{marks}]\d{{3}})+", whole) and re.fullmatch(r"\d*", rest):
            readings.append(re.sub(rf"[{marks}]", "", whole) + (f".{rest}" if rest else ""))
    if re.fullmatch(r"[+-]?\d+,\d+", number):
        readings.append(number.replace(",", ".").rstrip("0").rstrip("."))
    return tuple(f"{one} {unit}".strip() for one in dict.fromkeys(readings))


def scalar_text(node: yaml.Node, kind: OptionKind) -> str:
    if not isinstance(node, yaml.ScalarNode) or is_empty(node):
        raise kind.refuse(node)
    return str(node.value)


def digits(node: yaml.Node, kind: OptionKind) -> str:
    """The text of a number, refused where it is longer than any number is."""
    text = scalar_text(node, kind)
    if len(text) > LONGEST:
        raise Unfit(f"expected {kind.expected()}, got a text of {len(text)} characters", node)
    return text


# Plain values: numbers, true or false, one of a few words, texts.


@dataclass(frozen=True, slots=True)
class Number(OptionKind):
    """A bare number between two bounds; `whole` for counts."""

    at_least: float | None = None
    at_most: float | None = None
    whole: bool = False

    def read(self, node: yaml.Node) -> float | int:
        text = digits(node, self).strip()
        if not re.fullmatch(r"[+-]?\d+" if self.whole else NUMBER, text):
            raise self.refuse(node)
        value = int(text) if self.whole else float(text)
        low = self.at_least is not None and value < self.at_least
        high = self.at_most is not None and value > self.at_most
        if low or high:
            raise self.refuse(node)
        if abs(value) > MOST:
            raise Unfit(f"expected {self.expected()}, and no more than {MOST:g}, got {text!r}", node)
        return value

    def write(self, value: float | int) -> str:
        return repr(value) if self.whole or value != int(value) else str(int(value))

    def schema(self) -> dict[str, Any]:
        result: dict[str, Any] = {"type": "integer" if self.whole else "number"}
        if self.at_least is not None:
            result["minimum"] = self.at_least
        if self.at_most is not None:
            result["maximum"] = self.at_most
        return result

    def expected(self) -> str:
        what = "a whole number" if self.whole else "a number"
        if self.at_least is not None and self.at_most is not None:
            return f"{what} from {self.at_least:g} to {self.at_most:g}"
        if self.at_least is not None:
            return f"{what} of at least {self.at_least:g}"
        return what


@dataclass(frozen=True, slots=True)
class Flag(OptionKind):
    """true or false."""

    def read(self, node: yaml.Node) -> bool:
        text = scalar_text(node, self).lower()
        if text not in ("true", "yes", "on", "false", "no", "off"):
            raise self.refuse(node)
        return text in ("true", "yes", "on")

    def write(self, value: bool) -> str:
        return "true" if value else "false"

    def schema(self) -> dict[str, Any]:
        return {"type": "boolean"}

    def expected(self) -> str:
        return "true or false"


@dataclass(frozen=True, slots=True)
class Choice(OptionKind):
    """One of a few words. `none` is the word that stands for None, if any.

    A bare `off` is false to readers of YAML 1.1, such as most of Python's: it may be written so where it is a word.
    """

    words: tuple[str, ...]
    none: str | None = None

    def read(self, node: yaml.Node) -> str | None:
        text = scalar_text(node, self)
        if text == "false" and "off" in self.words:
            text = "off"
        if text not in self.words:
            guess = nearest(text, self.words)
            hint = f": did you mean {guess!r}?" if guess else ""
            raise Unfit(f"{self.refuse(node)}{hint}", node)
        return None if text == self.none else text

    def write(self, value: str | None) -> str:
        return self.none if value is None and self.none is not None else str(value)

    def schema(self) -> dict[str, Any]:
        return {"enum": [*self.words, *([False] if "off" in self.words else [])]}

    def expected(self) -> str:
        return "one of " + ", ".join(self.words)


@dataclass(frozen=True, slots=True)
class Text(OptionKind):
    """Any text that is not empty; `pattern` says that it must be a regular expression, `grouped` one with a group."""

    pattern: bool = False
    grouped: bool = False

    def read(self, node: yaml.Node) -> str:
        text = scalar_text(node, self)
        if not text.strip():
            raise self.refuse(node)
        if self.pattern:
            try:
                groups = re.compile(text).groups
            except re.error as error:
                raise Unfit(f"expected {self.expected()}, got {text!r}: {error}", node) from None
            if self.grouped and not groups:
                raise Unfit(f"expected {self.expected()}, got {text!r}", node)
        return text

    def write(self, value: str) -> str:
        # Dumped inside a list, so that it is quoted wherever a comma or brace would need it.
        style = None if value.isprintable() else '"'
        dumped = yaml.safe_dump([value], allow_unicode=True, width=1e9, default_flow_style=True, default_style=style)
        return str(dumped).strip()[1:-1]

    def schema(self) -> dict[str, Any]:
        return {"type": "string", "minLength": 1} | ({"format": "regex"} if self.pattern else {})

    def expected(self) -> str:
        if self.grouped:
            return "a regular expression with a group, such as '_([0-9]+)pcs'"
        return "a regular expression such as 'mark|scribe'" if self.pattern else "a text"


@dataclass(frozen=True, slots=True)
class Pairs(OptionKind):
    """A mapping of texts, each to a text, or to one of a few `words`: kept as pairs, in the order that is written."""

    words: tuple[str, ...] = ()

    def read(self, node: yaml.Node) -> tuple[tuple[str, str], ...]:
        if not isinstance(node, yaml.MappingNode):
            raise self.refuse(node)
        value = Choice(self.words) if self.words else Text()
        found: dict[str, str] = {}
        for key, entry in node.value:
            found[Text().read(key)] = str(value.read(entry))
        return tuple(found.items())

    def write(self, value: tuple[tuple[str, str], ...]) -> str:
        return "{" + ", ".join(f"{Text().write(key)}: {Text().write(pair)}" for key, pair in value) + "}"

    def schema(self) -> dict[str, Any]:
        word_schema: dict[str, Any] = {"enum": list(self.words)} if self.words else {"type": ["string", "number"]}
        return {"type": "object", "additionalProperties": word_schema}

    def expected(self) -> str:
        return f"a mapping such as {{red: {self.words[0]}}}" if self.words else "a mapping such as {frame: sheet}"


class AnswerPairs(Pairs):
    """Answers to questions of drawings; such as no drawing raises, and choices that they do not have, are refused."""

    def read(self, node: yaml.Node) -> tuple[tuple[str, str], ...]:
        found = Pairs.read(self, node)
        for (question, choice), (key, value) in zip(dict(found).items(), node.value, strict=True):
            if (problem := answer_problem(question, choice)) is not None:
                raise Unfit(problem[0], value if problem[1] else key)
        return found


@dataclass(frozen=True, slots=True)
class TextOrWord(OptionKind):
    """A text, or the word that stands for None."""

    none: str

    def read(self, node: yaml.Node) -> str | None:
        text = Text().read(node)
        return None if text == self.none else text

    def write(self, value: str | None) -> str:
        return self.none if value is None else Text().write(value)

    def schema(self) -> dict[str, Any]:
        return Text().schema()

    def expected(self) -> str:
        return f"a text, or {self.none!r}"
