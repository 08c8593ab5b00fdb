"""The band along a cut that yields: what its fibres pull and push with, since the torch passed, and for ever after.

A fibre beside the cut gets hotter than the metal bears, the cold sheet around it does not let it grow, and it is
squeezed; when it cools it is too short, and pulls. Each fibre at a distance from the edge goes through its own history
of temperature at no strain at all, elastic and perfectly plastic, its stress brought back to the yield stress of its
temperature in every step (return mapping). The heat of the passing torch is that of a line source in a plate that the
kerf has cut in half (Rosenthal 1946, fast source). What the elastic sheet is loaded with already, its thermal strain at
full modulus, is taken off, so that only the difference is left: `Band.pull_n`.

Limits: held fast means that narrow strips, which give way, yield less than this says; a band that is heated again by a
neighbour's cut does not yield again; the weakening of metal far from the cut is left out.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources

import numpy as np
import yaml

from kerfwise.arrays import Floats
from kerfwise.encoder.errors import InputError
from kerfwise.rules.profile.plant_sections import MATERIALS

from .elasticity import Elastic


@dataclass(frozen=True, slots=True)
class Metal:
    """One row of `metals.yaml`: modulus and yield stress, N/mm², expansion, 1/K, what heat leaves of both."""

    modulus: float
    poisson: float
    expansion: float
    yield_: float
    at_c: tuple[float, ...]
    of_modulus: tuple[float, ...]
    of_yield: tuple[float, ...]
    source: str

    def elastic(self, thickness_mm: float) -> Elastic:
        """A sheet of it."""
        return Elastic(self.modulus, self.poisson, self.expansion, thickness_mm)


def _read() -> Mapping[str, Metal]:
    text = (resources.files(__package__) / "metals.yaml").read_text(encoding="utf-8")
    return {
        name: Metal(**{("yield_" if key == "yield" else key): value for key, value in row.items()})
        for name, row in yaml.safe_load(text).items()
    }


METALS: Mapping[str, Metal] = _read()


def metal_of(material: str) -> Metal:
    """The metal of that name. Raises InputError if its strength is not known."""
    if material not in METALS:
        raise InputError(
            f"heat.material: {material} has no modulus, expansion and yield stress here, so that nobody can tell how "
            f"it bends: simulate one of {', '.join(METALS)}"
        )
    return METALS[material]


@dataclass(frozen=True, eq=False, slots=True)
class Band:
    """One side of a cut: what it pulls with, N, in excess of an elastic sheet, `since_s` (k,) after the torch passed.

    Never more than 0: what has yielded wants to be shorter. `depth_mm` is how far from the edge the pull acts at the
    end, `width_mm` how wide the band is that keeps a strain.
    """

    since_s: Floats
    pull_n: Floats
    depth_mm: float
    width_mm: float

    def pull(self, since_s: Floats) -> Floats:
        """What it pulls with, N, so long after the torch passed (any shape): 0 before, what is left at `inf`."""
        found = np.interp(since_s, self.since_s, self.pull_n)
        found[since_s <= 0] = 0.0
        return found

    @property
    def at_last_n(self) -> float:
        """What is left when all is cold, N."""
        return float(self.pull_n[-1])


@lru_cache(maxsize=256)
def yielded(material: str, thickness_mm: float, absorbed_w: float, feed_mm_s: float) -> Band:
    """The band beside a cut at a feed, with so many watts staying in the sheet.

    Examples
    --------
    >>> band = yielded("carbon-steel", 20.0, 3300.0, 355 / 60)
    >>> round(band.at_last_n / 1000), round(band.width_mm)
    (-59, 19)
    """
    metal, data = metal_of(material), MATERIALS[material]
    energy = absorbed_w / feed_mm_s / thickness_mm  # J/mm², half of it on each side
    yields_k = metal.yield_ / metal.modulus / metal.expansion
    reach_mm = max(energy / data.capacity_j_mm3 / math.sqrt(2 * math.pi * math.e) / yields_k, 1e-6)
    edges = np.concatenate([[0.0], np.geomspace(reach_mm / 100, 4 * reach_mm, 160)])
    d_mm, width = (edges[1:] + edges[:-1]) / 2, np.diff(edges)
    spreads = data.diffusivity_mm2_s
    since = np.geomspace((reach_mm / 100) ** 2 / spreads, 4e4 * reach_mm**2 / spreads, 600)
    plastic, pulls = np.zeros(len(d_mm)), [0.0]
    for at_s in since:
        excess = energy / data.capacity_j_mm3 / math.sqrt(4 * math.pi * spreads * at_s)
        warm = np.minimum(excess * np.exp(-(d_mm**2) / (4 * spreads * at_s)), data.melting_c - 20.0)
        modulus = np.maximum(metal.modulus * np.interp(20.0 + warm, metal.at_c, metal.of_modulus), 1e-3 * metal.modulus)
        most = metal.yield_ * np.interp(20.0 + warm, metal.at_c, metal.of_yield)
        stress = -modulus * (metal.expansion * warm + plastic)
        held = np.clip(stress, -most, most)
        plastic += (stress - held) / modulus
        pulls.append(-thickness_mm * float(((held + metal.modulus * metal.expansion * warm) * width).sum()))
    # What is warm still is so all over: only the plastic strain stays for ever.
    pulls[-1] = thickness_mm * metal.modulus * float((plastic * width).sum())
    kept = -plastic * width
    depth = float((kept * d_mm).sum() / kept.sum()) if kept.sum() > 0 else 0.0
    wide = float(edges[1:][plastic < -1e-6].max(initial=0.0))
    return Band(np.concatenate([[0.0], since]), np.minimum(np.array(pulls), 0.0), depth, wide)
