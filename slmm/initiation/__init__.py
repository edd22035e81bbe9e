"""Crack initiation by the coupled criterion (Paper A)."""
