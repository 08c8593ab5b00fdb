"""What the server's processes write to the terminal."""

from __future__ import annotations

import subprocess
import sys

SCRIPT = """
import time, warnings
from kerfwise.apps.viewer.serve.worker import show_few_notes
from kerfwise.encoder import progress_notice
from kerfwise.encoder.errors import Advice

show_few_notes()
progress_notice.AFTER_S = 0.01
with progress_notice.notice_if_long("measuring plate.json"):
    time.sleep(0.2)
warnings.warn("kernels are not kept", Advice)
"""


def test_notes_stand_there_as_such_and_what_pages_tell_does_not() -> None:
    done = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True, timeout=60, check=True)
    assert done.stderr.splitlines() == ["note: kernels are not kept"]
