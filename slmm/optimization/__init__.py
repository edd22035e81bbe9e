"""Searches for the best design on a grid of cells, and the problems they are for (Papers C and D)."""

from slmm.optimization.cantilever.beam import Cantilever
from slmm.optimization.hole_patterns.problem import HolePattern
from slmm.optimization.problem import Bound, Problem, Value
from slmm.optimization.search import SearchResult, search

__all__ = ["Bound", "Cantilever", "HolePattern", "Problem", "SearchResult", "Value", "search"]
