"""What the check says of every rule, as data."""

from __future__ import annotations

from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.check.judgement import Judgement
from kerfwise.postproc.report.page_data import Data, short
from kerfwise.rules.profile.profile import Profile


def rules_data(verdict: CheckResult, profile: Profile) -> list[Data]:
    """Every rule that is on: its strength, its verdict, where it is broken or excused, and what that costs, mm."""
    settings = profile.settings()
    weights = {name: setting.weight for name, setting in settings.items()}
    return [_rule(judged, weights.get(judged.id)) for judged in verdict.rules if judged.strength != "off"]


def _rule(judged: Judgement, weight_mm: float | None) -> Data:
    return {
        "id": judged.id,
        "sentence": judged.sentence,
        "strength": judged.strength,
        "verdict": judged.verdict,
        "cost_mm": short(len(judged.violations) * (weight_mm or 0.0), 1),
        "unjudged": judged.unjudged or "",
        "breaches": [{"contours": list(v.contours), "text": v.text} for v in judged.violations],
        "excused": [
            {"contours": list(e.violation.contours), "text": e.violation.text, "why": e.why} for e in judged.excused
        ],
    }
