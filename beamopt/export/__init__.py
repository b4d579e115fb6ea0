"""A design as files that other programs take: solids to cast or print, a drawing to check."""
