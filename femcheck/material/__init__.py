"""Hyperelastic laws, one class each."""
