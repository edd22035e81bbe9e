"""The algorithms: each asks for the values of designs, see `slmm.optimization.ask`."""
