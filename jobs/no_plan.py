"""That no plan was found, and, where it can be shown, which hard rules contradict each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.rules.profile.profile import Profile

if TYPE_CHECKING:
    from kerfwise.models.plan.conflict import Conflict

NOT_SHOWN = "which rules contradict each other, if any do, was not shown within the limit"


class NoPlan(RulesConflict):
    """No plan holds every hard rule, or none was found.

    Attributes
    ----------
    conflict
        Statements that contradict each other, in sentences with contour ids, and the cheapest way out. None where no
        contradiction was shown: then `message` and `reasons` say all there is to say.
    within_limit
        Whether the look for a contradiction came to its end within the limit.
    why
        What went wrong in the first place.
    facts, profile
        What was to be planned.
    """

    def __init__(
        self,
        why: RulesConflict,
        facts: Facts,
        profile: Profile,
        conflict: Conflict | None = None,
        within_limit: bool = True,
    ) -> None:
        super().__init__(why.message, why.reasons)
        self.why, self.facts, self.profile, self.conflict = why, facts, profile, conflict
        self.within_limit = within_limit

    def __str__(self) -> str:
        if self.conflict is not None:
            return str(self.conflict)
        return str(self.why) if self.within_limit else f"{self.why}\n  note: {NOT_SHOWN}"
