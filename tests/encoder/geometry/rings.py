"""Closed curves for tests, made at random, and how far an offset of one is from where it belongs."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import shapely
from hypothesis import strategies as st

from kerfwise.rule_kit import Curve


@st.composite
def star_rings(draw: st.DrawFn) -> Curve:
    """Rings of lines and arcs around the origin, 4 to 20 mm from it, corners and hollows of all kinds."""
    seed, count = draw(st.integers(0, 2**32 - 1)), draw(st.integers(3, 24))
    rng = np.random.default_rng(seed)
    angle = (np.arange(count) + rng.uniform(0.1, 0.9, count)) * math.tau / count
    radius = rng.uniform(4, 20, count) if draw(st.booleans()) else rng.normal(12, 0.4, count)
    bulge = np.where(rng.random(count) < draw(st.floats(0, 1)), rng.uniform(-0.7, 0.7, count), 0.0)
    return turned(np.column_stack([radius * np.cos(angle), radius * np.sin(angle), bulge]), draw(st.booleans()))


@st.composite
def flattened_rings(draw: st.DrawFn) -> Curve:
    """Smooth blobs in hundreds of tiny chords, with coordinates to a hundredth as drawings have them."""
    seed, count = draw(st.integers(0, 2**32 - 1)), draw(st.integers(60, 500))
    rng = np.random.default_rng(seed)
    a = np.arange(count) * math.tau / count
    wave = sum(rng.normal(0, 1.2) / k * np.cos(k * a + rng.uniform(0, 6)) for k in range(2, 8))
    radius = 12 + np.clip(wave, -7, 7)
    points = np.column_stack([radius * np.cos(a), radius * np.sin(a)]).round(2)
    return turned(np.column_stack([points, np.zeros(count)]), draw(st.booleans()))


def turned(vertices: np.ndarray[tuple[int, int], np.dtype[np.float64]], over: bool) -> Curve:
    """The ring, the other way round if `over`."""
    return Curve(vertices).reversed() if over else Curve(vertices)


def is_simple(curve: Curve) -> bool:
    """Whether a ring bounds an area without touching itself; nor may it turn back where chords would not tell."""
    segments = curve.segments
    turned_back = any(
        np.dot(a.tangent_at(1.0), b.tangent_at(0.0)) < -0.99 for a, b in pairwise([*segments, segments[0]])
    )
    return (
        min(s.length_mm for s in segments) > 1e-3
        and not turned_back
        and abs(curve.signed_area_mm2) > 20
        and curve.polygon(0.0005).is_valid
    )


def true_offset(curve: Curve, distance_mm: float) -> shapely.Geometry:
    """The area bounded by the offset, put together from the bands of single chords, which nothing evens out."""
    points = shapely.get_coordinates(curve.line(0.0005))
    chords = shapely.linestrings(np.stack([points[:-1], points[1:]], axis=1))
    band = shapely.union_all(shapely.buffer(chords, abs(distance_mm), quad_segs=24))
    area = curve.polygon(0.0005)
    return area.union(band) if distance_mm > 0 else area.difference(band)


def hausdorff_mm(a: shapely.Geometry, b: shapely.Geometry) -> float:
    """Greatest distance of a point of either line from the other one, sampled every 0.1 mm."""
    return max(
        float(shapely.distance(shapely.points(shapely.get_coordinates(shapely.segmentize(one, 0.1))), other).max())
        for one, other in ((a, b), (b, a))
    )
