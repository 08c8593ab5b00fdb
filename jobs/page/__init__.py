"""The page of a plan, or of two: all that is known of it, gathered for the browser.

`page` asks for most of the package, and `picture` only for what a drawing takes: nothing is imported here.
"""
