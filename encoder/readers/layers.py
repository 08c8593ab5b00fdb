"""What a drawing's layers are there for: cut, marked, left out, the sheet, scrap, bridges, or tabs."""

from __future__ import annotations

import re
import unicodedata
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal, NamedTuple

from kerfwise.encoder.errors import InputError

Purpose = Literal["ignore", "scrap", "bridge", "tab", "mark", "sheet", "cut"]
PURPOSES: tuple[Purpose, ...] = ("ignore", "scrap", "bridge", "tab", "mark", "sheet", "cut")
"""In the order in which they are tried: `DIM_TEXT` is a dimension, `Plate text` is writing."""


def _words(anywhere: str, starts: str = "", whole: str = "") -> str:
    """A pattern of words: some are sought anywhere in a name, some where a word begins, short ones as a whole word."""
    patterns = anywhere.split()
    patterns += [rf"(?<![^\W\d_])({'|'.join(starts.split())})"] if starts else []
    patterns += [rf"(?<![^\W\d_])({'|'.join(whole.split())})(?![^\W\d_])"] if whole else []
    return "|".join(patterns)


EVERY_LAYER = ".*"
"""The default of `cut`: every layer that nothing else matches."""

IGNORE_WORDS = _words(
    # dimensions, notes and title blocks
    "dimension dim_?(line|text|style) defpoints bema(ß|ss) ma(ß|ss)(linie|kette) cotation acotac wymiar quotatur размер"
    " méret 标注 尺寸 kommentar bemerkung примечан title.?block schriftfeld cartouche штамп water.?mark viewport"
    # what is not seen, and what only helps to draw
    " phantom verdeckt unsichtbar nascost ukryt niewidoczn скрыт невидим rejtett 隐藏"
    " construction construcci costruzione konstruktion(slinie|sgeo) hilfs(linie|geo) pomocnicz построен вспомогат segéd"
    " guide.?line unconsumed schraff hachur tratteggi kreskow штрихов"
    # axes and bends
    " cent(er|re)_?.?(line|mark) mittellinie tengely 中心线 tool.?cent arc.?cent"
    " bend_?.?(line|up|down|extent) abkant kantlinie biege plegado pliegue pliage gięci сгиб гибк hajlít"
    " kantlijn vouwlijn bockning taivutus bükme ohyb d[oó]bra(s|do)? tangent осев 折弯 折り 曲げ"
    " kantung quinagem zetlijn bukkelinj b[øö]yelinj b[øö]jelinj bøjning büküm [îi]ndoire savijanj upogib 절곡 κάμψη"
    " piegatur doblez doblado középvonal hartlijn senterlinj keskiviiv merkez.?çizgi linha.?de.?centro mittelachs"
    " verma(ß|ss)ung kótov poznámk megjegyz dimensjon розмір"
    # what is not to be cut, in so many words
    " (?<![^\\W\\d_])(do.?not|don.?t|not?|never|non|nicht|kein|ne.?pas|nie|nem|niet|ikke|inte|не).?"
    "(to.?be.?)?(cut|schneid|schnitt|tagli|coup|découp|cort|ciąć|cięcie|vág|snij|skär|skjær|рез) uncut",
    "annot adnotac comment hidden",
    "mått mitat kót[ya] maten ölçü"
    " hatch(es|ing)? dims? annos? notes? maße cotes? cotas? quot[ae] ax[ei]s axes? achsen? ejes? ass[ei]"
    " osi[ea]? osy oś ось оси bends? plis? pieg[ah]e? гиб(а|ы|ов)? bukk buiging zetting notas koty ölçüler",
)
SCRAP_WORDS = _words(
    "off.?cut schrott abfall restgitter gitterschnitt trennschnitt d[ée]chet squelette ferraille"
    " chatarra sfrido scarto rottam odpad złom ażur обрез отход решётк решетк hulladék 废料 余料",
    "scrap skeleton waste retal",
    "chutes?",
)
BRIDGE_WORDS = r"^(bridges?|br(ü|ue)cken?|ponts?|puentes?|pont[ei]|mostk?i?|мост(ики|ик|ы)?)$"
"""The whole of a name: parts of a bridge are cut from plates, too."""
TAB_WORDS = (
    r"^(tabs?|micro.?(joint|tab)s?|(mikro|halte).?stege?n?|micro.?attaches?|micro.?(junta|uni[óo]n|giunzion)\w*"
    r"|mikro.?(łącz|zł[ąa]cz)\w*|микро.?(перемычк|соединен)\w*|перемычк\w*)$"
)
"""The whole of a name: a label, and a part, may be a tab as well."""
MARK_WORDS = _words(
    "engrav gravur grav[ií]r gravure laser.?(etch|mark|text|scrib) v.?score cent(er|re).?punch"
    " beschrift signier anr(ei|i)(ß|ss) k(ö|oe)rn(er|ung|punkt) ritzen ritzlinie pointage grabado grabar rotul"
    " incisione incidere graw(er|ir) trasow znakow маркир разметк гравир надпис felirat pontoz kazıma oyma bohrmark"
    " 刻 打标 标记 文字 각인 χάραξη vésés kaiverr merkint ryt[ií](?![a-z]) oznaczen märkning merking markering"
    " inskription punktmarkier laserschrift incision[ie] scritt[ae] szöveg marcaç oznak işaret",
    "grav(?!el|it) bulin napis znaczen znač popis керн грав",
    "mark(s|ing|ings|ed|er|ierung|ierungen|ieren)? marc(a|as|ado|ados|aje|ar|atura|ature)? marqu(e|es|age|er|é)"
    " etch(ed|es|ing|ings)? scrib(e|es|ed|ing) texts? texte texto testo teksty? текст(ы|а)? label(s|led|ling)?"
    " lettering pricks? jel jelöl[a-zé]* znaki? opisy? schrift(en)? signatur kazı etiquetas?",
)
DOUBTFUL: tuple[tuple[tuple[Purpose, ...], str], ...] = (
    (
        ("ignore", "mark", "cut"),
        _words(
            "f[üu]hrungslinie hulplijn hintergrund passermark registration feature.?profile gewinde senkung"
            " countersink counter.?bore konstruk[ct] koordinat nullpunkt 背景 ねじ ansenk knicklinie falzlinie"
            " parts.?list st(ü|ue)ckliste (zeichnungs|zeichen|drawing|title).?(rahmen|frame) schutzfolie"
            " schwei(ß|ss)n[aä]h сварк",
            "hilfs background reference thread tapp silhouett",
            "folds? folding folded falt(en|ung|linien?)? biegung creas(e|es|ed|ing) guides? gu[ií]as? guida"
            " ref csk fond sfondo tło фон print(s|ed|ing)? druck bleed artboard unused old backup trash temp origin"
            " coordinates? revision резьба gwint filet(age|ti) bom grids? isometric(s|h)? views? ansicht(en)?"
            " weld(s|ing)? soudure saldatur[ae] soldadura spaw(y|anie)? folie films? mask(e|en|s|ing)?",
        ),
    ),
    (
        ("mark", "cut", "ignore"),
        _words(
            "perforation rycin v.?groove k[oö]rn(en|ung) data.?matrix"
            " part.?(no|nr|numbers?)(?![^\\W\\d_]) kiss.?cut half.?cut halb.?schnitt half.?tone",
            "",
            "scor(e|es|ed|ing) raster logos? stamp(s|ed|ing)? punch(es|ed|ing)? drill(s|ed|ing)?(.?cent(er|re)s?)?"
            " perf ritz stanz(en|ung|ungen)? nr nummern? numbers? ids? bar.?codes? qr",
        ),
    ),
)
"""What names of layers may be for, the likeliest first, that may as well be those of parts or of holes."""
SHEET_WORDS = _words(
    # a Grundplatte, a base plate in one word, is a part
    "remnant blech tafel rohteil rohmaterial лист t[ôö]le chapa plancha"
    " l[áa]mina placa plåt 원판 lamiera lastra foglio arkusz blach lemez tábla tabule plech 板材 钢板",
    "sheet pla(te|tte|at) stock",
    "toles? plade plaka levy",
)


def _set(words: str) -> frozenset[str]:
    return frozenset(words.split())


_SHEET = _set(
    "sheet sheets stock remnant remnants arkusz лист листы foglio tabule tábla"
    " tafel tafeln rohtafel blechtafel resttafel rohblech restblech rohmaterial"
)
_OF_A_SHEET = _set(
    "outer contour outline border boundary edge frame size area layer the of nest nesting raw material umriss rand"
    " kontur rahmen x w h mm"
)
_CUT = _set(
    "cut cuts cutting outer inner outline outlines contour contours kontur konturen profile profiles hole holes schnitt"
    " ausschnitt coupe découpe corte cortes taglio cięcie контур контуры резка vágás kivágás"
)


def surely_sheet(name: str) -> bool:
    """Whether a name means the sheet and nothing else; PLATE, Blech or SHEET METAL PART name parts as often.

    Examples
    --------
    >>> surely_sheet("Sheet_Outline 1"), surely_sheet("PLATE"), surely_sheet("SHEET METAL PART")
    (True, False, False)
    """
    words = set(re.findall(r"[^\W\d_]+", _in_words(name).lower()))
    return bool(words & _SHEET) and words <= _SHEET | _OF_A_SHEET


def doubtful(names: Sequence[str]) -> tuple[Purpose, ...]:
    """What a layer is for, the likeliest first, where its names do not tell whether it is cut; () where they do.

    Of the names, outermost first, the innermost decides that says anything.

    Examples
    --------
    >>> doubtful(["Score lines"]), doubtful(["THREADS", "cut"]), doubtful(["Scoreboard"])
    (('mark', 'cut', 'ignore'), (), ())
    """
    for name in reversed(names):
        order = next((order for order, pattern in DOUBTFUL if _found(pattern, _in_words(name))), ())
        if order or surely_cut(name):
            return order
    return ()


def surely_cut(name: str) -> bool:
    """Whether a name says that what is drawn there is cut.

    Examples
    --------
    >>> surely_cut("CUT_OUTER"), surely_cut("Kontur 2"), surely_cut("0")
    (True, True, False)
    """
    return bool(set(re.findall(r"[^\W\d_]+", _in_words(name).lower())) & _CUT)


class Use(NamedTuple):
    """What a layer is for; None where `cut` is given and nothing matches. `stated` if a plant's own pattern says so."""

    purpose: Purpose | None
    stated: bool


@dataclass(frozen=True, slots=True)
class Layers:
    """Which layers (DXF) or groups (SVG) hold what: a regular expression each, searched without regard to case.

    A pattern that is not the default is a plant's own, and is tried before all defaults. Among a plant's own, and among
    the defaults, the order is that of `PURPOSES`. Raises InputError for a pattern that is no regular expression.

    Examples
    --------
    >>> layers = Layers(mark="^7$")
    >>> [layers.use(["7"]).purpose, layers.use(["Bemaßung"]).purpose, layers.use(["Kontur"]).purpose]
    ['mark', 'ignore', 'cut']
    """

    cut: str = EVERY_LAYER
    mark: str = MARK_WORDS
    ignore: str = IGNORE_WORDS
    sheet: str = SHEET_WORDS
    scrap: str = SCRAP_WORDS
    bridge: str = BRIDGE_WORDS
    tab: str = TAB_WORDS

    def __post_init__(self) -> None:
        for purpose in PURPOSES:
            pattern = getattr(self, purpose)
            try:
                re.compile(pattern)
            except re.error as error:
                raise InputError(f"layers.{purpose} '{pattern}' is not a regular expression: {error}") from None

    def use(self, names: Sequence[str]) -> Use:
        """What the innermost of these names says of which any pattern knows; the names are given outermost first."""
        named = [p for p in PURPOSES if getattr(self, p) != getattr(DEFAULT, p)]
        defaults = [p for p in PURPOSES if p not in named and p != "cut"]
        for name in reversed(names):
            for purpose in (*named, *defaults):
                if _found(getattr(self, purpose), name if purpose in named else _in_words(name)):
                    return Use(purpose, purpose in named)
        return Use(None if "cut" in named else "cut", False)


DEFAULT = Layers()


@lru_cache(maxsize=4096)
def _found(pattern: str, name: str) -> bool:
    return re.search(pattern, unicodedata.normalize("NFC", name), re.IGNORECASE) is not None


@lru_cache(maxsize=4096)
def _in_words(name: str) -> str:
    """A name with its words apart that are written as one, as in EtchLines.

    Examples
    --------
    >>> _in_words("EtchLines"), _in_words("DIM_TEXT"), _in_words("CAMText")
    ('Etch Lines', 'DIM_TEXT', 'CAM Text')
    """
    text = unicodedata.normalize("NFC", name)
    apart = []
    for k, sign in enumerate(text):
        begins = sign.isupper() and (text[k - 1].islower() or (text[k - 1].isupper() and text[k + 1 : k + 2].islower()))
        apart.append(f" {sign}" if k and begins else sign)
    return "".join(apart)


def setting(purpose: Purpose, *layers: str) -> str:
    """The line of a profile that says what layers are for, as it stands in a message.

    Examples
    --------
    >>> print(setting("mark", "Gravír 2"))
    drawing: {layers: {mark: '^Gravír 2$'}}
    >>> print(setting("cut", "HOLES", "OUTER (new)"))
    drawing: {layers: {cut: '^(HOLES|OUTER \\(new\\))$'}}
    """
    names = [re.sub(r"([.^$*+?{}\[\]\\|()])", r"\\\1", layer).replace("'", "''") for layer in sorted(set(layers))]
    pattern = names[0] if len(names) == 1 else f"({'|'.join(names)})"
    return f"drawing: {{layers: {{{purpose}: '^{pattern}$'}}}}"


def counted(layers: Iterable[str], most: int = 8) -> str:
    """How many lines are on which layer, by name.

    Examples
    --------
    >>> counted(["DIM", "0", "DIM"])
    "1 on '0', 2 on 'DIM'"
    """
    count = Counter(layers)
    shown = [f"{count[name]} on '{name}'" for name in sorted(count)[:most]]
    return ", ".join([*shown, *([f"… and {len(count) - most} more layers"] if len(count) > most else [])])
