"""The problem: statements compiled to sites, moves and conditions, and the plain reference that judges a route."""
