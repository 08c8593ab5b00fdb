"""Heat in the sheet: simulated temperatures of a timed torch path, by two models, and what they mean."""

from .grid import HeatResult, PartHeat
from .simulate import simulate
from .timed_path import TimedPath, TorchOn

__all__ = ["HeatResult", "PartHeat", "TimedPath", "TorchOn", "simulate"]
