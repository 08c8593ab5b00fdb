"""What is printed: foreign text is shown, not obeyed, and a stream that takes no more changes nothing else."""

from __future__ import annotations

import contextlib
import os
import sys
import warnings
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, TextIO, cast

from kerfwise.encoder.errors import Advice, InputError
from kerfwise.encoder.escape import escape_lines

if TYPE_CHECKING:
    from rich.status import Status


class Stream:
    """Standard output or error: text is written as long as there is somebody to read it, and discarded after that.

    `lost` says why nothing more can be written, once that is so.
    """

    def __init__(self, stream: TextIO | None) -> None:
        self.stream, self.lost = stream, None if stream is not None else OSError("it is closed")

    def write(self, text: str) -> int:
        """Write text; what a terminal would obey, and what the stream's encoding does not have, is written out."""
        if self.stream is not None and self.lost is None:
            safe = escape_lines(text)
            try:
                self.stream.write(safe)
            except UnicodeEncodeError as error:
                self._written(safe.encode(error.encoding, "backslashreplace").decode(error.encoding))
            except (OSError, ValueError) as error:
                self._lose(error)
        return len(text)

    def _written(self, text: str) -> None:
        assert self.stream is not None
        try:
            self.stream.write(text)
        except (OSError, ValueError) as error:
            self._lose(error)

    def flush(self) -> None:
        """Hand on what is written so far."""
        if self.stream is not None and self.lost is None:
            try:
                self.stream.flush()
            except (OSError, ValueError) as error:
                self._lose(error)

    def isatty(self) -> bool:
        """Whether somebody sits before it."""
        return self.stream is not None and self.lost is None and self.stream.isatty()

    def _lose(self, error: OSError | ValueError) -> None:
        """From here on into the void, so that Python, which flushes at its end, does not fail at that."""
        self.lost = error if isinstance(error, OSError) else OSError(str(error))
        with contextlib.suppress(OSError, ValueError, AttributeError):
            assert self.stream is not None
            void = os.open(os.devnull, os.O_WRONLY)
            os.dup2(void, self.stream.fileno())
            os.close(void)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.__dict__["stream"], name)


@contextlib.contextmanager
def terminal() -> Iterator[None]:
    """Both streams, made safe. One that was closed from the start is not taken by the next file that is opened."""
    for descriptor in (0, 1, 2):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # the lowest number that is free: this one
    before = sys.stdout, sys.stderr
    out, err = Stream(before[0]), Stream(before[1])
    sys.stdout, sys.stderr = cast(TextIO, out), cast(TextIO, err)
    try:
        with warnings.catch_warnings():
            _show_advice(err)
            yield
    finally:
        out.flush()
        if isinstance(out.lost, OSError) and out.lost.errno is not None and not isinstance(out.lost, BrokenPipeError):
            err.write(f"kerfwise: not all could be printed: {out.lost.strerror}\n")
        err.flush()
        sys.stdout, sys.stderr = before


def _show_advice(err: Stream) -> None:
    """Advice is a note; other warnings are shown as ever."""
    shown_else = warnings.showwarning

    def show(message: Warning | str, category: type[Warning], *where: Any, **more: Any) -> None:
        if issubclass(category, Advice):
            err.write(f"note: {message}\n")
        else:
            shown_else(message, category, *where, **more)

    warnings.showwarning = show
    warnings.simplefilter("always", Advice)


def bare(stream: TextIO) -> TextIO:
    """The stream itself, for whoever draws with a terminal's own signs."""
    return cast(TextIO, stream.stream) if isinstance(stream, Stream) else stream


def status_line(text: str) -> Status | None:
    """A line on the terminal that moves while work goes on; None where nobody sits before standard error."""
    if not sys.stderr.isatty():
        return None
    from rich.console import Console

    return Console(file=bare(sys.stderr)).status(text)


def expect_printed() -> None:
    """Where what is printed is all that the command makes: refuse to end well if it was not printed whole.

    Raises InputError if standard output takes no more; not where its reader has gone, who wants no more.
    """
    sys.stdout.flush()
    lost = sys.stdout.lost if isinstance(sys.stdout, Stream) else None
    if lost is not None and not isinstance(lost, BrokenPipeError):
        raise InputError(f"standard output cannot be written: {lost.strerror or lost}")
