"""Notch outlines: spline, curvature, picture to outline."""
