"""The server's own pages and their files: read from the package, put together with nothing that a nest says."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from pathlib import PurePosixPath

from starlette.responses import HTMLResponse, PlainTextResponse, Response

from kerfwise.postproc import report
from kerfwise.postproc.report.page import page_and_policy

ENTRY = "worked.js"
"""The module of `hands` that the page of a nest begins with."""
_KINDS = {".js": "text/javascript", ".css": "text/css"}


def list_page() -> str:
    """The page that lists the nests of the folder, and takes drawings that are dropped on it."""
    return files(__package__).joinpath("hands", "frame.html").read_text(encoding="utf-8")


def worked_page(name: str) -> Response:
    """The page of one nest, with hands: all that it shows it asks for. Its policy names its own script by hash."""
    html, policy = page_and_policy({"title": name}, ENTRY, connect=True, more=_hands())
    headers = {"content-security-policy": f"{policy}; frame-ancestors 'none'"}
    return HTMLResponse(html.encode("utf-8", "surrogatepass"), headers=headers)


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
    folders = files(__package__).joinpath("hands"), files(report).joinpath("page_files")
    found = next((file for folder in folders if (file := folder.joinpath(name)).is_file()), None)
    if found is None:
        return PlainTextResponse("there is no such file", 404)
    return Response(found.read_bytes(), media_type=f"{kind}; charset=utf-8")
