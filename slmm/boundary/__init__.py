"""Boundary integrals: plane elasticity on the outlines alone, cracks as lines of displacement jump."""
