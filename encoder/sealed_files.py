"""Files kept between runs that cannot hurt: what is broken, foreign or out of date is never used.

In front stands what a file was made by (32 bytes), then the sum of the rest (32 bytes). A file is there whole or not at
all, however many runs write it at once.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import tempfile
from pathlib import Path

DIGEST_BYTES = 32


class DamagedFile(Exception):
    """A kept file does not hold what was written."""


def read_sealed(path: Path, made_by: bytes) -> bytes | None:
    """What a file holds; None where it is not there, cannot be read, or was made by something else.

    `made_by` is a digest of 32 bytes.

    Raises
    ------
    DamagedFile
        If the file is cut short or changed.

    Examples
    --------
    >>> import tempfile
    >>> place, maker = Path(tempfile.mkdtemp(), "kept"), hashlib.sha256(b"me").digest()
    >>> write_sealed(place, maker, b"text")
    >>> read_sealed(place, maker)
    b'text'
    """
    try:
        data = path.read_bytes()
    except OSError:
        return None
    maker, total, content = data[:DIGEST_BYTES], data[DIGEST_BYTES : 2 * DIGEST_BYTES], data[2 * DIGEST_BYTES :]
    if len(total) == DIGEST_BYTES and maker != made_by:
        return None
    if hashlib.sha256(content).digest() != total:
        raise DamagedFile(path)
    return content


def write_sealed(path: Path, made_by: bytes, content: bytes) -> None:
    """Keep content in a file, in place of what is there.

    Raises
    ------
    OSError
        If it cannot be written; nothing is left of it then.
    """
    handle, beside = tempfile.mkstemp(prefix=".", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(made_by + hashlib.sha256(content).digest() + content)
        os.chmod(beside, 0o644)
        os.replace(beside, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(beside)
        raise
