"""Pictures that the programs write, without other libraries."""

import struct
import zlib


def read_png(path):
    """Width, height and the rows of RGB codes; 8 bits, not interlaced."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            width, height, bits, color = struct.unpack(">IIBB", data[at + 8:at + 18])
            assert (bits, color) == (8, 2), f"{path}: expected RGB of 8 bits"
        elif kind == b"IDAT":
            packed += data[at + 8:at + 8 + size]
        at += size + 12
    flat, rows, above = zlib.decompress(packed), [], bytes(3 * width)
    for y in range(height):
        start = y * (3 * width + 1)
        above = undo_filter(flat[start], bytearray(flat[start + 1:start + 1 + 3 * width]), above)
        rows.append(bytes(above))
    return width, height, rows


def undo_filter(kind, row, above):
    for i in range(len(row) if kind else 0):
        a, b, c = (row[i - 3], above[i], above[i - 3]) if i > 2 else (0, above[i], 0)
        if kind == 1:
            guess = a
        elif kind == 2:
            guess = b
        elif kind == 3:
            guess = (a + b) >> 1
        else:
            p, q, r = abs(b - c), abs(a - c), abs(a + b - 2 * c)
            guess = a if p <= q and p <= r else b if q <= r else c
        row[i] = (row[i] + guess) & 255
    return row


def mean_difference(path, other):
    """Of the codes of two pictures of one size."""
    (width, height, rows), (other_width, other_height, other_rows) = read_png(path), read_png(other)
    assert (width, height) == (other_width, other_height), f"{path} and {other} differ in size"
    total = sum(abs(a - b) for row, of in zip(rows, other_rows) for a, b in zip(row, of))
    return total / (3 * width * height)
