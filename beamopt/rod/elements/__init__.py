"""Geometrically exact finite elements on SE(3), at a minimum of the potential energy."""
