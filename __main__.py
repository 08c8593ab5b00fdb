"""`python -m kerfwise` is the command line."""

from kerfwise.cli import main

if __name__ == "__main__":
    main()
