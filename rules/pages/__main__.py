"""`python -m kerfwise.rules.pages > docs/rules.md`: the pages of all rules."""

import sys

from .pages import all_pages

if __name__ == "__main__":
    sys.stdout.write(all_pages())
