"""The pressurised solid: discretisation, chamber volumes, tip plate, equilibrium."""
