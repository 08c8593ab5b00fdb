"""Burns of a block of torches, for the check: what each torch burns, as it is set by hand before the program."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.postproc.check.reader.program import Burn, NcProgram
from kerfwise.rules.profile.values import ProfileValues

from .jets import jet_of

_NUMBER = r"-?\d+(?:\.\d+)?"
_SET = re.compile(rf"BLOCK TORCH (\d) [A-Z ]*?TILT ({_NUMBER}) LEFT ({_NUMBER}) OUT ({_NUMBER})")
Setting = tuple[float, float, float]
"""How a torch leans, how far it stands on the left of the upright one as one looks along C, and how far out."""
Found = tuple[tuple[str, ...], str]


def settings_of(program: NcProgram, found: list[Found]) -> dict[int, Setting]:
    """How each torch of the block is set by what the program says; two settings of one torch are told."""
    settings: dict[int, Setting] = {}
    for match in filter(None, map(_SET.fullmatch, program.comments)):
        torch, told = int(match[1]), (float(match[2]), float(match[3]), float(match[4]))
        if settings.setdefault(torch, told) != told:
            found.append(((), f"torch {torch} of the block is set by hand, and the program wants it in two ways"))
    return settings


def torch_burns(program: NcProgram, profile: ProfileValues, found: list[Found]) -> Iterator[tuple[Burn, Burn | None]]:
    """What each torch burns, as a burn of its own that leans; with that of the block where it burns with others.

    A burn of the upright torch alone, that does not turn, is a plain burn.
    """
    settings = settings_of(program, found)
    for burn in program.burns:
        if burn.tool != 0:
            yield burn, None
            continue
        plain = replace(burn, torches=(), axes=())
        if len({turn for _, turn in burn.axes}) < 2 and burn.torches == (2,):
            yield plain, None
            continue
        if not burn.torches:
            found.append(((), f"line {burn.line}: no torch of the block is selected"))
        jet = jet_of(burn, profile)
        turn = np.unwrap(np.radians(jet.turns_deg))
        out, left = np.column_stack([np.cos(turn), np.sin(turn)]), np.column_stack([-np.sin(turn), np.cos(turn)])
        for torch in burn.torches:
            if torch not in settings:
                found.append(((), f"line {burn.line}: nobody says how torch {torch} of the block is set"))
                continue
            tilt, left_mm, out_mm = settings[torch]
            at = jet.at + left_mm * left + out_mm * out
            keep = np.append(True, np.hypot(*np.diff(at, axis=0).T) > 1e-9)
            path = Curve(np.column_stack([at[keep], np.zeros(int(keep.sum()))]), closed=False)
            axes = tuple((tilt, math.degrees(angle)) for angle in turn[keep].tolist())
            feeds = (max(burn.feeds_mm_s),) * len(path.segments)
            yield replace(plain, path=path, axes=axes, step_feeds_mm_s=feeds, torch=torch), burn
