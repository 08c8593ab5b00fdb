"""Measures engines on nests and on the field's routing instances."""
