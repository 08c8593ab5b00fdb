"""A comparison as one page that needs nothing else: tables, and both routes as a drawing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

from .comparison import Comparison
from .picture import picture, title_of
from .text import cut_row, figure_rows, proofs, rule_rows, sides, summary_of

_STYLE = (
    "body{font:15px/1.4 'DejaVu Sans',Verdana,Arial,sans-serif;margin:2em auto;max-width:75em;padding:0 1em;"
    "color:#212529}table{border-collapse:collapse;margin:1em 0}td,th{padding:.2em .9em .2em 0;text-align:left;"
    "border-bottom:1px solid #dee2e6}svg{max-width:100%;height:auto}td{white-space:pre-wrap}"
)


def page(made: Comparison) -> str:
    """The page, in HTML."""
    title = escape(title_of(made))
    drawn = str(picture(made, ".svg"))
    parts = [
        '<!doctype html><html lang="en"><head><meta charset="utf-8">',
        f"<title>{title}</title><style>{_STYLE}</style></head><body>",
        f"<h1>{title}</h1>",
        _paragraphs(sides(made)),
        _table(("", "A", "B", ""), figure_rows(made)),
        _paragraphs(proofs(made)),
        drawn,
        "<h2>Rules</h2>",
        _table(("rule", "A", "B", ""), rule_rows(made)),
        "<h2>Cuts</h2>",
        _paragraphs([summary_of(made.changed, len(made.cuts))]),
        _table(("contour", "A", "B", ""), map(cut_row, made.changed)) if made.changed else "",
        "</body></html>\n",
    ]
    return "\n".join(parts)


def _paragraphs(lines: Iterable[str]) -> str:
    return "<p>" + "<br>".join(escape(line) for line in lines) + "</p>"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    top = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    lines = ("".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rows)
    return f"<table><tr>{top}</tr>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>"
