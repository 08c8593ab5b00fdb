"""Lists of parts as shops have them: any separator, a dozen languages, workbooks; and what is wrong with its cell."""

from __future__ import annotations

import datetime
import io
from pathlib import Path

import openpyxl
import pytest

from kerfwise.apps.nesting.part_list import PartRow, SheetRow, read_list
from kerfwise.apps.nesting.request import NamePattern
from kerfwise.apps.nesting.tables import WrongCell, day_in, head_of, length_in, rank_in, turns_in, whole_in
from kerfwise.encoder.errors import InputError
from kerfwise.tests.commands.run_cli import kerfwise


def rows_of(path: Path, data: str | bytes) -> tuple[PartRow, ...]:
    """The parts of a list with this content."""
    path.write_bytes(data.encode() if isinstance(data, str) else data)
    return read_list(path).parts


@pytest.mark.parametrize(
    "head",
    [
        "part;quantity;material;thickness",
        "Pos;Datei;Stückzahl;Werkstoff;Blechdicke",
        "Fichier;Qté;Matière;Épaisseur (mm)",
        "Archivo;Cantidad;Material;Espesor",
        "Disegno;Q.tà;Materiale;Spessore [mm]",
        "Tekening;Aantal;Materiaal;Dikte",
        "Arquivo;Quantidade;Material;Espessura",
        "Plik;Ilość;Gatunek;Grubość",
        "Výkres;Počet ks;Materiál;Tloušťka",
        "Ritning;Antal;Material;Tjocklek",
        "Tegning;Antall;Kvalitet;Tykkelse",
        "Tiedosto;Määrä;Materiaali;Paksuus",
        "Rajz;Darabszám;Anyag;Vastagság",
        "Dosya adı;Adet;Malzeme;Kalınlık",
        "Чертёж;Кол-во;Марка стали;Толщина, мм",
        "图号;数量;材质;板厚",
        "No;Part Number;QTY;GRADE;THK.",
    ],
)
def test_columns_are_known_by_their_words(head: str) -> None:
    found = head_of(1, head.split(";"))
    assert found is not None
    assert list(found.columns.values()) == ["part", "quantity", "material", "thickness"]


@pytest.mark.parametrize("divider", [";", ",", "\t", "|"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_any_separator_and_encoding_says_the_same(tmp_path: Path, divider: str, encoding: str) -> None:
    rows = [["Teil", "Stück", "Dicke [mm]", "Auftrag"], ["Träger.dxf", "12", '"2,5"', "4711"]]
    text = "\r\n".join(divider.join(row) for row in rows)
    (row,) = rows_of(tmp_path / "list.csv", text.encode(encoding))
    assert (row.part, row.quantity, row.thickness_mm, row.order) == ("Träger.dxf", 12, 2.5, "4711")
    assert str(row.place).endswith("list.csv:2:1")


def test_a_title_comments_and_empty_rows_are_passed_over(tmp_path: Path) -> None:
    text = "sep=;\nMonday's list;;\n\n# cut first\nfile;qty;due\na.dxf;2;24.12.2026\n;;\nb.dxf;;\n"
    one, other = rows_of(tmp_path / "list.csv", text)
    assert (one.part, one.quantity, one.due) == ("a.dxf", 2, datetime.date(2026, 12, 24))
    assert (other.part, other.quantity, other.due) == ("b.dxf", None, None)


def test_rows_that_begin_with_a_number_sign(tmp_path: Path) -> None:
    """Comments are counted, a file of such a name among them; under a head # they are places in the list."""
    path = tmp_path / "list.csv"
    assert [row.part for row in rows_of(path, "# today\npart;qty\na.dxf;2\n#1.dxf;3\n# b.dxf;1\n")] == ["a.dxf"]
    assert read_list(path).left_out == (2, 0)
    for first in ("1", "#1"):
        (row,) = rows_of(path, f"# today\n#;part;qty\n{first};a.dxf;2\n")
        assert (row.part, row.quantity, read_list(path).left_out) == ("a.dxf", 2, (0, 0))


def test_hidden_rows_of_a_workbook_are_left_out_and_counted(tmp_path: Path) -> None:
    """As its filters hide them: what nobody sees is not cut."""
    book = openpyxl.Workbook()
    for k, row in enumerate([["part", "qty"], ["a.dxf", 1], ["b.dxf", 2], ["c.dxf", 3]], 1):
        book.active.append(row)
        book.active.row_dimensions[k].hidden = k == 3
    book.save(tmp_path / "list.xlsx")
    listed = read_list(tmp_path / "list.xlsx")
    assert ([row.part for row in listed.parts], listed.left_out) == (["a.dxf", "c.dxf"], (0, 1))


def test_a_dash_for_a_quantity_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"list\.csv:2:2: quantity: '-' may be none or one: write how many"):
        rows_of(tmp_path / "list.csv", "part;qty;due\na.dxf;-;-\n")


def test_a_workbook_has_parts_and_stock_on_tabs(tmp_path: Path) -> None:
    book = openpyxl.Workbook()
    book.active.append(["Part", "Qty", "Thickness [in]", "Due", "Order", "Grain"])
    book.active.append(["a.dxf", 3.0, 0.25, datetime.datetime(2026, 12, 24), 4711.0, "along"])
    stock = book.create_sheet("store")
    stock.append(["Size", "Stock", "Price", "Remnant", "Thickness"])
    stock.append(["3000 x 1500", 4, 320, "no", 6.35])
    stock.append(["800x600", 1, None, "yes", 6.35])
    stock.append(["2000x1000", 0, 100, "no", 6.35])
    data = io.BytesIO()
    book.save(data)
    (tmp_path / "list.xlsx").write_bytes(data.getvalue())
    found = read_list(tmp_path / "list.xlsx")
    (row,) = found.parts
    assert (row.quantity, row.thickness_mm, row.order, row.grain) == (3, 6.35, "4711", "along")
    assert row.due == datetime.date(2026, 12, 24)
    assert [(s.size, s.stock, s.price, s.remnant) for s in found.sheets] == [
        ("3000x1500", 4, 320.0, False),
        ("800x600", 1, None, True),
    ]


def test_every_wrong_cell_is_told_with_its_place(tmp_path: Path) -> None:
    text = 'part;qty;thickness;due\na.dxf;two;6;\n;3;6;\nb.dxf;1.000;6 mmm;31.2.2026\nc.dxf;1;1/4";\n'
    (tmp_path / "list.csv").write_text(text)
    with pytest.raises(InputError) as caught:
        read_list(tmp_path / "list.csv")
    said = str(caught.value)
    assert "list.csv:2:2: quantity: expected a number, got 'two'" in said
    assert "list.csv:3:1: names no file of a part" in said
    assert "list.csv:4:2: quantity: '1.000' may be 1 or 1000" in said
    assert "list.csv:4:3: thickness: expected a length, got '6 mmm'" in said
    assert "list.csv:4:4: due: there is no such day as '31.2.2026'" in said
    found = read_list(tmp_path / "list.csv", skip_bad=True)
    assert [row.part for row in found.parts] == ["c.dxf"]
    assert [one.name for one in found.bad] == ["a.dxf", "", "b.dxf"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("Bracket;12\n", "no row names the columns"),
        ("qantity;colour\n1;red\n", "did you mean 'quantity'?"),
        ("part;qty\n", "has a head and no rows"),
        ("part;qty;qty\na.dxf;1;2\n", "two columns say quantity: 'qty' and 'qty'"),
        ("part;Dicke;Stärke\na.dxf;1;2\n", "two columns say thickness"),
        ("", "no row names the columns"),
        ("Zeichnung;Menge;Dikce\na.dxf;1;10\n", "column 'Dikce': did you mean 'dicke'?"),
        ("file;quantitty\na.dxf;3\n", "column 'quantitty': did you mean 'quantity'?"),
        ("файл;кол-во;толшина\na.dxf;3;8\n", "column 'толшина': did you mean 'толщина'?"),
        ("file,qty,thickness\na.dxf,2,1,5\n", "the row has 4 cells, the head 3: '5' stands under no column"),
    ],
)
def test_what_is_no_list_is_refused(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(InputError, match=said.replace("?", "\\?")):
        rows_of(tmp_path / "list.csv", text)


def test_columns_that_are_not_read_are_told(tmp_path: Path) -> None:
    """A column that somebody fills in has no effect if nobody knows its word."""
    text = "file;qty;Bemerkung;Sachbearbeiter;;Thick\na.dxf;2;eilig;Meier;;6\nb.dxf;1;;;;;\n"
    (tmp_path / "list.csv").write_text(text)
    found = read_list(tmp_path / "list.csv")
    assert (found.unread, [row.thickness_mm for row in found.parts]) == (("Bemerkung", "Sachbearbeiter"), [6.0, None])


def test_a_broken_workbook_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="not a workbook"):
        rows_of(tmp_path / "list.xlsx", b"PK\x03\x04 nothing")


@pytest.mark.parametrize(
    ("kind", "cell", "value"),
    [
        (length_in, "1 1/2 in", 38.1),
        (length_in, "0,8 мм", 0.8),
        (length_in, 6, 6.0),
        (whole_in, "12 Stk.", 12),
        (whole_in, 12.0, 12),
        (day_in, "2026-12-24", datetime.date(2026, 12, 24)),
        (day_in, "24/12/26", datetime.date(2026, 12, 24)),
        (rank_in, "eilig", 1),
        (rank_in, "3", 3),
        (turns_in, "0;180", (0.0, 180.0)),
        (turns_in, "frei", "any"),
    ],
)
def test_cells_are_read_as_people_write_them(kind: object, cell: object, value: object) -> None:
    assert (kind(cell, 100) if kind is whole_in else kind(cell)) == value  # type: ignore[operator]


@pytest.mark.parametrize("cell", ["3/4/2026", "32.1.2026", "soon", "1.2"])
def test_days_that_could_be_two_or_none_are_refused(cell: str) -> None:
    with pytest.raises(WrongCell):
        day_in(cell)


def test_names_of_files_say_what_the_pattern_says() -> None:
    row = NamePattern("{order}_{part}_{material}_{thickness}mm_{quantity}x*").row("4711_arm_S235_6mm_12x_rev2")
    assert (row.order, row.material, row.thickness_mm, row.quantity) == ("4711", "S235", 6.0, 12)
    with pytest.raises(InputError, match="is not like"):
        NamePattern("{part}_{quantity}x").row("arm")
    with pytest.raises(InputError, match="unknown field 'number'"):
        NamePattern("{part}_{number}")


@pytest.mark.parametrize("name", ["parts.csv", "parts.xlsx"])
def test_the_template_is_a_list_and_is_not_written_over(tmp_path: Path, name: str) -> None:
    ended = kerfwise("nest", "new-list", "-o", tmp_path / name)
    assert ended.code == 0, ended.err
    found = read_list(tmp_path / name)
    assert [row.quantity for row in found.parts] == [12, 40]
    assert found.parts[0].rotations == (0.0, 90.0, 180.0, 270.0)
    if name.endswith(".xlsx"):
        assert isinstance(found.sheets[0], SheetRow)
    assert kerfwise("nest", "new-list", "-o", tmp_path / name).code == 2


def test_a_cell_too_long_for_a_name_is_none() -> None:
    """It was looked through once for each of its brackets: a list of 100 kB took a minute."""
    found = head_of(1, ["part", "quantity", "[" * 1_000_000])
    assert found is not None
    assert found.columns == {0: "part", 1: "quantity"}
