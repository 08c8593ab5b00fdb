"""kerfwise: a declarative, constraint-programming sequencer for thermal sheet cutting."""

__version__ = "0.1.0"
__all__ = ["__version__"]
