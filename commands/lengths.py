"""Lengths and sizes on the command line, and what they say of how a nest is read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kerfwise.encoder.errors import InputError

if TYPE_CHECKING:
    from kerfwise.encoder.readers.options import FrameName
    from kerfwise.rules.options.quantities import Quantity


def said_of_reading(
    units: str | None, sheet: str | None, frame: FrameName | None, repair: bool, refit_arcs: str | None
) -> dict[str, Any]:
    """What `drawn_nest` takes of these options."""
    size_mm = size_of(sheet) if sheet else None
    refit_mm = length_of("--refit-arcs", refit_arcs) if refit_arcs else None
    return {"units": units, "sheet_mm": size_mm, "frame": frame, "repair": repair, "refit_arcs_mm": refit_mm}


def length_of(option: str, text: str) -> float:
    """A length over 0 in mm, as in 0.05 mm; InputError with the option's name for anything else."""
    from kerfwise.rules.options.quantities import LENGTH, over_zero

    return _read(option, text, over_zero(LENGTH))


def length_or_zero(option: str, text: str) -> float:
    """The same, where 0 is a length too."""
    from kerfwise.rules.options.quantities import LENGTH

    return _read(option, text, LENGTH)


def _read(option: str, text: str, kind: Quantity) -> float:
    from kerfwise.rules.options.kind import Unfit
    from kerfwise.rules.options.yaml_positions import compose

    try:
        node = compose(text, option)
        if node is None:
            raise Unfit(f"expected {kind.expected()}")
        return float(kind.read(node))
    except Unfit as error:
        raise InputError(f"{option} {text!r}: {error}") from None
    except InputError:
        raise InputError(f"{option} {text!r}: expected {kind.expected()}") from None


def size_of(text: str) -> tuple[float, float]:
    """Width and height of a sheet, mm, as in 3000x1500; InputError for anything else."""
    width, _, height = text.lower().partition("x")
    try:
        size = float(width), float(height)
    except ValueError:
        size = (0.0, 0.0)
    if not (0 < size[0] < 1e6 and 0 < size[1] < 1e6):
        raise InputError(f"--sheet {text!r} is not a size: write width x height in mm, such as 3000x1500")
    return size
