"""How exact and how fast the methods are, and where they fail."""
