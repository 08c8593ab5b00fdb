"""The same batch on the machines of a Dask cluster, given by the address of its scheduler."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Callable, Iterable, Iterator
from types import TracebackType
from typing import Any, Generic, Self, TypeVar

from kerfwise.encoder.errors import InputError

Piece = TypeVar("Piece")
Made = TypeVar("Made")

ANSWER_S = 10.0
"""How long a scheduler may take to answer."""
AHEAD = 4
"""Pieces handed out for each thread of the cluster: enough to keep it busy, few enough to be told what is done now."""


def dask() -> Any:
    """Dask's package for several machines, which is an extra.

    Raises
    ------
    InputError
        If it is not installed.
    """
    try:
        import distributed
    except ImportError:
        raise InputError("--scheduler needs Dask: pip install 'kerfwise[cluster]'") from None
    return distributed


class Cluster(Generic[Piece, Made]):
    """Pieces of work done by the workers of a Dask scheduler.

    Where a worker dies, Dask gives what it did to another; a piece that has killed several is an exception. Each piece
    comes back once. Files are named, not sent: the workers see nests and profiles under the same paths.

    Raises
    ------
    InputError
        If Dask is not installed, or no scheduler answers at the address.
    """

    def __init__(self, work: Callable[[Piece], Made], scheduler: str, tell: Callable[[str], None]) -> None:
        client = dask().Client
        for name in ("distributed", "distributed.client", "distributed.core", "distributed.comm", "tornado"):
            logging.getLogger(name).setLevel(logging.CRITICAL)  # what matters is said here, in words
        try:
            self._client: Any = client(scheduler, timeout=ANSWER_S, set_as_default=False)
        except (OSError, TimeoutError, ValueError) as error:
            said = f"no Dask scheduler answers ({error})"
            raise InputError(f"--scheduler {scheduler}: {said}; start one with `dask scheduler`") from None
        self._work, self._scheduler = work, scheduler
        workers = self._workers()
        if not workers:
            tell(f"the scheduler {scheduler} has no worker yet: start some with `dask worker {scheduler} --nthreads 1`")
        if any(worker["nthreads"] > 1 for worker in workers):
            tell(
                "workers with several threads plan several nests in one process, which is slow: --nthreads 1 is faster"
            )

    def run(self, pieces: Iterable[Piece], began: Callable[[Piece], None]) -> Iterator[tuple[Piece, Made | Exception]]:
        """Each piece with what was made of it, as soon as it is finished; with the exception, where one was raised.

        Raises
        ------
        InputError
            If the scheduler is lost.
        """
        left = iter(pieces)
        given: dict[Any, Piece] = {}
        answers = dask().as_completed(loop=self._client.loop)
        try:
            while True:
                room = AHEAD * max(1, sum(worker["nthreads"] for worker in self._workers())) - len(given)
                for _, piece in zip(range(room), left, strict=False):
                    future = self._client.submit(self._work, piece, pure=False)
                    given[future] = piece
                    answers.add(future)
                    began(piece)
                if not given:
                    return
                future = next(answers)
                yield given.pop(future), self._answer(future)
        finally:
            self._client.cancel(list(given), force=True)

    def _answer(self, future: Any) -> Made | Exception:
        if future.cancelled():
            raise InputError(f"--scheduler {self._scheduler}: was lost; the same command goes on from here")
        error = future.exception()
        if isinstance(error, Exception):
            return error
        made: Made = future.result()
        future.release()
        return made

    def _workers(self) -> list[dict[str, Any]]:
        with contextlib.suppress(OSError, TimeoutError):
            return list(self._client.scheduler_info(n_workers=-1)["workers"].values())
        return []

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._client.close()
