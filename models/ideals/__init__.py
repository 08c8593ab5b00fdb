"""An exact dynamic program over ideals: the set already cut and the last site (Held and Karp 1962; Salii 2019)."""

from .prove import Proof, fits, prove

__all__ = ["Proof", "fits", "prove"]
