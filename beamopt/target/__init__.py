"""Targets: workspaces, tables of points, trajectories."""
