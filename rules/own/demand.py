"""What an own rule can ask of the contours it selects: the interface that every statement of the language has."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import yaml

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.rules.options.kind import Unfit
from kerfwise.rules.options.plain_values import Flag
from kerfwise.rules.options.yaml_positions import Problems
from kerfwise.rules.statements import About, Statement

from .named_facts import KnownFacts
from .selector import Selector

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts

MOST = 250_000
"""Own rules that come to more single statements than this on one nest are refused; they would outgrow any solver."""

Breach = tuple[tuple[str, ...], str, tuple[int, ...]]
"""A breach: contour ids, what is wrong in words, positions of the cuts."""


@dataclass(frozen=True, eq=False, slots=True)
class Chosen:
    """Which contours of a nest a rule is about: its id and reason, and group by group (selected, all of the group)."""

    rule: str
    why: str
    known: KnownFacts
    groups: tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]

    @property
    def nest(self) -> Nest:
        """The nest that contours are numbered in."""
        return self.known.nest

    def ids(self, *contours: int) -> tuple[str, ...]:
        """Ids of contours by number."""
        return tuple(self.nest.contours[k].id for k in contours)

    def about(self, contours: tuple[int, ...], sentence: str) -> About:
        """Where a statement comes from, with the rule's reason behind the sentence."""
        return About(self.rule, self.ids(*contours), f"{sentence}: {self.why}")

    def check_size(self, count: int) -> None:
        """Refuse a rule that comes to more than `MOST` statements."""
        if count > MOST:
            raise InputError(
                f"{self.rule} comes to {count:,} statements on this nest, at most {MOST:,} are taken; select fewer "
                "contours or narrow its scope"
            )


class Ask(ABC):
    """One kind of demand; `KEYS` are the words for it in a profile with a line of help each.

    `MINDS_WHAT_IS_OUT` is that of a rule, see there.
    """

    KEYS: ClassVar[dict[str, str]]
    MINDS_WHAT_IS_OUT: ClassVar[bool] = False

    @classmethod
    @abstractmethod
    def read(cls, key: str, node: yaml.Node, problems: Problems, what: str) -> Ask:
        """The demand that stands under `key`."""

    @classmethod
    @abstractmethod
    def schema(cls, key: str) -> dict[str, Any]:
        """JSON Schema of what may stand under `key`."""

    @abstractmethod
    def plain(self) -> tuple[str, object]:
        """Key and YAML data that read back as this demand."""

    @abstractmethod
    def statements(self, facts: Facts, chosen: Chosen) -> Iterator[Statement]:
        """The demand as statements, all hard."""

    @abstractmethod
    def broken(self, cuts: CutSequence, chosen: Chosen) -> Iterator[Breach]:
        """Where cuts do not meet the demand."""

    def selectors(self) -> tuple[Selector, ...]:
        """The further selectors it has."""
        return ()

    def pairs(self, chosen: Chosen) -> list[tuple[int, int]]:
        """Contour numbers (before, after) that it orders."""
        return []

    def together(self, chosen: Chosen) -> list[tuple[int, ...]]:
        """Sets of contour numbers that it keeps free of others."""
        return []

    def unjudged(self, cuts: CutSequence) -> str | None:
        """Why it cannot be judged on these cuts, where that is so."""
        return None


def read_true(node: yaml.Node, problems: Problems, what: str) -> None:
    """For keys that say all by being there: note anything but `true` as a problem."""
    try:
        if Flag().read(node):
            return
    except Unfit as error:
        problems.add(node, f"{what}: {error}")
        return
    problems.add(node, f"{what}: expected true; leave the key out to ask nothing")
