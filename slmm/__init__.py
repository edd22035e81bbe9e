"""Crack initiation at arbitrary 2D notches: will a crack start, at which load, and where."""

__version__ = "0.1.0"
