"""Check a beam-optimised section as a solid: volume mesh, hyperelastic, under pressure."""
