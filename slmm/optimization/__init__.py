"""Searches for the best design on a grid of cells, and the problems they are for (Papers C and D)."""

from slmm.optimization.cantilever.beam import Cantilever
from slmm.optimization.problem import Problem
from slmm.optimization.search import SearchResult, search

__all__ = ["Cantilever", "Problem", "SearchResult", "search"]
