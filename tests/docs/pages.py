"""Pages in Markdown: their links, their headings, and the files that they name."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

LINK = re.compile(r"\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#{1,6} +(.+?) *#*$", re.MULTILINE)
FENCE = re.compile(r"^(```|~~~).*?^\1", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"`[^`\n]*`")
FOLDERS = "benchmarks|commands|distortion|docs|encoder|examples|jobs|models|postproc|rules|tests"
NAMED = re.compile(rf"(?<![\w./-])(?:{FOLDERS})/[\w./-]*\w(?![\w<*{{…-])")
"""A path of the repository, in running text or in a command."""


@dataclass(frozen=True)
class Page:
    """A page of the repository at `root`."""

    root: Path
    path: Path

    @property
    def text(self) -> str:
        return self.path.read_text(encoding="utf-8")

    @property
    def prose(self) -> str:
        """The text without blocks and spans of code."""
        return CODE.sub("", FENCE.sub("", self.text))

    def links(self) -> Iterator[tuple[Path, str]]:
        """The file and the anchor ("" for none) of each link that stays in the repository."""
        for target in LINK.findall(self.prose):
            if "://" not in target and not target.startswith("mailto:"):
                name, _, anchor = target.partition("#")
                yield (self.path.parent / name).resolve() if name else self.path, anchor

    def anchors(self) -> set[str]:
        """The anchors of the headings, as forges make them."""
        found: set[str] = set()
        for heading in HEADING.findall(FENCE.sub("", self.text)):
            name = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
            name = re.sub(r"[^\w\- ]", "", name.lower()).replace(" ", "-")
            again = sum(f == name or re.fullmatch(rf"{re.escape(name)}-\d+", f) is not None for f in found)
            found.add(f"{name}-{again}" if again else name)
        return found

    def broken_links(self) -> list[str]:
        """The links that lead nowhere, each with what is wrong."""
        wrong = []
        for target, anchor in self.links():
            if not target.exists():
                wrong.append(f"{self.path.name}: there is no {target}")
            elif anchor and target.suffix == ".md" and anchor not in Page(self.root, target).anchors():
                wrong.append(f"{self.path.name}: {target.name} has no heading #{anchor}")
        return wrong

    def missing_files(self) -> list[str]:
        """The files and folders that the page names and the repository does not have."""
        return sorted({name for name in NAMED.findall(self.text) if not (self.root / name).exists()})


def reachable(start: Page) -> set[Path]:
    """The pages that links lead to, step by step; the start is one of them."""
    seen, ahead = {start.path}, [start]
    while ahead:
        for target, _ in ahead.pop().links():
            if target.suffix == ".md" and target.is_file() and target not in seen:
                seen.add(target)
                ahead.append(Page(start.root, target))
    return seen
