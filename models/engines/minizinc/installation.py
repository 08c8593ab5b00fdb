"""The MiniZinc that is installed on this machine, and its solvers."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kerfwise.encoder.errors import InputError
from kerfwise.rules.minizinc.trial import HOW_TO_INSTALL, expect_solving, expect_usable, found_program, unusable
from kerfwise.rules.options.suggest import unknown

if TYPE_CHECKING:
    from minizinc import Driver, Solver


@dataclass(frozen=True, slots=True)
class InstalledSolver:
    """A solver that MiniZinc can use: the name to ask for it by, what it calls itself, its version."""

    name: str
    title: str
    version: str


def driver() -> Driver:
    """The installed MiniZinc.

    It is asked before the package that drives it is imported, which would wait for its version for ever.

    Raises
    ------
    InputError
        If there is none, an older one than 2.6, or one that does not answer as MiniZinc does; the message says how to
        install it.
    """
    if program := found_program():
        expect_usable(program)
    with warnings.catch_warnings():  # without a program the package warns when imported; the error here says more
        warnings.simplefilter("ignore")
        try:
            import minizinc
        except Exception as error:  # the program has changed meanwhile, or one of another place is broken
            raise unusable(program or "minizinc", f"it fails ({type(error).__name__}: {error})") from None
    if minizinc.default_driver is None:
        raise InputError(HOW_TO_INSTALL)
    return minizinc.default_driver


def solver_named(name: str) -> Solver:
    """The solver of that name (`gecode`), full id (`org.gecode.gecode`) or tag (`mip`).

    Raises
    ------
    InputError
        If MiniZinc has no such solver, knows it but not where it is, or it does not solve the smallest of models.
    """
    ready = _ready()
    if name not in ready:
        raise InputError(f"MiniZinc here: {unknown('solver', name, {s.name for s in installed_solvers()})}")
    chosen = ready[name]
    expect_solving(str(driver().executable), str(chosen.id))
    return chosen


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
    here = driver()
    try:
        known = here.available_solvers()
    except Exception as error:  # the program has changed since it was asked
        raise unusable(
            str(here.executable), f"it does not list its solvers ({type(error).__name__}: {error})"
        ) from None
    for name, solvers in known.items():
        usable = [s for s in solvers if not s.isGUIApplication and s.version != "<unknown version>"]
        if usable:
            ready[name] = usable[0]
    if not ready:
        raise unusable(str(here.executable), "none of its solvers can be used")
    return ready


def _short(solver: Solver) -> str:
    return str(solver.id).rpartition(".")[2]
