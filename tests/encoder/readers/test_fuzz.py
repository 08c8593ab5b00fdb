"""Damaged files are read or refused with an InputError: nothing else comes out."""

import contextlib
import io
import json
import tempfile
from functools import cache
from pathlib import Path

import ezdxf
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise import InputError
from kerfwise.tests.encoder.readers.drawings import lines, read_drawing, square
from kerfwise.tests.tools.amount import examples

SEEDS = st.binary(max_size=12) | st.sampled_from(
    [b"-", b"1e400", b"NaN", b"999999999", b"[", b"}", b"\n", b"\0", b"  0\n", b"EOF\n", b"LINE", b"null", b"<", b"&"]
)


@cache
def small(suffix: str) -> bytes:
    """A small valid file of each format."""
    if suffix == ".json":
        return json.dumps(
            {
                "format": "kerfwise-nest/1",
                "units": "mm",
                "sheet": {"outline": [[0, 0], [100, 0], [100, 50], [0, 50]]},
                "parts": [
                    {
                        "id": "A",
                        "outer": [[5, 5], [45, 5, 0.5], [45, 45], [5, 45]],
                        "holes": [[[10, 10, 1], [20, 10, 1]]],
                    },
                    {"id": "B", "outer": [[70, 5], [90, 5], [90, 45]], "marks": [[[80, 8], [85, 8]]]},
                ],
            }
        ).encode()
    if suffix == ".svg":
        return b"""<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="50mm" viewBox="0 0 100 50">
        <g id="sheet"><rect width="100" height="50"/></g><path d="M5 5 h20 a5 5 0 0 1 5 5 C 30 30 20 40 5 30 z"/>
        <circle cx="60" cy="20" r="9" transform="rotate(5)"/></svg>"""
    document = ezdxf.new("R12")
    space = document.modelspace()
    lines(space, square(0, 0, 300), layer="SHEET")
    lines(space, square(5, 5, 20))
    space.add_arc((60, 60), 10, 0, 180)
    space.add_line((50, 60), (70, 60))
    space.add_polyline2d([(60, 10, 1), (80, 10, 1)], format="xyb", close=True)
    document.blocks.new("disc").add_circle((0, 0), 4)
    space.add_blockref("disc", (20, 70), dxfattribs={"xscale": 2})
    stream = io.StringIO()
    document.write(stream)
    whole = stream.getvalue()
    blocks = whole.index("  2\nBLOCKS")  # the geometry is a small share of the file: let the damage fall on it
    return f"0\nSECTION\n{whole[blocks:]}".encode()


def survives(data: bytes, suffix: str, repair: bool) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"nest{suffix}")
        path.write_bytes(data)
        with contextlib.suppress(InputError):
            nest = read_drawing(path, repair=repair)
            assert nest.contours
            assert all(c.polygon.is_valid for c in nest.contours if c.kind != "mark")


def test_the_seeds_are_sound() -> None:
    for suffix in (".json", ".dxf", ".svg"):
        survives(small(suffix), suffix, repair=False)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, f"nest{suffix}")
            path.write_bytes(small(suffix))
            assert len(read_drawing(path).parts) >= 2


def test_a_dxf_header_that_breaks_off_at_any_line() -> None:
    lines = small(".dxf").splitlines(keepends=True)
    for count in range(1, 30):
        survives(b"".join(lines[:count]), ".dxf", repair=True)


@examples(150)
@given(st.sampled_from([".json", ".dxf", ".svg"]), st.floats(0, 1), st.booleans(), st.booleans())
def test_files_cut_short(suffix: str, share: float, closed: bool, repair: bool) -> None:
    data = small(suffix)[: int(share * len(small(suffix)))]
    survives(data + b"\n  0\nEOF\n" * (closed and suffix == ".dxf"), suffix, repair)


@pytest.mark.slow
@examples(250)
@given(
    st.sampled_from([".json", ".dxf", ".svg"]),
    st.lists(st.tuples(st.floats(0, 1), st.integers(0, 12), SEEDS), min_size=1, max_size=4),
    st.booleans(),
)
def test_files_with_bytes_changed(suffix: str, changes: list[tuple[float, int, bytes]], repair: bool) -> None:
    data = small(suffix)
    for share, length, put in changes:
        at = int(share * len(data))
        data = data[:at] + put + data[at + length :]
    survives(data, suffix, repair)


@pytest.mark.slow
@examples(80)
@given(st.data(), st.booleans())
def test_dxf_numbers_changed(data: st.DataObject, repair: bool) -> None:
    rows = small(".dxf").split(b"\n")
    numbers = [k for k, row in enumerate(rows) if k % 2 and row.strip().replace(b".", b"").replace(b"-", b"").isdigit()]
    for _ in range(data.draw(st.integers(1, 5))):
        at = data.draw(st.sampled_from(numbers))
        value = data.draw(st.floats() | st.floats(-200, 200) | st.integers(-5, 300))
        rows[at] = str(value).encode()
    survives(b"\n".join(rows), ".dxf", repair)


@examples(80)
@given(st.data(), st.booleans())
def test_json_values_changed(data: st.DataObject, repair: bool) -> None:
    document = json.loads(small(".json"))
    values = (
        st.floats()
        | st.integers(-100, 100)
        | st.none()
        | st.booleans()
        | st.text(max_size=3)
        | st.just([])
        | st.just({})
    )
    for _ in range(data.draw(st.integers(1, 3))):
        at = document
        while isinstance(at, dict | list) and at:
            key = data.draw(st.sampled_from(sorted(at) if isinstance(at, dict) else list(range(len(at)))))
            if not isinstance(at[key], dict | list) or data.draw(st.integers(0, 5)) == 0:
                at[key] = data.draw(values)
                break
            at = at[key]
    survives(json.dumps(document).encode(), ".json", repair)
