"""From a list of parts to nests: reading the list, laying the parts, the check, what is written."""
