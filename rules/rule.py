"""What a rule is: it states what must hold over facts, and judges a finished sequence of cuts by geometry alone."""

from __future__ import annotations

import hashlib
import inspect
import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Generic, Literal, TypeVar

from kerfwise.encoder.cut import CutSequence, Side
from kerfwise.encoder.errors import naming_the_rule
from kerfwise.encoder.nest import Ids, Nest

from .expression.over_cuts import out_of_order
from .judging.violation import NoGoodIds as NoGoodIds
from .judging.violation import Violation as Violation
from .lock import Lock
from .statements import About, Precede, Statement

if TYPE_CHECKING:
    from kerfwise.encoder.candidates.candidate import LeadOptions
    from kerfwise.encoder.facts.facts import FactOptions, Facts


Strength = Literal["hard", "soft", "off"]
Forced = Callable[[str], frozenset[str]]
"""Contour id → the contours that the hard order rules put before it in every plan."""
SumOfIds = tuple[tuple[tuple[Ids, int], ...], int]
"""Orders of contour ids (before, after), each with a weight over 0: those that hold come to so much at the least."""
OptionsT = TypeVar("OptionsT")

OTHER_CUTS = "Links, tabs and other cuts"
"""The heading under which a rule says what it means for cuts beyond one contour and one pierce."""
HEADINGS = ("What it does", OTHER_CUTS, "Why", "Wrong", "Right")
"""The headings, in this order, of every shipped rule's docstring."""


def name_in_programs(rule: str) -> str:
    """What a program's comments call a rule: one whose name they cannot hold as it is bears a mark of that.

    Examples
    --------
    >>> name_in_programs("level-ahead"), name_in_programs("own:Größe")
    ('level-ahead', 'own:Größe.368ac2')
    """
    if re.fullmatch("(own:)?[a-z0-9]+(-[a-z0-9]+)*", rule):
        return rule
    return f"{rule}.{hashlib.sha256(rule.encode('utf-8', 'surrogatepass')).hexdigest()[:6]}"


@dataclass(frozen=True, slots=True)
class RuleSetting:
    """What a profile makes of one rule; `weight` (mm of idle travel a breach) only where it is soft."""

    strength: Strength
    weight: float | None
    options: Any


class Rule(ABC, Generic[OptionsT]):
    """One rule of cutting; one folder of `catalogue/` holds one.

    The class docstring is the rule's page, under the headings `HEADINGS`; a plant's rule may leave out `OTHER_CUTS`.
    `sentence` says in one line what the rule asks, `source` where it comes from. `strengths` are those a profile may
    give it, `default` the one it has where a profile is silent, `default_weight` (mm of idle travel) what breaking it
    once costs when soft. A rule with `gives_way` above 0 may be dropped where order rules contradict each other, the
    highest first. One that is `excusable`, and hard, is broken where nothing else is left, in as few places as can be,
    and the plan says where. `relaxable` is a rule that cannot be soft, but whose statements `--relax` may relax; those
    of one that is `relaxed_last` only where all other rules together do not help. One rule is `of_fallen_metal`: what
    breaks it would be cut in metal that has fallen out, so that it is never relaxed, and contours that stay uncut are
    told as its.

    Fields of `Options` that no key sets (no metadata) are filled in by the profile: from `Plant`, or from the option of
    the same name that another rule `shares`.

    No engine and no other stage asks for a rule by its id. What they must know of single rules, rules say themselves:
    by the hooks `fact_options`, `lead_options`, `temperature_limit` and `check_with`, and by these marks. A soft rule
    that is `hard_with_head_down` is hard where the machine's head stays down. While a rule is on that `guards_metal`,
    contours of two parts may not burn each other's metal. One that `makes_zones` leaves large nests far fewer orders.
    One that does not mind zones (`minds_zones`) states the same by any; a class that states anew minds them anew.

    Where a program goes on after a stop, facts are those of what is left, and cuts begin with those that are made,
    which are not judged: a violation counts where all its cuts are new, and where a rule `minds_what_is_out`, that is,
    judges a cut by what was cut before it, where the last of them is. A rule `of_whole_nest` states over the facts of
    the whole; what the cuts made have decided is left out.

    Ways along stretches of contours, cut before these are finished (`cuts: {snake: …}`), are no contours: only
    a rule that `minds_ways` states of them, and all others see facts without them.

    Where several torches cut at once, the orders of a rule `of_each_torch` are asked of what each of them cuts, not
    between two of them. All other rules judge the cuts of all torches, and what is cut at one time counts as cut in
    whichever order is worse.

    The pairs of a rule whose `pairs_are` is the name of a fact about two contours are what the check knows of that
    fact, by geometry of its own. A hard rule that `must_be_judged` fails the check where it cannot be judged; of others
    that is said, and no more. `takes_no_file` says why no file of a plant may take the rule's place, where that is so.
    `brought` says who has brought a rule that is not of the catalogue: `rules/outside` sets it, and `stands_in` where
    that is a file of the plant.
    """

    id: str
    sentence: str
    source: str
    Options: ClassVar[type]
    strengths: ClassVar[tuple[Strength, ...]] = ("hard", "soft", "off")
    default: ClassVar[Strength] = "hard"
    default_weight: ClassVar[float] = 1000.0
    gives_way: ClassVar[int] = 0
    excusable: ClassVar[bool] = False
    relaxable: ClassVar[bool] = False
    minds_what_is_out: bool = False
    of_whole_nest: ClassVar[bool] = False
    minds_ways: ClassVar[bool] = False
    relaxed_last: ClassVar[bool] = False
    of_fallen_metal: ClassVar[bool] = False
    hard_with_head_down: ClassVar[bool] = False
    guards_metal: ClassVar[bool] = False
    makes_zones: ClassVar[bool] = False
    minds_zones: ClassVar[bool] = True
    of_each_torch: ClassVar[bool] = False
    shares: ClassVar[tuple[str, ...]] = ()
    must_be_judged: ClassVar[bool] = False
    takes_no_file: ClassVar[str] = ""
    brought: str = ""
    stands_in: RuleFile | None = None
    pairs_are: ClassVar[str] = ""

    @property
    def may_be_relaxed(self) -> bool:
        """Whether `--relax` may let single statements go, hard as they are: never what is promised of metal."""
        return not self.of_fallen_metal and ("soft" in self.strengths or self.relaxable or self.relaxed_last)

    def __init_subclass__(cls, **options: Any) -> None:
        """What a rule raises that nobody foresaw names the rule."""
        super().__init_subclass__(**options)
        if "statements" in vars(cls) and "minds_zones" not in vars(cls):
            cls.minds_zones = True
        for name, hook in list(vars(cls).items()):
            if inspect.isfunction(hook) and not name.startswith("__"):
                setattr(cls, name, naming_the_rule(hook))

    @abstractmethod
    def statements(self, facts: Facts, options: OptionsT) -> Iterable[Statement]:
        """What the rule asks of a plan, stated as hard; the profile's strength is applied outside."""

    @abstractmethod
    def violations(self, nest: Nest, cuts: CutSequence, options: OptionsT) -> list[Violation]:
        """Where a sequence of cuts breaks the rule, found from geometry alone, never from facts or statements."""

    def pairs(self, nest: Nest, cuts: CutSequence, options: OptionsT) -> list[Ids]:
        """Contour ids (before, after) that the rule orders, found from geometry (and what the cuts state) alone."""
        return []

    def together(self, nest: Nest, options: OptionsT) -> list[tuple[str, ...]]:
        """Sets of contour ids that the rule keeps free of other contours between them."""
        return []

    def sums(self, nest: Nest, cuts: CutSequence, options: OptionsT) -> list[SumOfIds]:
        """Sums of orders that the rule asks for, found as `pairs` are; what `gives_way` does so to these."""
        return []

    def unjudged(self, nest: Nest, cuts: CutSequence, options: OptionsT) -> str | None:
        """Why the rule cannot be judged on these cuts, where that is so (an NC program tells less than a plan)."""
        return None

    def selects_nothing(self, nest: Nest, cuts: CutSequence, options: OptionsT) -> str | None:
        """Why there is nothing on this nest that the rule is about, where that may be a slip; told as a warning."""
        return None

    def exempt(self, facts: Facts, options: OptionsT) -> Iterable[About]:
        """Contours that nothing can make keep the rule, whatever the order; it states nothing of them."""
        return ()

    def excuse(
        self, nest: Nest, cuts: CutSequence, options: OptionsT, violation: Violation, forced: Forced
    ) -> str | None:
        """Why a violation of the rule, hard as it is, may stand; None if it may not. From geometry and the cuts."""
        return None

    def no_goods(self, nest: Nest, order: Sequence[str], options: OptionsT) -> list[NoGoodIds]:
        """What is wrong with a complete order of contour ids that no statement could say beforehand."""
        return []

    def fact_options(self, given: FactOptions, options: OptionsT, strength: Strength) -> FactOptions:
        """The options of the facts, with what this rule needs of them in the place of what is `given`.

        Every rule is asked, also one that is off: its `strength` says so. Facts that only it reads, it adds to
        `columns`, with what computes them: see `scrap_last`.
        """
        return given

    def lead_options(self, given: LeadOptions, options: OptionsT, strength: Strength) -> LeadOptions:
        """How candidates are made, with what this rule asks of them; see `fact_options`."""
        return given

    def temperature_limit(self, options: OptionsT) -> TemperatureLimit | None:
        """How hot metal may become by this rule: the orders that engines find are simulated then."""
        return None

    def check_with(
        self, options: OptionsT, plant: Plant, rules: Mapping[str, RuleSetting]
    ) -> Iterable[tuple[str, str]]:
        """What contradicts the rest of the profile, while the rule is on: the option's key, and what is wrong with it.

        `rules` are the settings of every rule, whether on or off.
        """
        return ()

    def allowances(self, options: OptionsT) -> tuple[OptionsT, ...]:
        """The options by which the check is as strict as what is stated, at the least and at the most.

        Of rules that judge by finer steps than they state: their `violations` allow for it. The least comes first.
        """
        return ()

    def still_counts(self, violation: Violation, made: int) -> bool:
        """Whether a violation is one of the cuts after the first `made`, which are facts."""
        decides = max if self.minds_what_is_out else min
        return not violation.cuts or decides(violation.cuts) > made

    def about(self, contours: Sequence[str], sentence: str) -> About:
        """Where a statement of this rule comes from."""
        return About(self.id, tuple(contours), sentence)

    def page(self) -> str:
        """The rule's page, in Markdown, without its settings."""
        return inspect.getdoc(type(self)) or self.sentence


class OrderRule(Rule[OptionsT]):
    """A rule that says which contour is cut before which, and no more."""

    @abstractmethod
    def pairs(self, nest: Nest, cuts: CutSequence, options: OptionsT) -> list[Ids]: ...

    @abstractmethod
    def reason(self, before: str, after: str, start_side: Side | None) -> str:
        """Why `before` goes first, as the end of a sentence."""

    def precede(self, facts: Facts, before: int, after: int) -> Precede:
        """The statement that contour number `before` is cut before number `after`, with the reason."""
        return self.precede_each(facts, [(before, after)])[0]

    def precede_each(self, facts: Facts, pairs: Iterable[Sequence[int]]) -> list[Precede]:
        """The same of many pairs: large nests have hundreds of thousands."""
        rule, contours, side, reason = self.id, facts.nest.contours, facts.start_side, self.reason
        return [
            Precede(i, j, About(rule, (a := contours[i].id, b := contours[j].id), _order(a, b, reason(a, b, side))))
            for i, j in pairs
        ]

    def violations(self, nest: Nest, cuts: CutSequence, options: OptionsT) -> list[Violation]:
        """Every pair that is cut the wrong way round."""
        at = cuts.positions()
        turned = [pair for pair in self.pairs(nest, cuts, options) if at.get(pair[0], 0) > at.get(pair[1], 0)]
        found = (out_of_order(*pair, at) for pair in turned)
        return [
            Violation(self.id, ids, f"{text}: {self.reason(ids[0], ids[1], cuts.start_side)}", positions)
            for ids, text, positions in filter(None, found)
        ]


def _order(before: str, after: str, reason: str) -> str:
    return f"{before} is cut before {after}: {reason}"


# The file that a rule of a plant stands in, as plans, programs and lists of rules name it.


@dataclass(frozen=True, slots=True)
class RuleFile:
    """A file of a rule, the digest of its content, and whether the rule takes the place of a shipped one."""

    path: Path
    sha256: str
    in_place_of_shipped: bool = False


# A limit on how hot metal may become, whichever rule sets it.


@dataclass(frozen=True, slots=True)
class TemperatureLimit:
    """No metal becomes hotter than `most_c`; the torch may wait for it to cool where `dwells`, `longest_dwell_s` each.

    `rule` is the id of the rule that says so. Its options for waits are `dwells` and `longest_dwell`: messages tell
    planners to set them.

    Examples
    --------
    >>> TemperatureLimit("cool", 90.0, dwells=False, longest_dwell_s=60.0).allowed_dwell_s
    0.0
    """

    rule: str
    most_c: float
    dwells: bool
    longest_dwell_s: float

    @property
    def allowed_dwell_s(self) -> float:
        """The longest wait allowed, s."""
        return self.longest_dwell_s if self.dwells else 0.0


# What rules may know of a profile beside their own options.


@dataclass(frozen=True, slots=True)
class Plate:
    """The sheet's metal and how it is cut: what a rule may read of the profile."""

    thickness_mm: float = 6.0
    material: str = "S235"
    process: str = "plasma"
    density_kg_m3: float = 7850.0
    cut_mm_s: float = 40.0
    mark_mm_s: float = 100.0
    pierce_s: float = 0.5
    mark_s: float = 0.2


USUAL = Plate()
"""What is read where no profile is given."""


@dataclass(frozen=True, slots=True)
class Plant:
    """The plant's sheet, its heat, its locks, and what cuts.

    A field of a rule's `Options` that no key of its own sets, and that has the name of one of these, takes its value.
    """

    thickness_mm: float
    kerf_mm: float
    ambient_c: float
    heat_limit_c: float
    absorbed_power_w: float
    locks: tuple[Lock, ...]
    process: str = "plasma"
    common_cuts: bool = False
    snakes: bool = False
    longest_link_mm: float = 0.0
    plate: Plate = USUAL
