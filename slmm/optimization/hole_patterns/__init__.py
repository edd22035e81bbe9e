"""Patterns of holes that make a plate tough (Paper D)."""
