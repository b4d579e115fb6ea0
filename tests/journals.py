"""Lines of journals, changed."""

from beamopt.line_journal import with_digest, without_digest

__all__ = ["rewritten"]


def rewritten(line: str, old: str, new: str) -> str:
    """A whole line with its first `old` replaced by `new`, as if it had been written like that."""
    text = without_digest(line.rstrip("\n"))
    assert text is not None
    assert old in text
    return with_digest(text.replace(old, new, 1)) + "\n"
