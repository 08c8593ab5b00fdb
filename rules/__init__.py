"""Rules: facts and a plant's profile become statements; one rule, one file in `catalogue/`."""
