"""From a list of parts to nests: which sheet each part lies on, where, and how it is turned."""
