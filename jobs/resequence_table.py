"""Minutes and seconds, as tables of jobs have them."""

from __future__ import annotations


def clock_text(seconds: float) -> str:
    """Minutes and seconds.

    Examples
    --------
    >>> clock_text(754.4)
    '12:34'
    """
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02d}"
