"""The server's own pages and their files: read from the package, put together with nothing that a nest says."""

from __future__ import annotations

from importlib.resources import files
from pathlib import PurePosixPath

from starlette.responses import PlainTextResponse, Response

from .session import Session

_KINDS = {".js": "text/javascript", ".css": "text/css"}


def list_page(first: str | None) -> str:
    """The page that lists the nests of the folder, and takes drawings that are dropped on it."""
    return _frame("list.js")


def worked_page(session: Session) -> str:
    """The page of one nest; all that it shows it asks for."""
    return _frame("worked.js")


def static_file(name: str) -> Response:
    """A script or style sheet of the package."""
    plain = PurePosixPath(name)
    kind = _KINDS.get(plain.suffix)
    if kind is None or len(plain.parts) != 1 or plain.name != name:
        return PlainTextResponse("there is no such file", 404)
    found = files(__package__).joinpath("hands", name)
    if not found.is_file():
        return PlainTextResponse("there is no such file", 404)
    return Response(found.read_bytes(), media_type=f"{kind}; charset=utf-8")


def _frame(script: str) -> str:
    return files(__package__).joinpath("hands", "frame.html").read_text(encoding="utf-8").replace("@script", script)
