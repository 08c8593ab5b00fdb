"""DXF files, as CAD systems of thirty years write them, to a drawing."""

from __future__ import annotations

import logging
from pathlib import Path

from ezdxf import recover
from ezdxf.document import Drawing as Document
from ezdxf.entities.dxfgfx import DXFGraphic
from ezdxf.entities.insert import Insert
from ezdxf.filemanagement import readfile
from ezdxf.lldxf.const import DXFError

from kerfwise.encoder.contents import contents
from kerfwise.encoder.errors import REPAIR, InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Note
from kerfwise.encoder.still_going import so_much

from .copies import check_copies
from .drawing import Drawing, DrawnCurve
from .dxf_entities import curve, entities
from .foreign import FOREIGN_ERRORS
from .options import ReadOptions
from .units import DXF_UNITS, MM_PER
from .unread import Unread

DXF_ERRORS: tuple[type[Exception], ...] = (*FOREIGN_ERRORS, DXFError)

# its remarks on handles and such are nothing that a planner can act on; without a handler they go to the terminal
logging.getLogger("ezdxf").addHandler(logging.NullHandler())


def read_dxf(path: Path, data: bytes, options: ReadOptions) -> Drawing:
    """Every curve of the model space, in mm.

    Parameters
    ----------
    path, data
        The file and its bytes.
    options
        `units` overrides $INSUNITS; with `repair`, a file that breaks off is read as far as it goes.

    Raises
    ------
    InputError
        When the file is no DXF, breaks off, or an entity in it cannot be understood.
    """
    notes = _whole(data, options)
    document = document_of(path)
    units, unit_notes = _units(document, data, options)
    hidden = hidden_layers(document)
    pieces, unread = [], Unread()
    try:
        _check_blocks(document)
        so_much(len(document.modelspace()), "entity", "entities")
        for order, (entity, layer) in enumerate(entities(document.modelspace(), hidden, unread)):
            drawn = _curve(entity, layer, MM_PER[units])
            if drawn is None:
                unread.types[entity.dxftype(), layer] += 1
            else:
                pieces.append(DrawnCurve(drawn, layer, order))
    except DXF_ERRORS as error:
        raise InputError(f"an entity of this DXF file is damaged ({error}); save it again in CAD") from error
    return Drawing(tuple(pieces), units, (*notes, *unit_notes, *unread.notes(options.layers)))


def _curve(entity: DXFGraphic, layer: str, scale: float) -> Curve | None:
    """The entity as a curve; what is wrong with it is said with its type and layer."""
    where = f"a {entity.dxftype()} on layer '{layer}'"
    try:
        return curve(entity, scale)
    except InputError as error:
        raise InputError(f"{error.message} ({where})") from error.__cause__
    except DXF_ERRORS as error:
        raise InputError(f"{where} is damaged ({error}); save the file again in CAD") from error


def _whole(data: bytes, options: ReadOptions) -> tuple[Note, ...]:
    """A DXF file ends with EOF; one that does not has lost contours that nobody would miss until it is cut."""
    if data.startswith((b"AC10", b"AC1.")):
        raise InputError("this is a DWG file under another name; save it as DXF")
    if data.rstrip(b"\0\x1a \t\r\n").endswith(b"EOF"):
        return ()
    if not options.repair:
        raise InputError(f"the DXF file breaks off: its end mark EOF is missing; export it again, or try {REPAIR}")
    return (Note("repaired", "the DXF file breaks off before its end mark EOF: read as far as it goes"),)


def hidden_layers(document: Document) -> frozenset[str]:
    """The layers that are off or frozen, in lower case."""
    return frozenset(str(x.dxf.name).lower() for x in document.layers if x.is_off() or x.is_frozen())


def mm_per_unit(path: Path, document: Document, options: ReadOptions) -> float:
    """Millimetres in a unit of the drawing."""
    return MM_PER[_units(document, contents(path), options)[0]]


def document_of(path: Path) -> Document:
    """The file as its library reads it, rules of the format broken or not.

    Raises
    ------
    InputError
        If it is no DXF that can be read.
    """
    try:
        return readfile(path)
    except DXF_ERRORS:
        pass  # real files often break a rule or two of the format: recover reads most of those
    try:
        return recover.readfile(path)[0]
    except DXF_ERRORS as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(f"not a DXF file that can be read ({reason}); expected an ASCII or binary DXF") from error


def _check_blocks(document: Document) -> None:
    def made_of(name: str) -> tuple[int, list[tuple[str, int]]]:
        drawn = document.blocks.get(name) or ()
        inserts = [e for e in drawn if isinstance(e, Insert)]
        return len(drawn) - len(inserts), [(str(e.dxf.name), e.mcount) for e in inserts]

    check_copies(document.modelspace().block_record_name, made_of, "block")


def _units(document: Document, data: bytes, options: ReadOptions) -> tuple[str, tuple[Note, ...]]:
    if options.units is not None:
        return options.units, ()
    # ezdxf fills in a missing $INSUNITS with a value of its own
    code = document.header.get("$INSUNITS", 0) if b"$INSUNITS" in data else 0
    if code in DXF_UNITS or code == 0:
        return DXF_UNITS.get(code, "mm"), ()
    known = ", ".join(f"{k} {v}" for k, v in DXF_UNITS.items())
    other = "pass --units (in Python: units=)"
    text = f"$INSUNITS is {code}, which is no unit of a nest ({known}): read in mm; {other} if they are others"
    return "mm", (Note("warning", text),)
