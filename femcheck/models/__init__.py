"""One question, every model: tips of a design at its pressures, with a status and a cost."""
