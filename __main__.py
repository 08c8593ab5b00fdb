"""`python -m kerfwise` is the command line."""

from kerfwise.cli import run

if __name__ == "__main__":
    run()
