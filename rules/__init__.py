"""Rules: facts and a plant's profile become statements; one rule, one folder in `catalogue/`."""
