"""Folders of results as one page that opens from disk: verdicts, figures, models that turn."""
