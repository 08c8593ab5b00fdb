"""What may stand under a key of an own rule: read with every mistake in its place, written back, and described."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import yaml

from kerfwise.encoder.nearest_name import unknown
from kerfwise.rules.options.kind import Choice, Flag, Number, OptionKind, Text, Unfit
from kerfwise.rules.options.yaml_positions import Problems, entries, is_empty, shape

from .criteria import ValueKind

KeyedNodes = list[tuple[str, yaml.Node, yaml.Node]]


class Form(Protocol):
    """One form of value."""

    def read(self, node: yaml.Node, problems: Problems, what: str) -> Any:
        """The value of a node; None, with what is wrong noted, where it cannot be read."""

    def plain(self, value: Any) -> object:
        """The YAML data that reads back as the value."""

    def schema(self) -> dict[str, Any]:
        """JSON Schema of what is accepted."""


@dataclass(frozen=True)
class Scalar:
    """One value of an option's kind, or a criterion."""

    kind: OptionKind | ValueKind

    def read(self, node: yaml.Node, problems: Problems, what: str) -> Any:
        try:
            return self.kind.read(node)
        except Unfit as error:
            problems.add(error.node or node, f"{what}: {error}")
            return None

    def plain(self, value: Any) -> object:
        if isinstance(self.kind, ValueKind):
            return self.kind.plain(value)
        return value if isinstance(self.kind, Choice | Number | Text) else self.kind.write(value)

    def schema(self) -> dict[str, Any]:
        return self.kind.schema()


class _True(Scalar):
    """For keys that say all by being there."""

    def read(self, node: yaml.Node, problems: Problems, what: str) -> Any:
        if super().read(node, problems, what) is False:
            problems.add(node, f"{what}: expected true; leave the key out to ask nothing")
        return True

    def plain(self, value: Any) -> object:
        return True

    def schema(self) -> dict[str, Any]:
        return {"const": True}


TRUE = _True(Flag())


@dataclass(frozen=True)
class Group:
    """A mapping of keys, each with its form and a line of help: those `required`, one of `one_of`, some of `any_of`.

    Whether these are there, the reader of the whole sees. `example` says what a mapping without keys lacks, "" where
    that is nobody's business here; keys that are read `elsewhere` are left alone.
    """

    forms: Mapping[str, tuple[Form, str]]
    one_of: tuple[str, ...] = ()
    any_of: tuple[str, ...] = ()
    required: tuple[str, ...] = ()
    example: str = ""
    noun: str = "key"
    elsewhere: tuple[str, ...] = ()

    def read(self, node: yaml.Node, problems: Problems, what: str) -> tuple[tuple[str, Any], ...]:
        if self.example and (is_empty(node) or not isinstance(node, yaml.MappingNode) or not node.value):
            problems.add(node, f"{what}: expected {self.example}, got {shape(node)}")
            return ()
        return tuple(self.read_members(list(entries(node, problems, what)), problems, what))

    def read_members(self, members: KeyedNodes, problems: Problems, what: str) -> Iterator[tuple[str, Any]]:
        """The keys that are known with their values, as far as these can be read."""
        only = next((key for key, _, _ in members if key in self.one_of), None)
        for key, key_node, value in members:
            if key in self.elsewhere:
                continue
            if key not in self.forms:
                valid = [*self.forms, *self.elsewhere]
                problems.add(key_node, f"{what}: {unknown(self.noun, key, valid)}")
            elif key in self.one_of and key != only:
                text = f"a rule asks one thing, this one asks {only} and {key}; write two rules"
                problems.add(key_node, f"{what}: {text}")
            else:
                read = self.forms[key][0].read(value, problems, f"{what}.{key}")
                if read is not None:
                    yield key, read

    def plain(self, value: tuple[tuple[str, Any], ...]) -> dict[str, object]:
        return {key: self.forms[key][0].plain(one) for key, one in value}

    def schema(self) -> dict[str, Any]:
        told = {key: {"description": help} if help else {} for key, (_, help) in self.forms.items()}
        keys = {key: told[key] | form.schema() for key, (form, _) in self.forms.items()}
        wanted = {"oneOf": self.one_of, "anyOf": self.any_of}
        asked = {word: [{"required": [key]} for key in some] for word, some in wanted.items() if some}
        least = {"minProperties": 1} if self.example else {}
        required = {"required": list(self.required)} if self.required else {}
        closed = {"type": "object", "properties": keys} | required | {"additionalProperties": False}
        return closed | asked | least
