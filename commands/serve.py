"""kerfwise serve: the interactive viewer, in a browser on this machine."""

from __future__ import annotations

import webbrowser
from importlib.util import find_spec
from pathlib import Path

import click

from kerfwise.encoder.errors import InputError

from .shared_options import AMOUNT_OVER_ZERO, MEMORY, TRUST

NEEDED = ("starlette", "uvicorn", "anyio", "ruamel.yaml")


@click.command()
@click.argument("given", metavar="[NEST|DIR]", default=".")
@click.option("-p", "--profile", metavar="PROFILE", help="Name or path, for nests whose job file names none.")
@click.option("--port", type=click.IntRange(0, 65535), default=0, metavar="N", help="Port. Default: any free one.")
@click.option("--work", type=AMOUNT_OVER_ZERO, default=30.0, show_default=True, metavar="W",
              help="Effort of a plan, as for solve.")  # fmt: skip
@MEMORY
@click.option("--open", "open_browser", is_flag=True, help="Open the viewer in the browser.")
@TRUST
def command(
    given: str, profile: str | None, port: int, work: float, memory_gb: float, open_browser: bool, trust: bool
) -> None:
    """Open NEST, or the nests of the folder DIR, in the interactive viewer: move, lock, re-plan and save.

    Only browsers on this machine can reach it, by the printed address.
    """
    if missing := [name for name in NEEDED if not _is_there(name)]:
        raise InputError(f"serve needs {', '.join(missing)}: install it with `pip install 'kerfwise[serve]'`")
    from kerfwise.serving.run_server import serve

    def ready(address: str) -> None:
        click.echo(f"serving {given} at {address}\nCtrl-C ends it")
        if open_browser:
            webbrowser.open_new_tab(address)

    serve(Path(given), port=port, profile=_found(profile), work=work, memory_gb=memory_gb, trust=trust, ready=ready)


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
