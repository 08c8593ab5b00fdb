"""Physics: how long a program takes, and how hot it makes the sheet."""
