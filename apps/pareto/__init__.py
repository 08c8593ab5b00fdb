"""Trades idle travel against overheats: a front of plans."""
