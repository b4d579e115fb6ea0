"""Finding equilibria: direct solver, Newton's method, load steps, predictors, and how each ended."""
