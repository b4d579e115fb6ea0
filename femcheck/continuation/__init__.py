"""Finding equilibria: direct solvers, Newton's method, load steps, and how each ended."""
