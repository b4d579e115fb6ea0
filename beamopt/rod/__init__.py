"""What pressure does to the rod: rest strains, and the shape that follows from them."""
