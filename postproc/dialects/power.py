"""The S words of a laser: a profile's, or its chart's, powers as the control spells them."""

from __future__ import annotations

from collections.abc import Mapping

from kerfwise.rules.profile.profile import Profile

from .dialect import Dialect
from .kinds import Powers

_NONE = Powers(0, 0, 0, 0)


def powers_of(dialect: Dialect, profile: Profile | None = None) -> Mapping[str, int]:
    """S words by the names that stand for them in a dialect's blocks; where the profile says none, the dialect's own.

    Examples
    --------
    >>> from .load import load_dialect
    >>> powers_of(load_dialect("grbl"))
    {'power': 1000, 'pierce_power': 1000, 'mark_power': 200}
    """
    own = dialect.powers or _NONE
    cut, pierce, mark = own.cut, own.pierce, own.mark
    if profile is not None:
        material = profile.material
        said = material.power if material.pierce_power is None else material.pierce_power
        cut, pierce, mark = (
            otherwise if share is None else round(own.full * share / 100)
            for share, otherwise in ((material.power, cut), (said, pierce), (material.mark_power, mark))
        )
    return {"power": cut, "pierce_power": pierce, "mark_power": mark}
