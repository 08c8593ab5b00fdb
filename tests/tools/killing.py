"""A kill at a given moment, as the text of a program that a test runs in a process of its own."""

from __future__ import annotations

COUNTED = """
import os, signal, sys
moment, count = int(sys.argv.pop(1)), 0
def counted(call):
    def then(*args, **named):
        global count
        count += 1
        if count == moment:
            os.kill(os.getpid(), signal.SIGKILL)
        return call(*args, **named)
    return then
"""
"""Takes the moment from the command line; of all calls that are `counted`, the one with that number is never made."""
