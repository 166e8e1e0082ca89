#!/usr/bin/env python3
"""Writes starry.png: a night sky of swirls and stars, to paint onto a dancer's clothes. Standard library alone."""

import math
import struct
import zlib
from pathlib import Path

SIDE = 192
SWIRLS = [(0.28, 0.34, 0.30), (0.70, 0.42, 0.36), (0.42, 0.78, 0.28), (0.86, 0.84, 0.20)]  # x, y, radius
STARS = [(0.10, 0.12, 0.05), (0.55, 0.10, 0.06), (0.90, 0.14, 0.08), (0.12, 0.62, 0.05), (0.62, 0.66, 0.05),
         (0.20, 0.92, 0.06), (0.68, 0.93, 0.05), (0.40, 0.52, 0.035)]
NIGHT, SKY, FOAM, GOLD = (18, 32, 92), (44, 92, 176), (176, 208, 226), (250, 214, 84)


def mixed(a, b, share):
    return tuple(x + (y - x) * share for x, y in zip(a, b))


def twisted(x, y):
    """The point that a swirl turns to (x, y): by up to a turn in its middle, not at all at its radius. An angle around
    the middle would have a cut."""
    for cx, cy, radius in SWIRLS:
        near = max(0.0, 1 - math.hypot(x - cx, y - cy) / radius)
        turn = 2 * math.pi * near * near
        x, y = (cx + math.cos(turn) * (x - cx) - math.sin(turn) * (y - cy),
                cy + math.sin(turn) * (x - cx) + math.cos(turn) * (y - cy))
    return x, y


def flow_at(x, y):
    x, y = twisted(x, y)
    return y * 9 + 0.6 * math.sin(7 * x)


def colour(x, y):
    band = 0.5 + 0.5 * math.sin(2 * math.pi * flow_at(x, y))
    result = mixed(mixed(NIGHT, SKY, band), FOAM, max(0.0, band - 0.8) * 3.5)
    for cx, cy, radius in STARS:
        glow = max(0.0, 1 - math.hypot(x - cx, y - cy) / radius)
        result = mixed(result, GOLD, min(1.0, 1.8 * glow))
    return result


def png(rows):
    def chunk(kind, data):
        return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))
    header = struct.pack('>IIBBBBB', SIDE, SIDE, 8, 2, 0, 0, 0)
    return (b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', header) + chunk(b'IDAT', zlib.compress(b''.join(rows), 9))
            + chunk(b'IEND', b''))


def main():
    rows = [b'\0' + b''.join(bytes(round(c) for c in colour((x + 0.5) / SIDE, (y + 0.5) / SIDE)) for x in range(SIDE))
            for y in range(SIDE)]
    (Path(__file__).parent / 'starry.png').write_bytes(png(rows))


if __name__ == '__main__':
    main()
