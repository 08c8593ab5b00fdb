"""The model files in MiniZinc: the rules stated once more, over facts, as rule authors read and edit them."""
