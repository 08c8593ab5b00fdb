"""Judging: plain geometry that tells whether a finished order keeps a rule; nothing here knows facts or statements."""
