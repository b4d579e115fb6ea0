"""Error against processor time of every model on one question, and the cheapest for an accuracy."""
