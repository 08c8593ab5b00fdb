"""A case larger than any sheet."""

from kerfwise.rule_kit import Case, in_order, nest, part, rect

HUGE = nest(300, 100, part("Bar", rect(90, 10, 79, -1e308)))
CASES = (Case("huge", "boundary", HUGE, in_order(HUGE, "Bar.outer")),)
