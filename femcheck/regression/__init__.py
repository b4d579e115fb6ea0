"""What every rung says of a design today, held: baselines, and what has moved since."""
