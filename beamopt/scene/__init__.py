"""Scenes and designs, and the keys of their files."""
