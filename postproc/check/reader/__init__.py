"""The reader of the check: what a control would do with a program, read without the writer's help."""
