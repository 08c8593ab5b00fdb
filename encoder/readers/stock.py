"""A sheet alone, to lay parts on: a remnant as `solve` writes it, or a drawing of one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest, Sheet
from kerfwise.encoder.validate.rings import sheet_ring_problems

from .drawing import Drawing
from .join import join
from .json_nest import sheet_in_json
from .layers import Layers
from .options import ReadOptions
from .read import SUFFIXES, file_bytes
from .sheet import NO_SHEET, drawn_sheet


def read_sheet(path: str | Path, options: ReadOptions = ReadOptions()) -> Sheet:  # noqa: B008 - frozen
    """The sheet in a file: JSON (kerfwise-nest/1 without parts), DXF or SVG.

    Of a drawing it is the closed line on the sheet's layer, or the outer one of all closed lines; those in it are its
    holes.

    Raises
    ------
    InputError
        If the file cannot be read, holds parts, or holds no sheet.
    """
    file = Path(path)
    suffix = file.suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError(f"cannot tell the format of '{file.name}': expected {', '.join(SUFFIXES)}", file=file)
    data = file_bytes(file)
    try:
        if suffix == ".json":
            sheet = sheet_in_json(data, options)
        elif suffix == ".dxf":
            from .dxf import read_dxf

            sheet = _drawn(read_dxf(file, data, options), options)
        else:
            from .svg import read_svg

            sheet = _drawn(read_svg(data, options), options)
        if problems := sheet_ring_problems(sheet):
            raise InputError("the sheet cannot be used", details=tuple(problems))
    except InputError as error:
        raise InputError(
            error.message, file=file, line=error.line, column=error.column, details=error.details
        ) from error.__cause__
    return sheet


def _drawn(drawing: Drawing, options: ReadOptions) -> Sheet:
    layers: Layers = options.layers
    on_layer = [piece for piece in drawing.pieces if layers.use(piece.names).purpose == "sheet"]
    joined = join(tuple(on_layer or drawing.pieces), options.join_tolerance_mm)
    if not joined.rings:
        raise InputError("holds no closed line that could be a sheet")
    return drawn_sheet(joined.rings)


def without_place(nest: Nest) -> Nest:
    """A nest whose sheet does not matter, without the notes on where it was laid."""
    return replace(nest, notes=tuple(note for note in nest.notes if not note.text.startswith(NO_SHEET)))
