"""What a design of a real material does: which pressures it stands, and how far the beam is off."""
