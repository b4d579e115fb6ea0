"""Lines of journals, changed."""

from collections.abc import Iterator

from beamopt.storage.line_journal import with_digest, without_digest

__all__ = ["flipped", "rewritten", "without_digests"]


def flipped(content: bytes) -> Iterator[bytes]:
    """The content with one digit changed into another, for every digit."""
    for place, byte in enumerate(content):
        if 48 <= byte < 58:
            yield content[:place] + bytes([48 + (byte - 47) % 10]) + content[place + 1 :]


def without_digests(journal: bytes) -> bytes:
    """A search's journal as its first version was written."""
    _, *lines = journal.decode().splitlines()
    texts = ['{"schema":"beamopt-journal/1"}', *(str(without_digest(line)) for line in lines)]
    return "".join(text + "\n" for text in texts).encode()


def rewritten(line: str, old: str, new: str) -> str:
    """A whole line with its first `old` replaced by `new`, as if it had been written like that."""
    text = without_digest(line.rstrip("\n"))
    assert text is not None
    assert old in text
    return with_digest(text.replace(old, new, 1)) + "\n"
