"""Stating: facts and a profile become the statements that must hold, contradictions among orders resolved."""
