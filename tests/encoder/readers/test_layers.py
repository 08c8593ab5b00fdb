"""What a layer's name says, in the languages of shops, and what a plant's own words change."""

import pytest

from kerfwise import InputError
from kerfwise.encoder.readers.layers import DEFAULT, Layers, Use, counted, doubtful, setting, surely_sheet

NAMES = {
    "mark": "Engraving SCRIBE ETCH Part_Text Gravur Körnerpunkte Beschriftung Anriss Gravure Marquage Grabado Marcado"
    " Rotulado Incisione Marcatura Testo Grawerowanie Trasowanie Napisy Гравировка Маркировка Разметка Текст Керн"
    " Gravír Gravir Jel Jelölés LaserEtch Top-Text LASERMARK Vésés Szöveg Kaiverrus Merkintä Merking Märkning Markering"
    " Rytí Opis Oznaka Znak Scritte Marcação Schrift Laserschrift Punktmarkierung 각인",
    "ignore": "DIM DIM2 DIMLINES BENDLINES A-ANNO Annotation Defpoints HIDDEN Construction CENTER_LINE CenterLine Axis"
    " IV_BEND IV_TOOL_CENTER Bemaßung Bemassung Maßlinie Hilfslinien Mittellinie Biegelinien Verdeckt Cotation Cotes"
    " Axes Pli Cotas Plegado Oculta_dims Wymiary Osie Pomocnicze Quote Assi Pieghe Размеры Оси Осевые Гибка"
    " Вспомогательная Méret Hajlítás watermark DIM_TEXT Titleblock Schraffuren HATCH Zetlijn Buiging Bockning"
    " Bukkelinje Bøjning Kantung Quinagem Doblez Piegatura Savijanje Upogib Îndoire Büküm"
    " Линии_гиба 절곡 Hartlijn Senterlinje Osy Középvonal Vermassung Kótovanie Megjegyzés Notas Koty Розміри",
    "sheet": "SHEET PLATE_2 Platte Stock Remnant Blech Blechtafel Rohteil Tôle TOLE Chapa Lámina Lamiera Lastra Blacha"
    " Arkusz Лист Lemez Plåt Plaka Placa",
    "scrap": "Scrap OFFCUT Off-cut Skeleton Schrott Abfall Restgitter Chute Déchets Chatarra Sfrido Odpad Złom Отходы"
    " Обрезь",
    "cut": "0 CUT OUTER HOLES Contour Kontur Außenkante Schnitt Bohrungen Découpe Corte Taglio Cięcie Контур Резка"
    " Template BASEPLATE Grundplatte Dimple Sediment Hatchback Corner Score Jelly Notch Layer_1"
    " CuttingLine IV_OUTER_PROFILE Punching Sketch001 Structure Texture Extrude Stretch MARCO Marcos Context Gravel"
    " Cannot Denmark Benchmark Describe Osa",
}


@pytest.mark.parametrize(("purpose", "name"), [(p, n) for p, names in NAMES.items() for n in names.split()])
def test_names_as_shops_write_them(purpose: str, name: str) -> None:
    for written in (name, name.lower(), name.upper()):
        assert DEFAULT.use([written]) == Use(purpose, False), written  # type: ignore[arg-type]


ASKED = {
    "mark": "Score Scoring Punch Drill Stanzen PERF Perforation Ritz Körnen V-groove Nummern Nr ID Barcode QR"
    " part_number",
    "ignore": "Gewinde Senkung Ansenken Knicklinie Falzlinie Fold Stückliste BOM Zeichnungsrahmen Grid VIEW Ansicht"
    " Schweißnaht Weld Soudure Schutzfolie Folie Mask",
}


@pytest.mark.parametrize(("first", "name"), [(first, n) for first, names in ASKED.items() for n in names.split()])
def test_names_of_lines_that_may_not_be_cut_are_doubtful(first: str, name: str) -> None:
    for written in (name, name.lower(), name.upper()):
        assert doubtful([written])[:1] == (first,), written
        assert doubtful([written, "Kontur"]) == ()


@pytest.mark.parametrize("name", ["Idler", "Viewer", "Gridley", "Punchline", "Nrs", "Welder"])
def test_names_of_parts_are_not_doubtful(name: str) -> None:
    assert doubtful([name]) == ()


@pytest.mark.parametrize("name", ["EtchLines", "PartText", "myDIM", "TopEtch2"])
def test_words_written_as_one_are_told_apart_by_their_capitals(name: str) -> None:
    assert DEFAULT.use([name]).purpose in ("mark", "ignore")


@pytest.mark.parametrize(
    ("name", "sure"),
    [(name, True) for name in ("SHEET", "Sheet 1", "Stock", "Blechtafel", "Лист", "sheet_outline", "Sheet 3000x1500")]
    + [
        (name, False)
        for name in ("PLATE", "SHEET METAL PART", "Blechteil", "Tole", "Lámina", "base_plate", "ЛИСТ_КРЫШКИ")
    ],
)
def test_some_names_mean_the_sheet_and_nothing_else(name: str, sure: bool) -> None:
    assert surely_sheet(name) == sure


def test_an_accent_written_as_a_sign_of_its_own_is_the_same_letter() -> None:
    assert Layers(mark="gravír").use(["Gravi\u0301r"]).purpose == "mark"


def test_a_plants_own_pattern_comes_before_every_default() -> None:
    layers = Layers(cut="^Plate cut$", mark="^7$")
    assert layers.use(["Plate cut"]) == Use("cut", True)
    assert layers.use(["7"]) == Use("mark", True)
    assert layers.use(["DIM"]) == Use("ignore", False)


def test_once_a_plant_says_what_is_cut_nothing_else_is() -> None:
    assert Layers(cut="^0$").use(["OUTER"]) == Use(None, False)


def test_the_innermost_name_decides() -> None:
    assert DEFAULT.use(["Sheet 1", "Gravur"]).purpose == "mark"
    assert DEFAULT.use(["Gravur", "rings"]).purpose == "mark"
    assert Layers(cut="^job$").use(["job", "Gravur"]).purpose == "mark"
    assert Layers(cut="^job$").use(["job", "rings"]) == Use("cut", True)


@pytest.mark.parametrize("name", ["a.b(c)[d]{e}^$|*+?\\", "it's", "Gravír 2", "0"])
def test_what_a_message_says_of_a_layer_is_right_for_that_layer_alone(name: str) -> None:
    import yaml

    said = yaml.safe_load(setting("scrap", name))
    layers = Layers(**said["drawing"]["layers"])
    assert layers.use([name]) == Use("scrap", True)
    assert layers.use([f"{name}x"]).purpose != "scrap"


def test_a_wrong_pattern_is_named() -> None:
    with pytest.raises(InputError, match=r"^layers.mark '\(' is not a regular expression: "):
        Layers(mark="(")


def test_a_long_list_of_layers_is_cut_short() -> None:
    assert counted([str(k) for k in range(9)], most=2) == "1 on '0', 1 on '1', … and 7 more layers"


@pytest.mark.parametrize("name", ["Tabelle", "Stable", "label tab", "TABLE"])
def test_other_words_are_no_tabs(name: str) -> None:
    assert Layers().use([name]).purpose != "tab"
