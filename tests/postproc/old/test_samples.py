"""QtPlasmaC's own sample programs, which come with LinuxCNC: most are read, the others refused with their line."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.tests.postproc.old.samples import samples
from kerfwise.tests.tools import canon

LEAST_READ = 14


@pytest.mark.slow
@pytest.mark.linuxcnc
def test_most_samples_are_read_and_none_gets_longer() -> None:
    share = Path(canon.find_rs274()).resolve().parents[1]
    folders = [share / "root/usr/share/linuxcnc/ncfiles/plasmac", share / "share/linuxcnc/ncfiles/plasmac"]
    folder = next((folder for folder in folders if folder.is_dir()), None)
    assert folder is not None, f"no samples beside {canon.find_rs274()}: tests/tools/get_rs274.sh unpacks them"
    found = list(samples(folder))
    assert len(found) >= 18
    read = [sample for sample in found if sample.idle_mm is not None]
    assert len(read) >= LEAST_READ, [sample.told for sample in found if sample.idle_mm is None]
    assert not [sample.name for sample in read if sample.longer]
    for sample in found:
        if sample.idle_mm is None:
            assert sample.line, sample.told
            assert "parameters are not checked" in sample.told
