"""The peak of a process is its own, not that of the process which began it."""

import subprocess
import sys

import pytest

from kerfwise.apps.bench.bench_child import peak_mb


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="other systems tell no peak of a process alone")
def test_a_process_does_not_take_over_the_peak_of_its_parent() -> None:
    held = bytearray(b"1" * (300 << 20))
    assert peak_mb() > len(held) / (1 << 20)
    tell = "from kerfwise.apps.bench.bench_child import peak_mb; print(peak_mb())"
    done = subprocess.run([sys.executable, "-c", tell], capture_output=True, text=True, check=True)
    assert 1.0 < float(done.stdout) < 200.0
