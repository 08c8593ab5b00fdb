"""Options: the kinds of value a profile can hold, and how they are read from YAML with line and column."""
