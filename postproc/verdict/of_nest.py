"""Whether a program is one of the nest that it is given with: times and temperatures of another's mean nothing."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import shapely

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.check.reader.program import Burn, NcProgram
from kerfwise.postproc.nc.plan_paths import SHA_DIGITS

_MADE_FROM = re.compile(rf"NEST (?P<file>.*?) ?SHA256 (?P<sha>[0-9a-f]{{{SHA_DIGITS}}})", re.IGNORECASE)
_SAMPLES = 16
_BESIDE_MM = 3.0
"""How far beside a contour a path may run that cuts it, besides the kerf."""


def cuts_elsewhere(program: NcProgram, nest: Nest, kerf_mm: float, file: str = "") -> int:
    """How many cuts of a program run along no contour of the nest; holes that are only pierced are no cuts.

    Raises
    ------
    InputError
        If most do, or the program says itself that it was made from another nest.
    """
    for found in filter(None, map(_MADE_FROM.fullmatch, program.comments)):
        sha = found["sha"].lower()
        if nest.sha256 and sha != nest.sha256[:SHA_DIGITS]:
            raise InputError(
                f"the program was made from another nest: it names {found['file'] or 'one'} with sha256 {sha}, that "
                f"of {nest.file} begins {nest.sha256[:SHA_DIGITS]}; give the nest it was made from",
                file=file or None,
            )
    if not nest.contours:
        return len(program.burns)
    if not program.burns:
        raise InputError("the program cuts nothing: the torch is never on", file=file or None)
    burns = [burn for burn in program.burns if not burn.pierces_only] or program.burns
    along = along_contours(burns, nest, kerf_mm)
    count, of_it = len(along), int(along.sum())
    if of_it < count / 2:
        share = f"only {of_it}" if of_it else "none"
        raise InputError(
            f"{share} of the {count} cuts of the program run along contours of {nest.file or 'the nest'}: is it the "
            "nest of this program?",
            file=file or None,
        )
    return count - of_it


def along_contours(burns: Sequence[Burn], nest: Nest, kerf_mm: float) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Of each burn, whether at least half of it runs beside contours of the nest."""
    paths = [burn.path.flatten(_BESIDE_MM / 10) for burn in burns]
    lines = [shapely.LineString(path if len(path) > 1 else np.repeat(path, 2, axis=0)) for path in paths]
    shares = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    points = shapely.line_interpolate_point(np.repeat(lines, _SAMPLES), np.tile(shares, len(lines)), normalized=True)
    tree = shapely.STRtree([contour.line for contour in nest.contours])
    near, _ = tree.query(points, predicate="dwithin", distance=kerf_mm + _BESIDE_MM)
    beside = np.zeros(len(points), dtype=np.bool_)
    beside[near] = True
    return np.asarray(beside.reshape(-1, _SAMPLES).mean(axis=1) >= 0.5)
