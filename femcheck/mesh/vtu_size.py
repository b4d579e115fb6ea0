"""Size of what a compressed .vtu unpacks to, measured before a reader unpacks it."""

from __future__ import annotations

import base64
import xml.etree.ElementTree as ElementTree
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from beamopt.base.errors import InputError

__all__ = ["check_unpacked_size"]

ORDERS = {"LittleEndian": "<", "BigEndian": ">"}
SIZES = {"UInt32": "u4", "UInt64": "u8"}
HEAD = 3  # numbers before the sizes of the blocks: how many blocks, their size, that of the last
PIECE = 2**24  # bytes


def check_unpacked_size(file: Path, most: int) -> None:
    """Check that the arrays of a .vtu take no more than a number of bytes.

    A megabyte of zlib may unpack to a gigabyte; blocks are unpacked in pieces, which are not kept.

    most : bytes of all arrays together.

    Raises
    ------
    InputError : they take more; the arrays are not packed as meshio packs them.
    ValueError, ElementTree.ParseError, zlib.error : the file is damaged.
    """
    root = ElementTree.parse(file).getroot()
    packed = root.get("compressor")
    if packed is None:
        return
    if packed != "vtkZLibDataCompressor" or root.find(".//AppendedData") is not None:
        said = "arrays in place, as they are or compressed by vtkZLibDataCompressor"
        raise InputError(file, "compressor", packed, said)
    order = ORDERS[root.get("byte_order", "LittleEndian")]
    header = np.dtype(order + SIZES[root.get("header_type", "UInt32")])
    left = most
    for array in root.iter("DataArray"):
        if array.get("format") == "binary":
            for block in _blocks((array.text or "").strip(), header):
                left -= _size(block, left)
                if left < 0:
                    said = f"arrays of at most {most} bytes ({most // 2**20} MiB) in all"
                    raise InputError(file, "", None, f"unpacks to more: {said}")


def _blocks(text: str, header: np.dtype[Any]) -> Iterator[bytes]:
    """Compressed blocks of an array; their sizes stand before them, encoded by themselves."""
    first = base64.b64decode(text[: _letters(header.itemsize)])[: header.itemsize]
    count = int(np.frombuffer(first, header)[0])
    end = _letters(header.itemsize * (HEAD + count))
    sizes = np.frombuffer(base64.b64decode(text[:end]), header)[HEAD:]
    if len(sizes) != count:
        raise ValueError("the sizes of blocks are cut off")
    packed, place = base64.b64decode(text[end:]), 0
    for size in map(int, sizes):
        yield packed[place : place + size]
        place += size


def _size(block: bytes, most: int) -> int:
    """Bytes that a block unpacks to; of one with more than `most` some number above it."""
    unpacker, size = zlib.decompressobj(), 0
    while block and size <= most:
        size += len(unpacker.decompress(block, PIECE))
        block = unpacker.unconsumed_tail
    return size


def _letters(count: int) -> int:
    """Letters of base64 for a number of bytes."""
    return 4 * -(-count // 3)
