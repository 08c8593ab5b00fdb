"""Heat in the sheet: simulated temperatures of a timed torch path, by two models, and what they mean."""

from .simulate import simulate
from .timed_path import HeatResult, PartHeat, TimedPath, TorchOn

__all__ = ["HeatResult", "PartHeat", "TimedPath", "TorchOn", "simulate"]
