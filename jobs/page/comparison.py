"""What differs between two ways to cut a nest, as data."""

from __future__ import annotations

from kerfwise.jobs.compare.comparison import Compared
from kerfwise.jobs.compare.text import figure_rows, proofs, rule_rows, sides, summary_of
from kerfwise.postproc.report.page_data import Data


def comparison_data(made: Compared) -> Data:
    """Figures, rules and cuts of both sides, in the words that `kerfwise compare` prints."""
    index = made.a.given.nest.index
    return {
        "sides": sides(made),
        "figures": [list(row) for row in figure_rows(made)],
        "rules": [list(row) for row in rule_rows(made)],
        "proofs": proofs(made),
        "summary": summary_of(made.changed, len(made.cuts)),
        "changed": [
            {"contour": index.get(pair.contour, -1), "a": pair.a, "b": pair.b, "told": pair.told}
            for pair in made.changed
        ],
    }
