"""What every time model answers: how long the machine moves along a torch-on path, and over an idle move."""

from __future__ import annotations

from typing import Protocol

from kerfwise.encoder.geometry.curve import Curve


class Motion(Protocol):
    """How a machine moves; paths begin and end at rest."""

    @property
    def words(self) -> str:
        """The model in a few words, as plans and programs state it."""
        ...

    def run_s(self, path: Curve, marks: bool, feed_share: float = 1.0) -> float:
        """Time along an open torch-on path, s, at a share of its feed."""
        ...

    def travel_s(self, length_mm: float) -> float:
        """Time of a straight idle move, s."""
        ...
