"""Which systems have a wheel of everything that kerfwise needs: `python -m kerfwise.benchmarks.wheels`.

pip is asked, by `pip download` without dependencies, and only for wheels: for each dependency in pyproject.toml, each
system and the Python that runs this. It is the index that pip is set to which answers. What comes goes to a folder that
is deleted. The result is a table for docs/systems.md; the exit code is 1 where a wheel is missing.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PLATFORMS = {
    "Windows (64-bit)": ("win_amd64",),
    "macOS (Apple silicon)": tuple(f"macosx_{v}_arm64" for v in ("11_0", "12_0", "13_0", "14_0")),
    "Linux (64-bit)": tuple(
        f"{name}_x86_64" for name in ("manylinux2014", "manylinux_2_17", "manylinux_2_27", "manylinux_2_28")
    ),
}
"""System → platform tags of pip that it takes."""


def dependencies(pyproject: Path = ROOT / "pyproject.toml") -> list[str]:
    """What kerfwise needs, as pyproject.toml has it."""
    project = tomllib.loads(pyproject.read_text(encoding="utf-8"))["project"]
    return [str(needed) for needed in project["dependencies"]]


def wheel_of(needed: str, platforms: Sequence[str]) -> str | None:
    """The version whose wheel pip takes for a system; None where there is none."""
    with tempfile.TemporaryDirectory(prefix="kerfwise-", ignore_cleanup_errors=True) as folder:
        command = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"]
        command += ["--only-binary=:all:", "--dest", folder, "--python-version", python_version()]
        command += [word for platform in platforms for word in ("--platform", platform)]
        done = subprocess.run([*command, needed], capture_output=True, encoding="utf-8", errors="replace", check=False)
        wheels = sorted(Path(folder).glob("*.whl"))
        if done.returncode == 0 and wheels:
            return wheels[0].name.split("-")[1]
        if "No matching distribution" not in done.stderr:
            raise RuntimeError(done.stderr.strip().splitlines()[-1] if done.stderr.strip() else "pip said nothing")
        return None


def python_version() -> str:
    """The Python that runs this, such as 3.11."""
    return ".".join(map(str, sys.version_info[:2]))


def table(found: dict[str, list[str | None]]) -> str:
    """Requirement → version for each system, as a table in Markdown."""
    lines = [f"| Python {python_version()} | {' | '.join(PLATFORMS)} |", "|---" * (len(PLATFORMS) + 1) + "|"]
    lines += [f"| `{needed}` | {' | '.join(v or '**none**' for v in versions)} |" for needed, versions in found.items()]
    return "\n".join(lines)


def main() -> int:
    """Ask, and print the table."""
    found = {needed: [wheel_of(needed, tags) for tags in PLATFORMS.values()] for needed in dependencies()}
    print(table(found))
    return int(any(version is None for versions in found.values() for version in versions))


if __name__ == "__main__":
    sys.exit(main())
