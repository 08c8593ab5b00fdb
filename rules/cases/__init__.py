"""The cases of rules: one module per rule, named as the rule's module in `catalogue/`, with a tuple `CASES`."""
