"""The remnant that a program saves, as a sheet to nest parts on: JSON and DXF, its lower left corner at the origin."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from pathlib import Path

from kerfwise.encoder.nest import Nest
from kerfwise.encoder.scrap import remnant_of
from kerfwise.rules.profile.profile import Profile

LAYER = "SHEET"


def remnant_names(program: str | Path, profile: Profile) -> tuple[Path, ...]:
    """The files that stand beside a program which saves a remnant; none where the profile asks for none.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from kerfwise.rules.profile.cuts_section import Cuts, Scrap
    >>> from kerfwise.rules.profile.load import load_profile
    >>> plant = replace(load_profile(), cuts=Cuts(scrap=Scrap(remnant="right")))
    >>> [str(name) for name in remnant_names("out.nc", plant)], remnant_names("out.nc", load_profile())
    (['out.remnant.json', 'out.remnant.dxf'], ())
    """
    if profile.cuts.scrap.remnant is None:
        return ()
    file = Path(program)
    return file.with_name(f"{file.stem}.remnant.json"), file.with_name(f"{file.stem}.remnant.dxf")


def remnant_files(program: str | Path, nest: Nest, profile: Profile) -> Mapping[Path, str]:
    """The remnant of a nest in each of these files; none where the profile asks for none.

    Raises
    ------
    InputError
        If nothing is left to save.
    """
    names, side = remnant_names(program, profile), profile.cuts.scrap.remnant
    if side is None:
        return {}
    width, height = (round(mm, 3) for mm in remnant_of(nest, profile.material.kerf_mm, side).size_mm)
    return dict(zip(names, (_json(width, height), _dxf(width, height)), strict=True))


def _json(width_mm: float, height_mm: float) -> str:
    sheet = {"width": width_mm, "height": height_mm}
    return json.dumps({"format": "kerfwise-nest/1", "units": "mm", "sheet": sheet, "parts": []}) + "\n"


def _dxf(width_mm: float, height_mm: float) -> str:
    from ezdxf.addons.r12writer import r12writer  # loaded by those who ask for a drawing only

    text = io.StringIO(newline="")
    with r12writer(text) as drawing:
        corners = [(0.0, 0.0), (width_mm, 0.0), (width_mm, height_mm), (0.0, height_mm)]
        drawing.add_polyline_2d(corners, closed=True, layer=LAYER)
    return text.getvalue()
