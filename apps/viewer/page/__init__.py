"""The page of a plan: one file for the browser."""
