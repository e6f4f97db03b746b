#!/usr/bin/env python3
"""Reads a profile blend (.kbm), both encodings, with nothing of Parian: see docs/formats.md.

    read_kbm.py FILE.kbm                 prints its header and the sizes of its planes
    read_kbm.py FILE.kbm --profile X,Y   prints ln P at the knots of one pixel, a line per channel
"""

import argparse
import json
import struct
import zlib

import numpy as np
import zstandard


def read_section(data, at):
    size, crc = struct.unpack_from("<QI", data, at)
    payload = data[at + 12:at + 12 + size]
    if len(payload) != size or zlib.crc32(payload) != crc:
        raise ValueError("truncated or damaged section")
    return payload, at + 12 + size


def read_plane(payload, at, count, row, width):
    """Integers of `count` values: filter, length, zstd frame of `width` planes of bytes."""
    kind, size = struct.unpack_from("<BI", payload, at)
    frame = payload[at + 5:at + 5 + size]
    plain = zstandard.ZstdDecompressor().decompress(frame, max_output_size=count * width)
    parts = np.frombuffer(plain, np.uint8).reshape(width, count).astype(np.uint64)
    values = sum(part << np.uint64(8 * b) for b, part in enumerate(parts)).reshape(-1, row)
    if kind == 1:
        values = np.cumsum(values, axis=1, dtype=np.uint64)
    elif kind == 2:
        values = np.cumsum(values, axis=0, dtype=np.uint64)
    return (values & np.uint64(256**width - 1)).astype(np.int64).ravel(), at + 5 + size


def unpack_profiles(payload, header):
    channels, knots, bases = header["channels"], len(header["knots_mm"]), header["bases"]
    count = bases * channels * knots
    values, _ = read_plane(payload, 1, count, count, payload[0])
    steps = np.where(values & 1, -(values >> 1) - 1, values >> 1)  # zigzag
    steps = steps.reshape(channels, knots, bases).transpose(2, 0, 1)
    # From base to base the first knot and the steps between knots are differences.
    levels = np.cumsum(np.cumsum(steps, axis=0), axis=2)
    return (levels * header["profile_step"]).astype(np.float32)


def unpack_indices(payload, header):
    pixels, planes, at = header["width"] * header["height"], [], 0
    for _ in range(header["per_pixel"]):
        plane, at = read_plane(payload, at, pixels, header["width"],
                               1 if header["bases"] <= 256 else 2)
        planes.append(plane)
    return np.array(planes)


def unpack_weights(payload, header):
    pixels, planes, at = header["width"] * header["height"], [], 0
    for _ in range(header["per_pixel"] - 1):
        plane, at = read_plane(payload, at, pixels, header["width"],
                               1 if header["weight_levels"] < 256 else 2)
        planes.append(plane)
    return (np.array(planes) / header["weight_levels"]).astype(np.float32)


def read_blend(path):
    """Header, bases [base][channel][knot], index [k][y][x], weight [k][y][x] with all K, gain and
    dilation [channel][y][x] or None."""
    with open(path, "rb") as file:
        data = file.read()
    if data[:4] != b"KBM1" or struct.unpack_from("<I", data, 4)[0] != 1:
        raise ValueError("not a blend of version 1")
    text, at = read_section(data, 8)
    header = json.loads(text)
    width, height, count = header["width"], header["height"], header["per_pixel"]
    packed = header["encoding"] == "packed"
    payload, at = read_section(data, at)
    bases = (unpack_profiles(payload, header) if packed else np.frombuffer(payload, "<f4").reshape(
        header["bases"], header["channels"], len(header["knots_mm"])))
    payload, at = read_section(data, at)
    index = (unpack_indices(payload, header) if packed else np.frombuffer(
        payload, "<u1" if header["bases"] <= 256 else "<u2")).reshape(count, height, width)
    weight = np.zeros((0, height, width), np.float32)
    if count > 1:
        payload, at = read_section(data, at)
        weight = (unpack_weights(payload, header) if packed else np.frombuffer(
            payload, "<f4")).reshape(count - 1, height, width)
    weight = np.concatenate([weight, np.maximum(0, 1 - weight.sum(axis=0, keepdims=True))])
    planes = {}
    for name in ("gain", "dilation"):
        if header[name]:
            payload, at = read_section(data, at)
            planes[name] = np.frombuffer(payload, "<f4").reshape(-1, height, width)
    if at != len(data):
        raise ValueError("bytes after the last section")
    return header, bases, index, weight, planes.get("gain"), planes.get("dilation")


def log_profiles(bases, index, weight):
    """ln P [channel][knot][y][x] of all pixels, without gain and dilation."""
    return sum(w[..., None, None] * bases[i] for i, w in zip(index, weight)).transpose(2, 3, 0, 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file")
    parser.add_argument("--profile", metavar="X,Y")
    options = parser.parse_args()
    header, bases, index, weight, _, _ = read_blend(options.file)
    if options.profile:
        x, y = map(int, options.profile.split(","))
        for channel in log_profiles(bases, index, weight)[:, :, y, x]:
            print(*(f"{value:.6f}" for value in channel))
    else:
        print(json.dumps(header, indent=1))
        print("bases", bases.shape, "index", index.shape, "weight", weight.shape)


if __name__ == "__main__":
    main()
