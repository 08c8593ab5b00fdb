"""A rule as a plant writes it in Python, with a place for something to go wrong in."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import kerfwise

ROOT = Path(kerfwise.__file__).resolve().parent
NEST = ROOT / "docs" / "own-rules.nest.json"
RULE = '''
from dataclasses import dataclass, field

from kerfwise.rule_kit import Number, OrderRule, option


@dataclass(frozen=True, slots=True)
class BarsLastOptions:
    ratio: float = field(default=4.0, metadata=option(Number(1), "how many times longer than wide a bar is"))


class BarsLast(OrderRule[BarsLastOptions]):
    """Bars are cut after the other parts."""

    id = "bars-last"
    sentence = "Bars are cut after the other parts."
    source = "plant practice"
    Options = BarsLastOptions

    def statements(self, facts, options):
        for i, a in enumerate(facts.nest.contours):
            for j, b in enumerate(facts.nest.contours):
                if a.kind == b.kind == "outer" and bar(b, options) and not bar(a, options):
                    yield self.precede(facts, i, j)

    def pairs(self, nest, cuts, options):
        outers = [part.outer for part in nest.parts]
        return [(a.id, b.id) for a in outers for b in outers if bar(b, options) and not bar(a, options)]

    def reason(self, before, after, start_side):
        return f"{after} is a bar"


def bar(contour, options):
    x0, y0, x1, y1 = contour.polygon.bounds
    return max(x1 - x0, y1 - y0) >= options.ratio * min(x1 - x0, y1 - y0)
'''


def rule_file(folder: Path, *instead: tuple[str, str], name: str = "bars.py") -> Path:
    """The rule in a file, with each first text replaced by the second."""
    text = RULE
    for old, new in instead:
        assert text.count(old) >= 1, old
        text = text.replace(old, new)
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def line_of(path: Path, text: str) -> int:
    """The line, from 1, in which a file has a text for the first time."""
    lines = path.read_text(encoding="utf-8").splitlines()
    return next(k for k, line in enumerate(lines, 1) if text in line)


def profile_file(folder: Path, text: str = "python: bars.py") -> Path:
    path = folder / "plant.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def package(folder: Path, name: str = "plant-rules", points: str = "bars = plant_rules:BarsLast") -> None:
    """What installing a package leaves behind: the metadata with its entry points."""
    made = folder / f"{name.replace('-', '_')}-1.0.dist-info"
    made.mkdir(parents=True)
    (made / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n", encoding="utf-8")
    (made / "entry_points.txt").write_text(f"[kerfwise.rules]\n{points}\n", encoding="utf-8")


def python(folder: Path, *words: str, at: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Another Python, which has the packages of a folder besides; it works in an empty folder, or `at` another."""
    (empty := folder / "empty").mkdir(exist_ok=True)
    paths = os.pathsep.join([str(ROOT.parent), str(folder)])
    env = os.environ | {"PYTHONPATH": paths, "PYTHONUTF8": "1", "XDG_CONFIG_HOME": str(folder)}
    return subprocess.run([sys.executable, *words], cwd=at or empty, env=env, capture_output=True, text=True)
