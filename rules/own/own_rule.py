"""A rule of the plant's own: a name, a reason, which contours it is about, and what it asks of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from kerfwise.rules.options.quantities import LENGTH
from kerfwise.rules.options.yaml_positions import Place as FilePlace
from kerfwise.rules.rule import Strength

from .apart import Apart
from .demand import Ask, Chosen
from .direction_entry import DirectionAsk, PlaceAsk
from .first_last import Ends
from .named_facts import KnownFacts
from .one_stays import OneStays
from .order import OrderAsk
from .runs import Together
from .scope import groups
from .selector import Selector

PREFIX = "own:"
"""What the id of every own rule begins with."""

ASKS: Mapping[str, type[Ask]] = {
    key: kind for kind in (OrderAsk, Ends, Together, Apart, OneStays, DirectionAsk, PlaceAsk) for key in kind.KEYS
}
"""Key in a profile → the kind of demand that stands under it."""


@dataclass(frozen=True, slots=True)
class OwnRule:
    """One entry of a profile's `own_rules`; `weight` (mm of idle travel) only where it is soft."""

    name: str
    ask: Ask
    select: Selector = field(default_factory=Selector)
    scope: str = "sheet"
    why: str = "a rule of the plant's own"
    strength: Strength = "hard"
    weight: float | None = None
    place: FilePlace | None = field(default=None, compare=False)

    @property
    def id(self) -> str:
        """What plans and checks call it."""
        return PREFIX + self.name

    def facts(self) -> set[str]:
        """Names of the facts that it looks at."""
        reach = {self.scope} - {"sheet"}
        return set().union(reach, self.select.names(), *(s.names() for s in self.ask.selectors()))

    def chosen(self, known: KnownFacts) -> Chosen:
        """Which contours it is about on one nest."""
        selected = set(self.select.chosen(known))
        parted = ((tuple(k for k in group if k in selected), group) for group in groups(known, self.scope))
        return Chosen(self.id, self.why, known, tuple((own, group) for own, group in parted if own))

    def plain(self) -> dict[str, object]:
        """The YAML data that reads back as this rule."""
        key, demand = self.ask.plain()
        made: dict[str, object] = {"name": self.name, "why": self.why, "strength": self.strength}
        if self.weight is not None:
            made["weight"] = LENGTH.write(self.weight)
        return made | {"select": self.select.plain(), key: demand, "scope": self.scope}


@dataclass(frozen=True, slots=True)
class OwnFile:
    """An entry `{file: rule.mzn}`: a rule in MiniZinc, which `rules/flat` reads.

    `parameters` are those of the file that the entry sets, by key.
    """

    file: str
    name: str
    why: str = "a rule of the plant's own, in MiniZinc"
    strength: Strength = "hard"
    weight: float | None = None
    parameters: tuple[tuple[str, int | bool | str], ...] = ()
    place: FilePlace | None = field(default=None, compare=False)

    @property
    def id(self) -> str:
        """What plans and checks call it."""
        return PREFIX + self.name

    def with_parameters(self, given: Mapping[str, int | bool | str]) -> OwnFile:
        """The same entry with these parameters and no others."""
        return replace(self, parameters=tuple(given.items()))

    @property
    def path(self) -> Path:
        """The file, looked up beside the profile that names it."""
        return Path(self.place.file).parent / self.file if self.place else Path(self.file)

    def plain(self) -> dict[str, object]:
        """The YAML data that reads back as this entry."""
        made: dict[str, object] = {"file": self.file, "name": self.name, "why": self.why, "strength": self.strength}
        if self.weight is not None:
            made["weight"] = LENGTH.write(self.weight)
        return made | {"parameters": dict(self.parameters)} if self.parameters else made


Own = OwnRule | OwnFile
