"""Sums over elements and wall facets: compiled kernels, and the pattern they write to."""
