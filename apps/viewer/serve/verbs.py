"""kerfwise serve: the interactive viewer, in a browser on this machine."""

from __future__ import annotations

import os
import tempfile
import webbrowser
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import click

from kerfwise.commands.shared_options import AMOUNT_OVER_ZERO, MEMORY, TRUST
from kerfwise.encoder.errors import InputError

NEEDED = ("starlette", "uvicorn", "anyio")


@click.command()
@click.argument("given", metavar="[NEST|DIR]", default=".")
@click.option("-p", "--profile", metavar="PROFILE", help="Name or path, for nests whose job file names none.")
@click.option("--port", type=click.IntRange(0, 65535), default=0, metavar="N", help="Port. Default: any free one.")
@click.option("--work", type=AMOUNT_OVER_ZERO, default=30.0, show_default=True, metavar="W",
              help="Effort of a plan, as for solve.")  # fmt: skip
@MEMORY
@click.option("--open", "open_browser", is_flag=True, help="Open the viewer in the browser.")
@TRUST
@click.option("--also", multiple=True, metavar="DIR", type=click.Path(exists=True, file_okay=False, path_type=Path),
              help="A folder that profiles, dialects and models may be read from, too.")  # fmt: skip
@click.option("--token-file", type=click.Path(path_type=Path), metavar="FILE",
              help="Write the token for programs into a new FILE that only you can read.")  # fmt: skip
def command(
    given: str, profile: str | None, port: int, open_browser: bool, token_file: Path | None, **how: Any
) -> None:
    """Open NEST, or the nests of the folder DIR, in the interactive viewer: move, lock, re-plan and save.

    Only browsers on this machine can reach it, by the printed address, which lets one browser in, once.
    """
    if missing := [name for name in NEEDED if not _is_there(name)]:
        raise InputError(f"serve needs {', '.join(missing)}: install it with `pip install 'kerfwise[serve]'`")
    from .kept_sessions import state_folder
    from .run_server import serve
    from .server import Serving

    if hasattr(os, "geteuid") and os.geteuid() == 0:
        warning = (
            "warning: serve runs as root, and so does all that a drawing or a profile makes it do: start it as a user"
        )
        click.echo(warning, err=True)
    with tempfile.TemporaryDirectory(prefix="kerfwise-") as private:

        def ready(address: str) -> None:
            click.echo(f"serving {given} at {address}\nCtrl-C ends it")
            if open_browser:
                webbrowser.open_new_tab(leading_to(address, Path(private)).as_uri())

        serve(
            Path(given),
            Serving(_found(profile), state=state_folder(), **how),
            port,
            token_file,
            ready,
            another=lambda address: click.echo(f"for another browser: {address}"),
        )


def leading_to(address: str, folder: Path) -> Path:
    """A page that leads to an address, which only this user can read: commands of browsers can be seen by all."""
    page = folder / "open.html"
    page.touch(0o600)
    refresh = f'<meta http-equiv="refresh" content="0; url={address}">'
    text = f'<!DOCTYPE html><meta charset="utf-8">{refresh}<title>kerfwise</title>'
    page.write_text(text, encoding="utf-8", newline="")
    return page


def _is_there(name: str) -> bool:
    try:
        return find_spec(name) is not None
    except ModuleNotFoundError:
        return False


def _found(profile: str | None) -> str | None:
    """A shipped profile's name as it is, a path from wherever the nest lies."""
    from kerfwise.rules.profile.load import shipped_profiles

    if profile is None or profile in shipped_profiles():
        return profile
    path = Path(profile)
    if not path.is_file():
        from kerfwise.jobs.inputs import plant_of

        plant_of(profile)  # says what is wrong, with the nearest name
    return str(path.resolve())
