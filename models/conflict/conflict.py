"""Why the hard rules cannot all hold, the cheapest way out of it, and the statements once that way is taken."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from ...encoder.errors import RulesConflict
from ...encoder.facts.facts import Facts
from ...rules.profile import Profile
from ...rules.state import DroppedStatement, Stated, every_statement, resolve
from ...rules.statements import About, Forbid, Precede, Statement
from ..plan import RELAXED
from .core import find_core
from .group import hard_groups
from .order_model import NotAnswered
from .relax import find_relaxation, soften

MOST = 20


@dataclass(frozen=True, slots=True)
class Conflict:
    """Statements that contradict each other, and those that should give way.

    Without any one of `clash` the others of it could hold (unless `minimal` is False). `relax` is what must give way
    so that *all* rules can hold: None where nothing that may give way helps or none was found, and then `stuck` says
    which. `notes` are what no statement says.
    """

    clash: tuple[About, ...]
    minimal: bool
    relax: tuple[About, ...] | None
    stuck: str = ""
    notes: tuple[str, ...] = ()

    @property
    def contours(self) -> tuple[str, ...]:
        """The ids of the contours in conflict, each once."""
        return tuple(dict.fromkeys(name for about in self.clash for name in about.contours))

    def lines(self) -> Iterator[str]:
        """The conflict in a planner's words."""
        yield "these hard rules cannot all hold" + (
            "; without any one of them the others can:" if self.minimal else ":"
        )
        yield from _listed(self.clash)
        yield from (f"  note: {note}" for note in self.notes)
        if self.relax is None:
            yield self.stuck
            return
        yield "the cheapest way out:"
        by_rule: dict[str, list[About]] = {}
        for about in self.relax:
            by_rule.setdefault(about.rule, []).append(about)
        for rule, abouts in by_rule.items():
            count = f"{len(abouts)} statement" + ("s" if len(abouts) > 1 else "")
            names = tuple(dict.fromkeys(name for about in abouts for name in about.contours))
            yield f"  relax {rule}: {count} about {_few(names)}"


def find_conflict(facts: Facts, profile: Profile) -> Conflict | None:
    """Why no plan of this nest can hold every hard rule of the profile; None if no contradiction is shown.

    Looked for among statements on order and entries; what moves cross and cooling in seconds are left out.
    """
    statements, _ = every_statement(facts, profile)
    hard = _asked(facts, profile, statements)
    try:
        core = find_core(facts, hard_groups(hard), _gives_way(profile))
    except NotAnswered:
        return None
    if core is None:
        return None
    clash = tuple(group.about for group in core.groups)
    stuck, relax = "", None
    try:
        relax = _way_out(facts, profile, statements)
    except RulesConflict as error:
        stuck = error.message
    forbidden = {s.candidate for group in core.groups for s in group.statements if isinstance(s, Forbid)}
    return Conflict(clash, core.minimal, relax, stuck, tuple(_only_ways(facts, profile, forbidden)))


def state_relaxed(facts: Facts, profile: Profile) -> Stated:
    """As `rules.state.state_rules`, but where hard rules contradict each other the cheapest way out is taken.

    What gives way costs more than any plan travels and is among `dropped`, each with a reason that begins with
    `models.plan.RELAXED`.

    Raises
    ------
    RulesConflict
        If nothing that may give way helps, or nothing was found within the work allowed.
    """
    statements, exempt = every_statement(facts, profile)
    out = _way_out(facts, profile, statements)
    relaxed = set(out)
    resolved = resolve(soften(statements, relaxed), facts.n, _gives_way(profile))
    given_up = {s.about: s for s in statements if s.weight is None and s.about in relaxed}
    dropped = tuple(DroppedStatement(s, f"{RELAXED}{about.sentence}") for about, s in given_up.items())
    return replace(resolved, dropped=(*resolved.dropped, *dropped), exempt=exempt)


def _way_out(facts: Facts, profile: Profile, statements: Sequence[Statement]) -> tuple[About, ...]:
    """What must give way: first where even rules that give way do not help."""
    book = profile.rulebook()
    out: list[About] = []
    while True:
        left = soften(statements, out)
        try:
            found = find_relaxation(facts, hard_groups(_asked(facts, profile, left)), book)
        except NotAnswered:
            raise RulesConflict("no way out was found within the limit (none is proven impossible)") from None
        if found is None:
            raise RulesConflict("no rule that may give way helps: change the locks or the nest")
        if not found.groups:
            return tuple(out)
        out += [group.about for group in found.groups]


def _asked(facts: Facts, profile: Profile, statements: Sequence[Statement]) -> Sequence[Statement]:
    """The statements once cycles are resolved; where that is impossible, without the orders that give way."""
    gives_way = _gives_way(profile)
    try:
        return resolve(statements, facts.n, gives_way).statements
    except RulesConflict:
        return [s for s in statements if not (isinstance(s, Precede) and gives_way[s.about.rule])]


def _gives_way(profile: Profile) -> dict[str, int]:
    return {name: rule.gives_way for name, rule in profile.rulebook().items()}


def _only_ways(facts: Facts, profile: Profile, forbidden: set[int]) -> Iterator[str]:
    """Contours in conflict over their entry that a hard cut-direction lets be cut one way round only."""
    directions = profile.lead_options().directions
    for k in sorted({facts.candidates[c].contour for c in forbidden}):
        contour = facts.nest.contours[k]
        ways = directions[contour.kind]
        if len(ways) == 1:
            yield f"cut-direction offers no other way round {contour.id} than {ways[0]}"


def _listed(abouts: Sequence[About]) -> Iterator[str]:
    yield from (f"  - {about.rule}: {about.sentence}" for about in abouts[:MOST])
    if len(abouts) > MOST:
        yield f"  … and {len(abouts) - MOST} more"


def _few(names: Sequence[str], most: int = 8) -> str:
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")
