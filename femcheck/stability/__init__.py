"""Maps of where silicone actuators have an equilibrium, and where the beam is right about it."""
