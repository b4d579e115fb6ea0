"""How low the loss can be at all, whatever the cross-section."""
