"""One case: the files that are there, and the words of the command."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Case:
    """What is given to the command line.

    `files` lie in the folder that the command runs in, by name; `None` is a folder. `words` follow `kerfwise`. What may
    be changed to make the case smaller: the files `damaged`, or the words, where there are none. The command may write
    over `written` alone.
    """

    kind: str
    files: Mapping[str, bytes | None]
    words: tuple[str, ...]
    damaged: tuple[str, ...] = ()
    written: tuple[str, ...] = field(default=())
