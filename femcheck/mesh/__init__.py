"""From the outline of a section to a volume mesh with tags."""
