"""The paper's genetic algorithm: recombination, selection, mutation, and its journal."""
