"""Readers of the written files that share no code with the writers.

Each returns the integrals of {1, x, y, x², y², xy} over the material and the chambers of supplies
1…3 as an array (4, 6) [mm², mm³, mm⁴]: other programs read the files, and quadrature on triangles
and tetrahedra, not Green's theorem, integrates.
"""
