"""An exact dynamic program over ideals: the set already cut and the last site (Held and Karp 1962; Salii 2019)."""

from kerfwise.models.engines.tuning import STAGES

from .prove import Proof, priceable, prove, prove_priced, sets_out, unfit, widen
from .sets import Count, count_sets

__all__ = [
    "STAGES",
    "Count",
    "Proof",
    "count_sets",
    "priceable",
    "prove",
    "prove_priced",
    "sets_out",
    "unfit",
    "widen",
]
