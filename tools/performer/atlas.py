"""The base-colour texture: where each garment lies in it and how it is painted."""
import math
import struct
import zlib

from vectors import smoothstep

SIZE = 1024
MARGIN = 6  # texels painted beyond a chart, so that mip levels do not mix neighbours


class Chart:
    """A rectangle of the texture: u runs right, v down; `width_m` and `height_m` are its size on the body."""

    def __init__(self, x, y, w, h, width_m, height_m, paint):
        self.x, self.y, self.w, self.h = x + MARGIN, y + MARGIN, w - 2 * MARGIN, h - 2 * MARGIN
        self.width_m, self.height_m, self.paint = width_m, height_m, paint

    def uv(self, u, v):
        return ((self.x + 0.5 + u * (self.w - 1)) / SIZE, (self.y + 0.5 + v * (self.h - 1)) / SIZE)


def mix(a, b, t):
    """Of two colours."""
    if t <= 0:
        return a
    if t >= 1:
        return b
    return (a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t)


def band(x, period, centre, half, soft=0.0012):
    """1 inside a stripe that repeats, 0 outside, with soft edges (metres)."""
    d = abs((x - centre + period / 2) % period - period / 2)
    return 1 - smoothstep(half - soft, half + soft, d)


def disc(x, y, radius, soft=0.0012):
    return 1 - smoothstep(radius - soft, radius + soft, math.hypot(x, y))


def star(x, y, radius):
    angle = (math.atan2(x, y) + math.pi / 5) % (2 * math.pi / 5) - math.pi / 5
    along, across = math.hypot(x, y) * math.cos(angle), math.hypot(x, y) * abs(math.sin(angle))
    edge = along * 0.55 + across * 1.05 - radius * 0.55
    return 1 - smoothstep(-0.0015, 0.0015, edge)


def line(x, y, x0, y0, x1, y1, half):
    dx, dy = x1 - x0, y1 - y0
    t = min(1.0, max(0.0, ((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy)))
    return disc(x - x0 - t * dx, y - y0 - t * dy, half)


RED, NAVY, CREAM, GOLD = (188, 44, 46), (38, 44, 92), (240, 228, 200), (242, 190, 60)
DENIM, PALE, ORANGE, OLIVE = (52, 84, 138), (170, 192, 216), (232, 122, 40), (96, 104, 56)
SKIN, HAIR, WHITE, BLACK = (226, 168, 134), (78, 46, 26), (244, 244, 240), (28, 26, 30)


def tartan(x, y, period):
    colour = RED
    for along in (x, y):
        colour = mix(colour, NAVY, 0.55 * band(along, period, 0.25 * period, 0.22 * period))
        colour = mix(colour, CREAM, 0.70 * band(along, period, 0.75 * period, 0.0030))
    return colour


def paint_shirt(u, v):
    x, y = (u - 0.5) * 0.96, v * 0.63  # x from the middle of the front, y from the hem up
    colour = tartan(x, y, 0.06)
    colour = mix(colour, CREAM, 1 - smoothstep(0.016, 0.018, abs(x)))  # the button strip
    colour = mix(colour, NAVY, 1 - smoothstep(0.0012, 0.0024, abs(abs(x) - 0.0165)))
    if abs(x) < 0.02:
        colour = mix(colour, BLACK, disc(x, (y - 0.05) % 0.075 - 0.0375, 0.0055))
    colour = mix(colour, GOLD, star(x - 0.085, y - 0.415, 0.030))
    back = (u if u < 0.5 else u - 1) * 0.96  # from the middle of the back
    colour = mix(colour, CREAM, disc(back, y - 0.36, 0.092))
    colour = mix(colour, NAVY, disc(back, y - 0.36, 0.084))
    for ends in ((-.035, .405, .035, .405), (.035, .405, -.012, .310)):  # a seven, seen from behind
        colour = mix(colour, GOLD, line(back, y, *ends, 0.010))
    colour = mix(colour, NAVY, 1 - smoothstep(0.024, 0.026, y))
    return mix(colour, CREAM, smoothstep(0.575, 0.577, y))


def paint_sleeve(stripe):
    def paint(u, v):
        x, y = u * 0.36, v * 0.66
        colour = tartan(x, y, 0.06)
        for centre in (0.25, 0.285):
            colour = mix(colour, stripe, 1 - smoothstep(0.0110, 0.0125, abs(y - centre)))
        return mix(colour, CREAM, smoothstep(0.608, 0.610, y))

    return paint


def paint_leg(patch):
    def paint(u, v):
        x, y = (u - 0.5) * 0.45, v * 0.85  # x from the outer side, y from the hip down
        colour = mix(DENIM, (70, 104, 160), 0.5 + 0.5 * math.sin(9 * y))
        colour = mix(colour, PALE, 0.8 * band(x, 0.025, 0.0125, 0.0035))
        colour = mix(colour, ORANGE, 1 - smoothstep(0.018, 0.0195, abs(x)))
        colour = mix(colour, CREAM, 1 - smoothstep(0.0015, 0.003, abs(abs(x) - 0.011)))
        knee_x, knee_y = x + 0.1125, y - 0.43
        if patch and max(abs(knee_x), abs(knee_y)) < 0.06:
            edge = max(abs(knee_x), abs(knee_y))
            colour = mix(colour, OLIVE, 1 - smoothstep(0.048, 0.0495, edge))
            spot = disc((knee_x + 0.012) % 0.024 - 0.012, (knee_y + 0.012) % 0.024 - 0.012, 0.005)
            colour = mix(colour, GOLD, spot * (1 - smoothstep(0.040, 0.0415, edge)))
        return mix(colour, ORANGE, smoothstep(0.806, 0.808, y))

    return paint


def paint_hips(u, v):
    x = (u - 0.5) * 0.9
    return mix(mix(DENIM, (70, 104, 160), 0.5), PALE, 0.8 * band(x, 0.025, 0.0125, 0.0035))


def paint_face(u, v):
    turn = 2 * math.pi * u
    azimuth = turn - math.pi + 0.45 * math.sin(turn)  # as body.head_azimuth
    x, y = azimuth * 0.085, 0.118 * face_height(v)
    colour = SKIN
    for side in (-1, 1):
        d = side * x
        colour = mix(colour, (222, 128, 108), 0.45 * math.exp(-(((d - .040) / .018) ** 2) - ((y + .032) / .016) ** 2))
        eye = (abs(d - 0.031) / 0.0165) ** 2 + (abs(y - 0.002) / 0.0080) ** 2
        colour = mix(colour, (120, 72, 56), 1 - smoothstep(0.9, 1.6, eye))
        colour = mix(colour, WHITE, 1 - smoothstep(0.8, 1.05, eye))
        if eye < 1.2:
            colour = mix(colour, (64, 104, 84), disc(d - 0.030, y - 0.002, 0.0072, 0.0008))
            colour = mix(colour, BLACK, disc(d - 0.030, y - 0.002, 0.0036, 0.0008))
        brow = line(d, y, 0.016, 0.021, 0.046, 0.023 - 0.004 * smoothstep(0.03, 0.046, d), 0.0038)
        colour = mix(colour, HAIR, 0.9 * brow)
        colour = mix(colour, (150, 92, 74), 0.7 * disc(d - 0.006, y + 0.034, 0.0035, 0.002))
    lips = (x / 0.026) ** 2 + ((y + 0.058 - 5 * x * x) / 0.0085) ** 2
    colour = mix(colour, (178, 66, 66), 1 - smoothstep(0.8, 1.1, lips))
    if abs(x) < 0.025:
        colour = mix(colour, (104, 36, 40), 1 - smoothstep(0.0008, 0.0020, abs(y + 0.058 - 9 * x * x)))
    return colour


def face_height(v):
    """Of the head's rings, by their arc length down the back, near enough."""
    return -math.cos(math.pi * v)


def paint_hair(u, v):
    strand = 0.5 + 0.5 * math.sin(2 * math.pi * (26 * u + 1.2 * math.sin(7 * v)))
    gloss = math.exp(-(((v - 0.72) / 0.10) ** 2))
    return mix(mix(HAIR, (52, 28, 16), 0.75 * strand), (168, 112, 66), 0.45 * gloss * strand)


def paint_tail(u, v):
    if v < 0.20:
        return mix(ORANGE, CREAM, band(u, 0.25, 0.125, 0.05, 0.02)) if v > 0.10 else HAIR
    strand = 0.5 + 0.5 * math.sin(2 * math.pi * (8 * u + 0.6 * math.sin(9 * v)))
    return mix(HAIR, (140, 88, 50), 0.6 * strand)


def paint_skin(u, v):
    return mix(SKIN, (214, 150, 118), 0.35 * (0.5 + 0.5 * math.sin(2 * math.pi * u)))


def paint_shoe(u, v):
    round_ = abs(u - 0.5) * 2  # 1 under the sole, 0 on top
    colour = mix((206, 40, 52), WHITE, band(v, 0.125, 0.0, 0.024, 0.006) * smoothstep(0.28, 0.32, round_))
    if 0.30 < v < 0.66:
        colour = mix(colour, WHITE, band(v, 0.06, 0.0, 0.014, 0.005) * (1 - smoothstep(0.20, 0.23, round_)))
    colour = mix(colour, BLACK, smoothstep(0.86, 0.88, v) * (1 - smoothstep(0.40, 0.44, round_)))
    return mix(colour, WHITE, smoothstep(0.60, 0.62, round_))


CHARTS = {
    "shirt": Chart(0, 0, 640, 432, 0.96, 0.63, paint_shirt),
    "left_sleeve": Chart(640, 0, 192, 432, 0.36, 0.66, paint_sleeve(GOLD)),
    "right_sleeve": Chart(832, 0, 192, 432, 0.36, 0.66, paint_sleeve(PALE)),
    "left_leg": Chart(0, 432, 256, 464, 0.45, 0.85, paint_leg(True)),
    "right_leg": Chart(256, 432, 256, 464, 0.45, 0.85, paint_leg(False)),
    "hips": Chart(0, 896, 512, 128, 0.9, 0.22, paint_hips),
    "face": Chart(512, 432, 512, 320, 0.53, 0.30, paint_face),
    "hair": Chart(512, 752, 256, 176, 0.6, 0.37, paint_hair),
    "tail": Chart(768, 752, 96, 176, 0.2, 0.35, paint_tail),
    "shoe": Chart(864, 752, 160, 176, 0.3, 0.3, paint_shoe),
    "skin": Chart(512, 928, 512, 96, 0.1, 0.1, paint_skin),
}


def paint_texture():
    """Rows of RGB bytes."""
    rows = [bytearray(bytes((128, 128, 128)) * SIZE) for _ in range(SIZE)]
    for chart in CHARTS.values():
        for y in range(-MARGIN, chart.h + MARGIN):
            v = min(1.0, max(0.0, y / (chart.h - 1)))
            row = rows[chart.y + y]
            for x in range(-MARGIN, chart.w + MARGIN):
                u = min(1.0, max(0.0, x / (chart.w - 1)))
                at = 3 * (chart.x + x)
                row[at:at + 3] = bytes(int(c + 0.5) for c in chart.paint(u, v))
    return rows


def encode_png(rows):
    """With the filter "up": garments repeat from row to row."""
    raw, before = bytearray(), bytes(len(rows[0]))
    for row in rows:
        raw.append(2)
        raw += bytes((a - b) & 255 for a, b in zip(row, before))
        before = row

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", len(rows[0]) // 3, len(rows), 8, 2, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"sRGB", b"\0")
            + chunk(b"IDAT", zlib.compress(bytes(raw), 9)) + chunk(b"IEND", b""))
