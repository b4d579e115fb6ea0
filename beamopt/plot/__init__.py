"""Figures: sections in the paper's colours, workspaces with backbones, convergence."""
