"""Run QtPlasmaC's own program filter (`qtplasmac_gcode`, part of LinuxCNC) on a program, without its screen.

Every program that is loaded on such a machine goes through the filter, which complains of what it does not like. Here
its GUI and the machine behind it are stand-ins; the code that judges is untouched. It comes with rs274:
`sh tests/tools/get_rs274.sh .tools/rs274`.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from . import canon

_LINUXCNC = """
class ini:
    def __init__(self, file):
        self.values, section = {}, ""
        for line in open(file):
            line = line.strip()
            if line.startswith("["): section = line[1:-1]
            elif "=" in line: key, value = line.split("=", 1); self.values[section, key.strip()] = value.strip()
    def find(self, section, key): return self.values.get((section, key))
class command:
    def __getattr__(self, name): return lambda *words: None
"""
_QT = """
import json, os
class Any:
    texts = []
    def __init__(self, *a, **k): pass
    def __getattr__(self, name):
        if name == "__spec__": raise AttributeError
        return Any()
    def __call__(self, *a, **k): return Any()
    def setText(self, text): Any.texts.append(text); json.dump(Any.texts, open(os.environ["QTP_TEXTS"], "w"))
    def exec(self): return 0
class _Meta(type):
    def __getattr__(cls, name): return Any()
def make(name): return _Meta(name, (Any,), {})
"""
_WIDGETS = [
    "QApplication",
    "QDialog",
    "QScrollArea",
    "QWidget",
    "QVBoxLayout",
    "QLabel",
    "QPushButton",
    "QStyle",
    "QFrame",
]
# every machine pin reads as a number
_HALCMD = """#!/bin/sh
[ "$1" = setp ] && exit 0
case "$2" in plasmac.max-offset) echo 5.0;; *color*) echo 16772608;; *) echo 0;; esac
"""


def find_filter() -> str:
    """The filter that came with rs274, else the one on the PATH."""
    with_rs274 = Path(canon.find_rs274()).parents[1] / "root/usr/bin/qtplasmac_gcode"
    found = str(with_rs274) if with_rs274.exists() else shutil.which("qtplasmac_gcode")
    if found is None:
        raise canon.MissingInterpreter("qtplasmac_gcode is missing: sh tests/tools/get_rs274.sh .tools/rs274")
    return found


def complaints(program: str, feed_mm_min: float, kerf_mm: float) -> list[str]:
    """What the filter says to a program cut at this feed and kerf: errors and warnings, a line each."""
    with tempfile.TemporaryDirectory(prefix="qtplasmac-") as name:
        folder, stand_ins = Path(name), Path(name, "stand-ins")
        (stand_ins / "PyQt5").mkdir(parents=True)
        (stand_ins / "linuxcnc.py").write_text(_LINUXCNC)
        (stand_ins / "PyQt5/__init__.py").write_text(_QT)
        for module, names in (("QtCore", ["Qt"]), ("QtGui", ["QIcon"]), ("QtWidgets", _WIDGETS)):
            lines = ["from . import make", *(f"{n} = make({n!r})" for n in names), ""]
            (stand_ins / f"PyQt5/{module}.py").write_text("\n".join(lines))
        (stand_ins / "halcmd").write_text(_HALCMD)
        (stand_ins / "halcmd").chmod(0o755)
        (folder / "m.ini").write_text(
            "[DISPLAY]\nDISPLAY = qtvcp qtplasmac\n[EMC]\nMACHINE = m\n[TRAJ]\nLINEAR_UNITS = mm\n"
            "[AXIS_Z]\nMAX_LIMIT = 100\n"
        )
        (folder / "m.prefs").write_text(f"Cut feed rate = {feed_mm_min}\nKerf width = {kerf_mm}\n")
        (folder / "m_material.cfg").write_text("")
        (folder / "in.ngc").write_text(program)
        Path("/tmp/qtplasmac").mkdir(exist_ok=True)  # the filter writes there, wherever it runs
        env = os.environ | {
            "PYTHONPATH": str(stand_ins),
            "PATH": f"{stand_ins}:{os.environ['PATH']}",
            "INI_FILE_NAME": str(folder / "m.ini"),
            "QTP_TEXTS": str(folder / "texts.json"),
        }
        done = subprocess.run(
            [sys.executable, find_filter(), str(folder / "in.ngc")],
            cwd=folder, env=env, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60, check=False,
        )  # fmt: skip
        texts = folder / "texts.json"
        said = json.loads(texts.read_text()) if texts.exists() else []
        lines = [line for text in said for line in text.splitlines()]
        return lines if done.returncode == 0 else [*lines, done.stderr]
