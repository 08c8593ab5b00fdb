"""Contours with slots, notches, corners and necks of every size, and what a kerf of 1.5 mm makes of them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from kerfwise.encoder.narrow_features import LostFeatureSpan, lost_walls
from kerfwise.rule_kit import Contour, Curve, Kind, circle
from kerfwise.rules.case import Rows

KERF_MM = 1.5


def contour(rows: Rows, kind: Kind = "outer") -> Contour:
    return Contour("P.outer" if kind == "outer" else "P.hole1", "P", kind, Curve.of(rows))


def plate(*notch: tuple[float, ...]) -> Contour:
    """A plate of 60 x 100 mm with a notch in the middle of its upper side, its points from right to left."""
    return contour([(0, 0), (60, 0), (60, 100), *notch, (0, 100)])


def slot(width_mm: float, depth_mm: float) -> Contour:
    right, left, bottom = 30 + width_mm / 2, 30 - width_mm / 2, 100 - depth_mm
    return plate((right, 100), (right, bottom), (left, bottom), (left, 100))


def round_slot(width_mm: float, depth_mm: float) -> Contour:
    right, left, bottom = 30 + width_mm / 2, 30 - width_mm / 2, 100 - depth_mm
    return plate((right, 100), (right, bottom, -1), (left, bottom), (left, 100))


def notch(angle_deg: float, mouth_mm: float) -> Contour:
    return plate(
        (30 + mouth_mm / 2, 100),
        (30, 100 - mouth_mm / 2 / math.tan(math.radians(angle_deg) / 2)),
        (30 - mouth_mm / 2, 100),
    )


def corner(angle_deg: float) -> Contour:
    """A hole with this angle at its left tip; its other corners are right or blunt."""
    half, arm_mm = math.radians(angle_deg) / 2, 40.0
    x, y = arm_mm * math.cos(half), arm_mm * math.sin(half)
    return contour([(0, 0), (x, -y), (x + 60, -y), (x + 60, y), (x, y)], "hole")


def relief(width_mm: float, depth_mm: float) -> Contour:
    """An angle bracket with a bend relief beside its inner corner."""
    return contour(
        [(0, 0), (60, 0), (60, 30), (30, 30), (30, 30 - depth_mm), (30 - width_mm, 30 - depth_mm), (30 - width_mm, 60),
         (0, 60)]
    )  # fmt: skip


def neck(width_mm: float) -> Contour:
    """A hole of two chambers of 20 x 20 mm joined by a neck 20 mm long."""
    low, high = 10 - width_mm / 2, 10 + width_mm / 2
    return contour(
        [(0, 0), (20, 0), (20, low), (40, low), (40, 0), (60, 0), (60, 20), (40, 20), (40, high), (20, high), (20, 20),
         (0, 20)],
        "hole",
    )  # fmt: skip


def pocket(mouth_mm: float) -> Contour:
    """A plate with a pocket of 20 x 20 mm behind a mouth 20 mm long."""
    right, left = 30 + mouth_mm / 2, 30 - mouth_mm / 2
    return plate((right, 100), (right, 80), (40, 80), (40, 60), (20, 60), (20, 80), (left, 80), (left, 100))


def dog_bone(radius_mm: float) -> Contour:
    """A square hole with a round relief about one of its corners: three quarters of a circle that reach into metal."""
    bulge = -math.tan(3 * math.pi / 8)
    return contour([(radius_mm, 0), (30, 0), (30, 30), (0, 30), (0, radius_mm, -bulge)], "hole")


def comb(teeth: int, gap_mm: float) -> Contour:
    """A comb: many slots side by side."""
    rows: list[tuple[float, ...]] = [(0, 0), (teeth * 10.0, 0)]
    for k in range(teeth - 1, -1, -1):
        rows += [(10 * k + 10, 50), (10 * k + gap_mm, 50), (10 * k + gap_mm, 20), (10 * k, 20)]
    return contour([*rows[:-2], (0, 50)])


DISC = contour(circle(0, 0, 20))
SMALL_HOLE = contour(circle(0, 0, 0.8), "hole")

FITS = {
    **{f"slot of {w} mm": slot(w, 80) for w in (1.52, 1.6, 2.0, 3.0)},
    **{f"round slot of {w} mm": round_slot(w, 40) for w in (1.52, 1.6, 2.0, 3.0)},
    **{f"dent of {w} x {d} mm": slot(w, d) for w, d in ((0.5, 0.2), (1.0, 0.3), (1.3, 0.4), (1.49, 0.4))},
    **{f"corner of {a}°": corner(a) for a in (58, 60, 75, 90, 105, 120, 150)},
    **{f"notch of {a}°, {m} mm wide": notch(a, m) for a in (60, 90, 120, 150) for m in (0.5, 1.0, 2.0, 5.0)},
    **{f"neck of {w} mm": neck(w) for w in (1.6, 2.0, 3.0)},
    **{f"pocket behind {w} mm": pocket(w) for w in (1.6, 2.0, 3.0)},
    **{f"dog bone of {r} mm": dog_bone(r) for r in (1.2, 2.0)},
    "bend relief of 2 mm": relief(2.0, 4.0),
    "comb of 2 mm": comb(8, 2.0),
    "disc": DISC,
    "small hole": SMALL_HOLE,
}
"""Shapes that a kerf of 1.5 mm enters as far as a round kerf can."""

LOST = {
    **{f"slot of {w} mm": (slot(w, 80), w, 80.0) for w in (0.5, 0.8, 1.0, 1.3, 1.45, 1.49)},
    **{
        f"shallow slot of {w} x {d} mm": (slot(w, d), w, d) for w, d in ((0.5, 0.5), (1.0, 0.5), (1.0, 1.0), (1.4, 2.0))
    },
    **{f"round slot of {w} mm": (round_slot(w, 40), w, 40 + w / 2) for w in (0.5, 1.0, 1.4)},
    **{f"neck of {w} mm": (neck(w), w, 40.0) for w in (0.5, 1.0, 1.4)},
    **{f"pocket behind {w} mm": (pocket(w), w, 40.0) for w in (0.5, 1.0, 1.4)},
    "bend relief of 1 mm": (relief(1.0, 4.0), 1.0, 4.0),
    "bend relief of 0.6 mm": (relief(0.6, 1.5), 0.6, 1.5),
    "dog bone of 1 mm": (dog_bone(1.0), math.sqrt(2), 1.7),
    "comb of 1 mm": (comb(8, 1.0), 1.0, 30.0),
}
"""Shapes with a feature that such a kerf would lose, its width and its depth, mm."""

SHARP = {f"corner of {a}°": (corner(a), a) for a in (20, 30, 40, 50, 57)} | {
    f"notch of {a}°": (notch(a, m), a) for a, m in ((20, 5.0), (30, 1.0), (45, 5.0))
}
"""Corners sharper than those a kerf can be used for, with their angles."""


def lost_features(
    contours: Sequence[Contour], kerf_mm: float, paths: Mapping[str, Curve] | None = None
) -> dict[str, tuple[LostFeatureSpan, ...]]:
    """The features that a kerf would lose of each contour that loses some, by its id, without what is left of them."""
    return {name: tuple(one for one, _ in of) for name, of in lost_walls(contours, kerf_mm, paths).items()}
