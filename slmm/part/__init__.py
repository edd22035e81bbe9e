"""Geometry alone: outlines of parts and notches, from shapes, points and pictures."""
