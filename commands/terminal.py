"""What is printed, and progress: foreign text is shown, not obeyed; a stream that takes no more changes nothing."""

from __future__ import annotations

import contextlib
import os
import sys
import time
import warnings
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, TextIO, cast

from kerfwise.encoder.errors import Advice, InputError
from kerfwise.encoder.escape import escape_lines
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.jobs.progress import Listener
from kerfwise.models.jit import counted_s
from kerfwise.postproc.report.legend import counted
from kerfwise.rules.statements import EXEMPTION_MM

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


def first_told(seconds: float, first_mm: float, last_mm: float) -> str:
    """When the first plan was there, and how much more it cost than what was found in the end.

    Examples
    --------
    >>> first_told(0.8, 1031.0, 1000.0)
    'first plan after 0.8 s, 3.1 % above what was found in the end'
    >>> first_told(0.8, 2_001_000.0, 1000.0)
    'first plan after 0.8 s, with 2 excuses more than what was found in the end'
    """
    more = round(first_mm // EXEMPTION_MM) - round(last_mm // EXEMPTION_MM)
    if more > 0:
        return f"first plan after {seconds:.1f} s, with {counted(more, 'excuse')} more than what was found in the end"
    above = max(0.0, first_mm - last_mm) / max(last_mm % EXEMPTION_MM, 1.0)
    return f"first plan after {seconds:.1f} s, {100 * above:.1f} % above what was found in the end"


class ProgressLine(Listener):
    """Listens to the engines and shows what they have reached; answers False once the user has pressed Ctrl-C."""

    def __init__(self) -> None:
        super().__init__(shown=status_line("starting"))
        self._first: tuple[float, float] | None = None

    def __call__(self, engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        if self._first is None and cost_um is not None:
            self._first = counted_s(), cost_um / UM_PER_MM
        if self.shown is not None:
            self.shown.update(self._line(engine, cost_um, bound_um))
        return super().__call__(engine, cost_um, bound_um)

    def first_line(self, objective_mm: float, began_s: float) -> str:
        """When the first plan was there since `began_s`, and how far from the last; "" where nobody has watched."""
        if self.shown is None or self._first is None:
            return ""
        return first_told(self._first[0] - began_s, self._first[1], objective_mm)

    def _line(self, engine: str, cost_um: int | None, bound_um: int | None) -> str:
        line = f"{time.monotonic() - self.started:5.1f} s  {engine}"
        if cost_um is not None:
            line += f"  incumbent {cost_um / UM_PER_MM / 1000:.3f} m"
        if bound_um:
            line += f"  bound {bound_um / UM_PER_MM / 1000:.3f} m"
        return line + "  (Ctrl-C keeps the best so far)"
