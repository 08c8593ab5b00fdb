"""Figures 1–4 of Pristupov 2016 as tiny nests, with the answers that the text gives.

The drawings are not in the text, so these are laid out to fit its words. Cutting starts at the left.
"""

from __future__ import annotations

from kerfwise import Nest
from kerfwise.rule_kit import nest, part, rect

FIGURE_1_ORDER = ("B.hole1", "B.outer", "A.hole1", "A.outer")
"""Contours nested in each other: from the inside out, no other order."""


def figure_1() -> Nest:
    """A host with a part in its hole, which has a hole itself."""
    return nest(
        600,
        600,
        part("A", rect(50, 50, 500, 500), [rect(150, 150, 300, 300)]),
        part("B", rect(200, 200, 200, 200), [rect(250, 250, 100, 100)]),
    )


FIGURE_2A_FIRST = ("island.outer", "last.outer")
"""Cut the part in the middle before the one that would close the ring around it."""


def figure_2a() -> Nest:
    """Several simple parts around one: cutting all but the middle one would leave it on an island."""
    return nest(
        640,
        640,
        part("first", rect(20, 20, 180, 600)),
        part("below", rect(220, 20, 200, 180)),
        part("island", rect(220, 220, 200, 200)),
        part("above", rect(220, 440, 200, 180)),
        part("last", rect(440, 20, 180, 600)),
    )


FIGURE_2B_FIRST = ("island.outer", "hook.outer")


def figure_2b() -> Nest:
    """One part of complex non-convex shape that all but closes around another."""
    hook = [(20, 20), (620, 20), (620, 620), (350, 620), (350, 560), (540, 560), (540, 100), (100, 100), (100, 620)]
    return nest(640, 640, part("hook", [*hook, (20, 620)]), part("island", rect(200, 200, 240, 240)))


FIGURE_3_CUT = ("1.outer",)
FIGURE_3_ADMISSIBLE = ("2.outer", "3.outer")
"""With contour 1 cut, only these; contour 5 is not, since its shadow holds the centroid of uncut 3."""
FIGURE_3_IN_SHADOW_OF_5 = ("1.outer", "3.outer")


def figure_3() -> Nest:
    """Five contours, cut from the lower left to the right."""
    return nest(
        1000,
        600,
        part("1", rect(10, 10, 200, 250)),
        part("2", rect(10, 300, 200, 280)),
        part("3", rect(230, 10, 200, 250)),
        part("4", rect(230, 300, 250, 280)),
        part("5", rect(500, 10, 300, 280)),
    )


FIGURE_4_LAST = "3.outer"
"""The convex hull of the massive part holds the centroids of the others, so it is cut last."""


def figure_4() -> Nest:
    """A large non-convex part with two smaller ones in its mouth."""
    massive = [(50, 50), (950, 50), (950, 550), (800, 550), (800, 200), (200, 200), (200, 550), (50, 550)]
    return nest(
        1000,
        600,
        part("1", rect(220, 330, 250, 200)),
        part("2", rect(500, 330, 250, 200)),
        part("3", massive),
    )
