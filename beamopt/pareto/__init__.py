"""Several objectives at once: designs of which none is better than another in all of them."""
