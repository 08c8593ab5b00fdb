"""gcode-toolpath of cncjs, from npm (MIT): modal motions, units, positions and arcs. It knows nothing of M words.

What moves at a feed is taken for a burn, what travels by G0 for none. `sh tests/tools/get_node_readers.sh .tools/node`
fetches it.
"""

from __future__ import annotations

import json
import math
import os
import shutil
import subprocess
from pathlib import Path

from kerfwise.tests.metal.arcs import chords, sweep_rad

from .heard import Heard

ROOT = Path(__file__).resolve().parents[3]
SCRIPT = Path(__file__).with_suffix(".js")


class MissingNodeReader(AssertionError):
    """gcode-toolpath, or Node.js, is not on this machine: a test that needs it fails, and says how to get it."""


def modules() -> Path:
    """The folder of what npm fetched: $NODE_READERS, else .tools/node."""
    folder = Path(os.environ.get("NODE_READERS", ROOT / ".tools/node")) / "node_modules"
    if shutil.which("node") is None or not (folder / "gcode-toolpath").is_dir():
        raise MissingNodeReader(
            "gcode-toolpath is missing: `sh tests/tools/get_node_readers.sh .tools/node` fetches it (needs Node.js)"
        )
    return folder


def read(text: str) -> Heard:
    """What gcode-toolpath makes of a program."""
    env = dict(os.environ, NODE_PATH=str(modules()))
    done = subprocess.run(
        ["node", str(SCRIPT)], input=text.encode(), env=env, capture_output=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr.decode()
    heard, burning = Heard(), False
    for motion, start, end, *centre in json.loads(done.stdout):
        if motion == "G0":
            heard.idle_mm += math.dist(start, end)
            burning = False
            continue
        if not burning:
            heard.burns.append([(start[0], start[1])])
            heard.lengths_mm.append(0.0)
            burning = True
        points, length_mm = [(end[0], end[1])], math.dist(start, end)
        if centre:
            turned = sweep_rad(start, centre[0], end, ccw=motion == "G3")
            points = chords(start, centre[0], turned, end).tolist()
            length_mm = math.dist(start, centre[0]) * abs(turned)
        heard.lengths_mm[-1] += length_mm
        heard.burns[-1] += [(x, y) for x, y in points]
    return heard
