"""Both routes in one picture, the cuts that differ in red."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

import numpy as np

from kerfwise.encoder.shown import shown
from kerfwise.postproc.report.burns import Panel, burns_scene, draw_burns
from kerfwise.postproc.report.scene import Scene

from .comparison import Compared
from .side import Side

_SAME_S = 1e-3
"""Plans write times to milliseconds."""


def picture(made: Compared, suffix: str) -> str | bytes:
    """The picture as SVG text or as PNG bytes."""
    return draw_burns(_panels(made), suffix, title_of(made))


def picture_scene(made: Compared) -> Scene:
    """The picture, to be set on a page."""
    return burns_scene(_panels(made), title_of(made))


def title_of(made: Compared) -> str:
    """What a picture or page of the comparison is called."""
    return f"{shown(Path(made.a.given.nest.file or 'nest').name)} compared"


def _panels(made: Compared) -> list[Panel]:
    changed = {pair.contour for pair in made.changed}
    return [_panel(letter, side, changed) for letter, side in (("A", made.a), ("B", made.b))]


def _panel(letter: str, side: Side, changed: Collection[str]) -> Panel:
    job = side.times.timed.job
    told = f"idle {job.idle_mm / 1000:.3f} m, {job.pierces} pierces"
    begun_s = np.array(sorted(cut.start_s for cut in side.cuts.new if cut.contour in changed))
    starts_s = np.array([burn.start_s for burn in side.burns])
    loud = frozenset((np.searchsorted(starts_s, begun_s + _SAME_S) - 1).tolist())
    return Panel(f"{letter}: {side.name}", told, side.burns, side.home, side.end, loud, side.cuts.made + 1)
