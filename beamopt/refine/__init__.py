"""Beyond the genetic algorithm: types by annealing, positions by Gauss-Newton."""
