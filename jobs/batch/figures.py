"""Figures as a planner reads them."""

from __future__ import annotations

NONE = "–"
"""Stands where there is no figure."""


def clock(seconds: float) -> str:
    """Hours, minutes and seconds.

    Examples
    --------
    >>> clock(75.2), clock(3675.0)
    ('1:15', '1:01:15')
    """
    minutes, left = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{left:02d}" if hours else f"{minutes}:{left:02d}"


def money(amount: float | None, currency: str) -> str:
    """An amount with its currency."""
    return NONE if amount is None else f"{amount:.2f} {currency}"


def metres(mm: float) -> str:
    """A length."""
    return f"{mm / 1000:.2f} m"


def percent(share: float | None) -> str:
    """A share; what is 0 is exactly that.

    Examples
    --------
    >>> percent(0.0), percent(0.0123)
    ('0 %', '1.23 %')
    """
    return NONE if share is None else "0 %" if share == 0 else f"{100 * share:.2f} %"
