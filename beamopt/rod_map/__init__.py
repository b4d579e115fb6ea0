"""The stability map of the rod's methods."""
