"""The MiniZinc that is installed on this machine, and its solvers."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.suggest import unknown

if TYPE_CHECKING:
    from minizinc import Driver, Solver

HOW_TO_INSTALL = (
    "MiniZinc 2.6 or later is not installed: `apt-get install minizinc` on Debian and Ubuntu, else see "
    "https://www.minizinc.org/software.html, and make sure that `minizinc` is on the PATH"
)


@dataclass(frozen=True, slots=True)
class InstalledSolver:
    """A solver that MiniZinc can use: the name to ask for it by, what it calls itself, its version."""

    name: str
    title: str
    version: str


def driver() -> Driver:
    """The installed MiniZinc.

    Raises
    ------
    InputError
        If there is none, or an older one than 2.6; the message says how to install it.
    """
    with warnings.catch_warnings():  # without a program the package warns when imported; the error here says more
        warnings.simplefilter("ignore")
        import minizinc
    if minizinc.default_driver is None:
        raise InputError(HOW_TO_INSTALL)
    return minizinc.default_driver


def solver_named(name: str) -> Solver:
    """The solver of that name (`gecode`), full id (`org.gecode.gecode`) or tag (`mip`).

    Raises
    ------
    InputError
        If MiniZinc has no such solver, or knows it but not where it is.
    """
    ready = _ready()
    if name not in ready:
        raise InputError(f"MiniZinc here: {unknown('solver', name, {s.name for s in installed_solvers()})}")
    return ready[name]


def installed_solvers() -> tuple[InstalledSolver, ...]:
    """The solvers that can be used, by name.

    Raises
    ------
    InputError
        If MiniZinc is not installed.
    """
    found = {s.id: InstalledSolver(_short(s), s.name, s.version) for s in _ready().values()}
    return tuple(sorted(found.values(), key=lambda s: s.name))


def _ready() -> dict[str, Solver]:
    """Name, id or tag → solver; without those that only open a window, and those whose library is missing."""
    ready: dict[str, Solver] = {}
    for name, solvers in driver().available_solvers().items():
        usable = [s for s in solvers if not s.isGUIApplication and s.version != "<unknown version>"]
        if usable:
            ready[name] = usable[0]
    return ready


def _short(solver: Solver) -> str:
    return str(solver.id).rpartition(".")[2]
