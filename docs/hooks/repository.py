"""A hook of the docs site: pages that lie outside `docs`, and links that lead out of it.

CONTRIBUTING.md and CHANGELOG.md stand at the root, where people look for them, and become pages of the site. A link to
another file of the repository, such as `../postproc/check`, is right where the repository is read; the site has no such
file, and shows its path instead. The pictures of rules stand in the folders of the rules, and become files of the site.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

AT_ROOT = {"CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md"}
LINK = re.compile(r"\[([^\]]*)\]\(([^)\s#]+)(#[^)\s]*)?\)")


def on_files(files: Files, config: Any, **_: Any) -> Files:
    """Add the pages of the root."""
    for name, page in AT_ROOT.items():
        text = (_root(config) / name).read_text(encoding="utf-8")
        files.append(File.generated(config, page, content=_moved(text)))
    for path in sorted(_root(config).glob("rules/catalogue/*/picture.svg")):
        files.append(File.generated(config, f"rule-pictures/{path.parent.name}.svg", abs_src_path=str(path)))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, **_: Any) -> str:
    """Turn links that lead out of `docs` into pages of the site, or into paths."""

    def within(link: re.Match[str]) -> str:
        text, target, anchor = link[1], link[2], link[3] or ""
        if not target.startswith("../"):
            return link[0]
        name = target.removeprefix("../")
        if name in AT_ROOT:
            return f"[{text}]({AT_ROOT[name]}{anchor})"
        if name.endswith("/picture.svg"):
            return f"[{text}](rule-pictures/{Path(name).parent.name}.svg)"
        if not (_root(config) / name).exists():
            return link[0]  # mkdocs says that it leads nowhere
        return text if text.strip("`").endswith(name) else f"{text} (`{name}`)"

    return LINK.sub(within, markdown)


def _moved(text: str) -> str:
    """The text of a page of the root, its links as seen from `docs`."""

    def moved(link: re.Match[str]) -> str:
        if "://" in link[2]:
            return link[0]
        inside = link[2].startswith("docs/")
        target = link[2].removeprefix("docs/") if inside else f"../{link[2]}"
        return f"[{link[1]}]({target}{link[3] or ''})"

    return LINK.sub(moved, text)


def _root(config: Any) -> Path:
    return Path(config["config_file_path"]).parent
