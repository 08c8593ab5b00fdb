"""Readers of programs that nobody here has written: what each makes of a program, told alike."""
