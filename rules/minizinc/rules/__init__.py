"""The rules in MiniZinc: a model file each, and beside it what that needs besides the facts."""
