"""A Dask scheduler and its workers, all on this machine, for measurements and tests."""

from __future__ import annotations

import contextlib
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path


@contextlib.contextmanager
def cluster(folder: Path, workers: int) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """The address of a scheduler and the processes of its workers, which may still be starting; all end with this.

    The folder holds what they write, their messages among it.
    """
    address = f"tcp://127.0.0.1:{_free_port()}"
    scheduler = ["scheduler", "--host", "127.0.0.1", "--port", address.rpartition(":")[2]]
    worker = ["worker", address, "--nthreads", "1", "--no-nanny", "--local-directory", str(folder)]
    started: list[subprocess.Popen[bytes]] = []
    with contextlib.ExitStack() as ends:
        for number, (name, *given) in enumerate((scheduler, *[worker] * workers)):
            command = [sys.executable, "-m", f"distributed.cli.dask_{name}", *given, "--no-dashboard"]
            said = ends.enter_context((folder / f"{name}{number}.log").open("wb"))
            started.append(subprocess.Popen(command, stdout=said, stderr=said, cwd=folder))
            ends.callback(started[-1].wait)
            ends.callback(started[-1].kill)
        yield address, started[1:]


def _free_port() -> int:
    with contextlib.closing(socket.socket()) as free:
        free.bind(("127.0.0.1", 0))
        port: int = free.getsockname()[1]
        return port
