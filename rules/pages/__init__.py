"""Pages: what every rule says of itself, as documentation, and the files that a new rule starts from."""
