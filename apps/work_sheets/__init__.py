"""What the operator has on paper beside the machine."""
