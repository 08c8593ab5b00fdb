"""Tables of pages that benchmarks make: a row is printed as it is measured, and set into a page where one is named."""

from __future__ import annotations

from pathlib import Path


def put_row(row: str, head: str, page: Path | None = None) -> None:
    """Print a row of the table with this head, and set it into a page: in place of the row for the same, or at its end.

    Raises SystemExit if the page has no such table.
    """
    print(row, flush=True)
    if page is None:
        return
    lines = page.read_text(encoding="utf-8").split("\n")
    if head not in lines:
        raise SystemExit(f"{page} has no table that begins: {head}")
    begin = lines.index(head) + 2
    end = next(k for k in range(begin, len(lines)) if not lines[k].startswith("|"))
    of_same = [k for k in range(begin, end) if lines[k].split("|")[1] == row.split("|")[1]]
    lines[slice(of_same[0], of_same[0] + 1) if of_same else slice(end, end)] = [row]
    page.write_text("\n".join(lines), encoding="utf-8", newline="\n")
