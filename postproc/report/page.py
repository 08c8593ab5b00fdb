"""A scene as a page that plays the cuts in order, in one file that needs nothing else."""

from __future__ import annotations

import json
from html import escape
from importlib.resources import files

from kerfwise.models.plan.plan import Plan

from .scene import Scene
from .svg import svg_text


def html_text(scene: Scene, plan: Plan | None) -> str:
    """The page: the drawing, and with a plan a slider, a play button and the story of the current cut."""
    page = files(__package__).joinpath("player.html").read_text(encoding="utf-8")
    # A "<" would let a contour's name end the script; JSON may write it as an escape instead.
    cuts = json.dumps(_rows(plan), ensure_ascii=False, separators=(",", ":")).replace("<", "\\u003c")
    made = str(plan.resumed_after if plan else 0)
    words = (("@title", escape(scene.title)), ("@made", made), ("@cuts", cuts), ("@drawing", svg_text(scene)))
    for key, value in words:
        page = page.replace(key, value, 1)
    return page


def _rows(plan: Plan | None) -> list[dict[str, object]]:
    if plan is None:
        return []
    return [
        {
            "contour": p.cut.contour,
            "kind": p.kind,
            "zone": p.cut.zone,
            "direction": p.cut.direction,
            "length_mm": round(p.length_mm, 1),
            "start_s": round(p.cut.start_s, 1),
            "end_s": round(p.cut.end_s, 1),
            "dwell_s": round(p.dwell_s, 1),
            "because": list(p.because),
        }
        for p in plan.cuts
    ]
