"""What a control makes of a program: LinuxCNC's interpreter, for QtPlasmaC behind its own filter.

The filter (`qtplasmac_gcode`) runs in this process, its screen and its machine being stand-ins; the code that rewrites
the program is untouched.
"""

from __future__ import annotations

import contextlib
import io
import os
import subprocess
import sys
import tempfile
from functools import cache, partial
from pathlib import Path
from types import CodeType, ModuleType, SimpleNamespace
from typing import Any
from unittest import mock

from kerfwise.tests.tools import canon
from kerfwise.tests.tools.qtplasmac import find_filter

CHORD_MM = 0.0003
_PINS = {"plasmac.max-offset": b"5.0", "qtplasmac.color_fg": b"16772608", "qtplasmac.color_bg": b"328965"}


def run(program: bytes, control: str) -> canon.Run:
    """What the machine would do; a program that the filter does not let through is refused."""
    if control != "linuxcnc-qtplasmac":
        return canon.run(program, CHORD_MM)
    passed, complaint = filtered(program)
    return canon.run(passed, CHORD_MM) if complaint is None else canon.Run(error=complaint)


def filtered(program: bytes) -> tuple[bytes, str | None]:
    """The program as QtPlasmaC's filter passes it on, and why it does not, if so."""
    judging = _code()
    with tempfile.TemporaryDirectory(prefix="filter-") as name:
        folder = Path(name)
        (folder / "in.ngc").write_bytes(program)
        (folder / "m.prefs").write_text("Cut feed rate = 600\nKerf width = 1.5\n")
        (folder / "m_material.cfg").write_text("")
        Path("/tmp/qtplasmac").mkdir(exist_ok=True)  # the filter writes there, wherever it runs
        names: dict[str, Any] = {"__name__": "filter", "open": partial(open, encoding="utf-8")}
        argv, environ = ["qtplasmac_gcode", str(folder / "in.ngc")], {"INI_FILE_NAME": "m.ini"}
        with (
            mock.patch.dict(sys.modules, _stand_ins(folder)),
            mock.patch.dict(os.environ, environ),
            mock.patch.object(sys, "argv", argv),
            mock.patch.object(subprocess, "run", _halcmd),
            contextlib.redirect_stdout(io.StringIO()),
        ):
            try:
                exec(judging, names)
            except (Exception, SystemExit) as error:
                return b"", f"the filter ends with {type(error).__name__}: {error}"
    if names["codeError"]:
        return b"", f"the filter finds errors, lines {names['errorLines']}"
    return "\n".join([*names["gcodeList"], ""]).encode(), None


@cache
def _code() -> CodeType:
    file = find_filter()
    return compile(Path(file).read_text(encoding="utf-8"), file, "exec")


def _halcmd(words: list[str], **_: object) -> SimpleNamespace:
    """Every pin of the machine reads as a number."""
    return SimpleNamespace(stdout=_PINS.get(words[2], b"0"))


def _stand_ins(folder: Path) -> dict[str, ModuleType]:
    values = {"MACHINE": str(folder / "m"), "DISPLAY": "qtplasmac", "LINEAR_UNITS": "mm"}
    linuxcnc, qt = ModuleType("linuxcnc"), ModuleType("PyQt5")
    linuxcnc.ini = lambda _: SimpleNamespace(find=lambda _, key: values.get(key))  # type: ignore[attr-defined]
    linuxcnc.command = mock.MagicMock  # type: ignore[attr-defined]
    modules = {"linuxcnc": linuxcnc, "PyQt5": qt}
    for name in ("QtCore", "QtGui", "QtWidgets"):
        modules[f"PyQt5.{name}"] = mock.MagicMock()
    return modules
