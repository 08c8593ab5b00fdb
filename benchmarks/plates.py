"""What benchmarks of made plates have in common: the plate, the profile without some rules, and how a cost is told."""

from __future__ import annotations

import json
from dataclasses import replace

from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import EXEMPTION_MM


def made_plate(contours: int, seed: int) -> Nest:
    """A plate of about so many contours, by examples/gen_sheet.py, without the checks of a reader: it is sound."""
    return read_json(json.dumps(make_sheet(seed, contours)).encode(), ReadOptions())


def default_without(*rules: str) -> Profile:
    """The default profile with these rules off."""
    profile = load_profile()
    off = {name: replace(profile.rules[name], strength="off", weight=None) for name in rules}
    return replace(profile, rules={**profile.rules, **off})


def rest_mm(objective_mm: float) -> float:
    """What a plan costs without the weight of its excuses."""
    return objective_mm % EXEMPTION_MM


def cost(objective_mm: float) -> str:
    """In m, and how many excuses.

    Examples
    --------
    >>> cost(12_340.0), cost(2 * EXEMPTION_MM + 12_340.0)
    ('12.34', '12.34 + 2')
    """
    excuses = int(objective_mm // EXEMPTION_MM)
    return f"{rest_mm(objective_mm) / 1000:.2f}{f' + {excuses}' if excuses else ''}"
