"""Writes a PNG picture with a palette of 256 colours, which has a third of the bytes and looks the same.

python3 tools/shrink_png.py FROM.png TO.png [DISTANCE]       (needs numpy)

Colours of the palette differ by at least 12 steps of 255, or by DISTANCE, which may be smaller for pictures with fine shades.

Reads PNG files as realgap writes them: 8 bits per channel, RGB, not interlaced.
"""

import struct
import sys
import zlib

import numpy


def read(path):
    data = open(path, "rb").read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", f"{path} is no PNG"
    at, packed = 8, b""
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        kind, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height, *rest = struct.unpack(">IIBBBBB", body)
            assert rest[:2] == [8, 2] and rest[4] == 0, f"{path}: 8 bit RGB only"
        elif kind == b"IDAT":
            packed += body
        at += length + 12
    rows = numpy.frombuffer(zlib.decompress(packed), numpy.uint8).reshape(height, -1)
    picture = numpy.zeros((height, width, 3), numpy.uint8)
    above = numpy.zeros((width, 3), int)
    for y, row in enumerate(rows):
        raw, now = row[1:].reshape(width, 3).astype(int), None
        if row[0] == 0:
            now = raw
        elif row[0] == 1:
            now = numpy.cumsum(raw, axis=0)
        elif row[0] == 2:
            now = raw + above
        else:
            now, left, corner = numpy.zeros((width, 3), int), numpy.zeros(3, int), numpy.zeros(3, int)
            for x in range(width):
                if row[0] == 3:
                    guess = (left + above[x]) // 2
                else:
                    to = left + above[x] - corner
                    far = numpy.abs([to - left, to - above[x], to - corner])
                    guess = numpy.choose(numpy.argmin(far, axis=0), [left, above[x], corner])
                left = now[x] = (raw[x] + guess) % 256
                corner = above[x]
        above = now % 256
        picture[y] = above
    return picture


def palette(picture, least):
    """The eight most frequent colours, then others that differ by at least `least`, and for each pixel the nearest of them."""
    flat = picture.reshape(-1, 3)
    colours, index, count = numpy.unique(flat, axis=0, return_inverse=True, return_counts=True)
    colours, kept = colours.astype(int), []
    for apart in (least, 12, 24, 48):
        kept = []
        for one in numpy.argsort(-count, kind="stable"):
            if len(kept) < 8 or all(abs(colours[one] - other).max() >= apart for other in kept):
                kept.append(colours[one])
                if len(kept) > 256:
                    break
        if len(kept) <= 256:
            break
    kept = numpy.array(kept[:256])
    near = [((kept - colour) ** 2).sum(axis=1).argmin() for colour in colours]
    return kept, numpy.array(near, numpy.uint8)[index.reshape(-1)].reshape(picture.shape[:2])


def write(path, colours, indices):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    height, width = indices.shape
    rows = numpy.hstack([numpy.zeros((height, 1), numpy.uint8), indices]).tobytes()
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        file.write(chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)))
        file.write(chunk(b"PLTE", colours.astype(numpy.uint8).tobytes()))
        file.write(chunk(b"IDAT", zlib.compress(rows, 9)))
        file.write(chunk(b"IEND", b""))


if __name__ == "__main__":
    write(sys.argv[2], *palette(read(sys.argv[1]), int((sys.argv[3:] or [12])[0])))
