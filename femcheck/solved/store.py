"""Solved results on disk, with a digest of the whole file: what was damaged is never read."""

from __future__ import annotations

import hashlib
import io
import logging
import struct
import zipfile
import zlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from beamopt.storage.input_file import MOST_MESH, read_bytes
from beamopt.storage.writing import write_atomic
from femcheck.continuation.outcome import Statistics, Status

__all__ = ["read_solved", "write_solved"]

T = TypeVar("T")
LOG = logging.getLogger(__name__)
MARK = b"\nblake2b-16 "  # before the digest; files of earlier versions end without

DAMAGED = (
    *(OSError, ValueError, KeyError, EOFError),
    MemoryError,  # an array that the file has no room for
    # headers with a bit turned over: encrypted, compressed, of no size
    *(zipfile.BadZipFile, RuntimeError, SyntaxError, zlib.error, struct.error),
)


def write_solved(
    file: Path,
    digest: str,
    status: Status,
    values: Mapping[str, Any],
    spent: Statistics,
    states: Mapping[str, Any],
) -> None:
    """Write a result of the question that `digest` tells from others.

    values, states : numbers and arrays by name; they stand before and after the statistics.
    """
    times = (spent.seconds, spent.assembly_seconds, spent.factor_seconds, spent.solve_seconds)
    arrays = {
        **{"digest": digest, "status": status.name},
        **values,
        **{"counts": (spent.steps, spent.iterations), "seconds": times},
        **states,
    }
    stream = io.BytesIO()
    np.savez(stream, allow_pickle=False, **arrays)
    content = stream.getvalue()
    write_atomic(file, content + MARK + _digest(content))


def read_solved(
    file: Path, digest: str, convert: Callable[[Status, Statistics, Any], T | None]
) -> T | None:
    """Return what `convert` makes of status, statistics and arrays in a file.

    None where there is no file, or one of another question. A file that is damaged is None too, and
    logged: its result is to be computed again.
    """
    try:
        if not file.exists():
            return None
        content, mark, written = _parts(read_bytes(file, MOST_MESH))
        if mark and written != _digest(content):
            raise ValueError("the digest is of another content")
        with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
            if str(arrays["digest"]) != digest:
                return None
            steps, iterations = arrays["counts"].tolist()
            spent = Statistics(steps, iterations, *arrays["seconds"].tolist())
            return convert(Status[str(arrays["status"])], spent, arrays)
    except DAMAGED as error:
        LOG.warning("%s can not be read, its result is computed again: %s", file, error)
        return None


def _parts(content: bytes) -> tuple[bytes, bytes, bytes]:
    """Arrays, mark and digest; the last two are empty in files of earlier versions."""
    place = len(content) - len(MARK) - len(_digest(b""))
    if place < 0 or content[place : place + len(MARK)] != MARK:
        return content, b"", b""
    return content[:place], MARK, content[place + len(MARK) :]


def _digest(content: bytes) -> bytes:
    return hashlib.blake2b(content, digest_size=16).hexdigest().encode()
