"""The colours of the pictures: soft tints for zones, a perceptual scale for time, one dark ink each for the rest."""

from __future__ import annotations

SHEET = "#eceef0"
PAGE = "#ffffff"
INK = "#212529"
NAME = "#495057"
FAINT = "#868e96"
OUTER = "#343a40"
HOLE = "#9c3612"
MARK = "#1971c2"
SLIT = "#087f5b"
SCRAP = "#7048e8"
TAB = "#2b8a3e"
PIERCE = "#d6001c"
FURTHER = "#0b7285"
ALERT = "#e03131"
WAIT = "#7b2cbf"
START = "#f08c00"
PART = "#c5d7e6"

_ZONES = ("#b3d1ea", "#f8d9a8", "#bfe0b4", "#dcc6e8", "#f3b9b0", "#f1e79f", "#aadfd6", "#d9c9b1")
# viridis (matplotlib) from 0 to 0.85 in even steps: its yellow end cannot be read on a light ground.
_TIME = ("#440154", "#472c7a", "#3b518b", "#2c718e", "#21908d", "#27ad81", "#5cc863", "#97d83f")


def zone_tint(colour: int) -> str:
    """The tint of a zone's colour number, which may be any natural number."""
    return _ZONES[colour % len(_ZONES)]


def zone_tints() -> int:
    """How many tints there are before they repeat."""
    return len(_ZONES)


def shade(colour: str, share: float) -> str:
    """The colour mixed with black; 0 leaves it, 1 is black.

    Examples
    --------
    >>> shade("#ff8000", 0.5)
    '#804000'
    """
    return mix(colour, "#000000", share)


def mix(first: str, second: str, share: float) -> str:
    """`share` of the second colour in the first, both `#rrggbb`."""
    a, b = (tuple(int(c[k : k + 2], 16) for k in (1, 3, 5)) for c in (first, second))
    return "#" + "".join(f"{round(x + (y - x) * share):02x}" for x, y in zip(a, b, strict=True))


def time_colour(share: float) -> str:
    """The colour of a moment, 0 the start of the program and 1 its end.

    Examples
    --------
    >>> time_colour(0.0), time_colour(1.0)
    ('#440154', '#97d83f')
    """
    place = min(max(share, 0.0), 1.0) * (len(_TIME) - 1)
    k = min(int(place), len(_TIME) - 2)
    return mix(_TIME[k], _TIME[k + 1], place - k)
