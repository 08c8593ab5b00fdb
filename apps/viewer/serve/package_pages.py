"""The server's own pages and their files: read from the package, put together with nothing that a nest says."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from pathlib import PurePosixPath
from typing import Any

from starlette.responses import HTMLResponse, PlainTextResponse, Response

from kerfwise.apps.viewer import page
from kerfwise.apps.viewer.page.page_html import as_script_data, page_and_policy
from kerfwise.languages import page_texts

ENTRY = "worked.js"
"""The module of `hands` that the page of a nest begins with."""
_KINDS = {".js": "text/javascript", ".css": "text/css"}


def list_page() -> str:
    """The page that lists the nests of the folder, and takes drawings that are dropped on it."""
    frame = files(__package__).joinpath("hands", "frame.html").read_text(encoding="utf-8")
    return frame.replace("@texts", as_script_data(_texts()))


def worked_page(name: str) -> Response:
    """The viewer of one nest; it requests all that it shows. Its policy names its own script by hash."""
    html, policy = page_and_policy({"title": name}, ENTRY, connect=True, more=_hands(), said=_texts())
    headers = {"content-security-policy": f"{policy}; frame-ancestors 'none'"}
    return HTMLResponse(html.encode("utf-8", "surrogatepass"), headers=headers)


@cache
def _texts() -> dict[str, dict[str, Any]]:
    """What the viewer says, in every language: the texts of each page, and its own."""
    page, viewer = page_texts(), page_texts("viewer")
    return {language: {**texts, **viewer[language]} for language, texts in page.items()}


@cache
def _hands() -> dict[str, str]:
    """The modules and the style sheet that the page of a nest has beside those of every page."""
    folder = files(__package__).joinpath("hands")
    return {
        file.name: file.read_text(encoding="utf-8")
        for file in sorted(folder.iterdir(), key=lambda file: file.name)
        if file.name.endswith((".js", ".css")) and not file.name.startswith("list.")
    }


def static_file(name: str) -> Response:
    """A script or style sheet of the package: of the hands, or of the page itself."""
    plain = PurePosixPath(name)
    kind = _KINDS.get(plain.suffix)
    if kind is None or len(plain.parts) != 1 or plain.name != name:
        return PlainTextResponse("there is no such file", 404)
    folders = files(__package__).joinpath("hands"), files(page).joinpath("page_files")
    found = next((file for folder in folders if (file := folder.joinpath(name)).is_file()), None)
    if found is None:
        return PlainTextResponse("there is no such file", 404)
    return Response(found.read_bytes(), media_type=f"{kind}; charset=utf-8")
