"""The catalogue: one rule, one module. A new module is found by itself."""
