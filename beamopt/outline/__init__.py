"""A section as polygons that a person could cut: sealed, smooth, checked, meshed from."""
