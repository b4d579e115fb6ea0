"""What a cross-section is: polar grid, Voronoi feature points, walls, moments, pieces."""
