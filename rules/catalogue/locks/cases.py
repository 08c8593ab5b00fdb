"""Cases of rule locks."""

from dataclasses import replace

from kerfwise.encoder.cut import CutSequence
from kerfwise.rules.case import Case, cut, in_order, nest, part, rect
from kerfwise.rules.catalogue.locks import LocksOptions
from kerfwise.rules.judging.violation import Violation
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.yaml_positions import Place

ROW = nest(
    400, 100, part("A", rect(10, 10, 60, 80)), part("B", rect(80, 10, 60, 80)), part("C", rect(150, 10, 60, 80))
)  # fmt: skip
ABC = in_order(ROW, "A.outer B.outer C.outer")


def locked(*locks: Lock) -> LocksOptions:
    return LocksOptions(locks=locks)


def fails(name: str, lock: Lock, cuts: CutSequence, contours: tuple[str, ...], text: str, *at: int) -> Case:
    violation = Violation("locks", contours, f"{text}: locked by the operator", at)
    return Case(name, "fails", ROW, cuts, (violation,), locked(lock))


CASES = (
    Case(
        "all as locked",
        "passes",
        ROW,
        in_order(ROW, "A.outer B.outer C.outer", zones={"A": 1, "B": 1, "C": 2}),
        options=locked(
            Lock(contour="A.outer", before="C.outer", position="first", entry=(10, 10), direction="cw"),
            Lock(contour="B.outer", position=2),
            Lock(contour="C.outer", position="last"),
            Lock(part="C", zone=2),
        ),
    ),
    fails(
        "before",
        Lock(contour="C.outer", before="A.outer"),
        ABC,
        ("C.outer", "A.outer"),
        "C.outer (cut 3) must be cut before A.outer (cut 1)",
        3,
        1,
    ),
    fails(
        "first", Lock(contour="B.outer", position="first"), ABC, ("B.outer",), "B.outer is cut 2 in order, not first", 2
    ),
    fails(
        "last", Lock(contour="B.outer", position="last"), ABC, ("B.outer",), "B.outer is cut 2 in order, not last", 2
    ),
    fails("third", Lock(contour="B.outer", position=3), ABC, ("B.outer",), "B.outer is cut 2 in order, not last", 2),
    fails(
        "position 1 is first",
        Lock(contour="B.outer", position=1),
        ABC,
        ("B.outer",),
        "B.outer is cut 2 in order, not first",
        2,
    ),
    fails(
        "entry",
        Lock(contour="A.outer", entry=(70, 50)),
        ABC,
        ("A.outer",),
        "A.outer (cut 1) is entered at (10, 10), not at (70, 50)",
        1,
    ),
    fails(
        "direction",
        Lock(contour="A.outer", direction="ccw"),
        ABC,
        ("A.outer",),
        "A.outer (cut 1) is cut cw, not ccw",
        1,
    ),
    Case("pierced, as it must be", "passes", ROW, ABC, options=locked(Lock(contour="B.outer", linked=False))),
    fails(
        "linked",
        Lock(contour="B.outer", linked=False),
        CutSequence((ABC[0], replace(ABC[1], linked=True), ABC[2])),
        ("B.outer",),
        "B.outer (cut 2) is linked with the cut before, not pierced",
        2,
    ),
    fails(
        "zone",
        Lock(part="B", zone=1),
        in_order(ROW, "A.outer B.outer C.outer", zones={"A": 1, "B": 2, "C": 2}),
        ("B.outer",),
        "B.outer (cut 2) is in zone 2, not in zone 1",
        2,
    ),
    Case("no zones are stated", "boundary", ROW, ABC, options=locked(Lock(part="B", zone=1))),
    Case(
        "an entry within the tolerance of the locked point is it",
        "boundary",
        ROW,
        CutSequence((cut(ROW, "A.outer", entry=(10.4, 10)),)),
        options=locked(Lock(contour="A.outer", entry=(9, 10))),
    ),
    Case(
        "an entry beyond the tolerance is not; the message says where the lock stands",
        "boundary",
        ROW,
        CutSequence((cut(ROW, "A.outer", entry=(10.6, 10)),)),
        (
            Violation(
                "locks",
                ("A.outer",),
                "A.outer (cut 1) is entered at (10.6, 10), not at (10, 10): locked by the operator (plant.yaml:7:5)",
                (1,),
            ),
        ),
        options=locked(Lock(contour="A.outer", entry=(10, 10), place=Place("plant.yaml", 7, 5))),
    ),
)
