"""The performer's parts: torso, trousers, arms, hands, head, hair and shoes."""
import math

from atlas import CHARTS
from mesh import Mesh, chain_weights, loft, spline, superellipse, tube_rings, weights
from skeleton import ARM_DOWN, FOREARM, PLACE, UPPER_ARM, arm_point
from vectors import add, length, mix, scale, smoothstep, sub

SIDES = (("left", 1), ("right", -1))


def ellipse_rings(stations, count, columns, exponent):
    """Level rings: stations (y, half width, depth to the front, depth to the back, centre z); u = 0 at the back."""
    rings = []
    for y, half, front, back, z in spline(stations, count):
        ring = []
        for c in range(columns + 1):
            x, s = superellipse(-math.pi / 2 + 2 * math.pi * (c % columns) / columns, exponent)
            ring.append((-x * half, y, z + s * (front if s > 0 else back)))
        rings.append(ring)
    return rings


def torso_skin(position):
    x, y, _ = position
    spine = smoothstep(0.97, 1.12, y)
    chest = smoothstep(1.12, 1.28, y)
    neck = smoothstep(1.42, 1.50, y)
    arm = 0.45 * smoothstep(0.120, 0.185, abs(x)) * smoothstep(1.30, 1.38, y) * (1 - neck)
    side = "left" if x > 0 else "right"
    low = (1 - spine) * (1 - arm)
    return weights(("hips", low), ("spine", spine * (1 - chest)), ("chest", chest * (1 - neck) * (1 - arm)),
                   ("neck", neck), (f"{side}_upper_arm", arm))


def add_torso(mesh):
    stations = [(0.880, .166, .112, .112, 0), (0.893, .176, .122, .126, 0), (0.93, .177, .124, .130, 0),
                (0.98, .168, .116, .122, 0), (1.05, .153, .108, .104, 0), (1.12, .150, .107, .098, 0),
                (1.20, .160, .117, .104, 0), (1.28, .173, .126, .114, -.004), (1.34, .182, .122, .116, -.010),
                (1.385, .176, .104, .108, -.014), (1.415, .148, .086, .096, -.016), (1.440, .108, .072, .082, -.018),
                (1.460, .074, .064, .070, -.016), (1.478, .062, .060, .062, -.014), (1.492, .058, .058, .056, -.010)]
    loft(mesh, ellipse_rings(stations, 30, 36, 2.35), CHARTS["shirt"].uv, torso_skin, "torso")


def leg_skin(name):
    joints = ["hips", f"{name}_thigh", f"{name}_shin", f"{name}_foot"]

    def skin(position):
        inward = smoothstep(0.05, -0.01, abs(position[0])) * smoothstep(0.70, 0.84, position[1])
        limb = chain_weights(1 - position[1], joints, [1 - 0.885, 1 - 0.500, 1 - 0.10], 0.065)
        return weights(("hips", inward), *((j, w * (1 - inward)) for j, w in limb.items()))

    return skin


def hip_skin(position):
    x, y, _ = position
    thigh = 0.5 * (1 - smoothstep(0.78, 0.93, y)) * smoothstep(0.02, 0.10, abs(x))
    return weights(("hips", 1 - thigh), ("left_thigh" if x > 0 else "right_thigh", thigh))


def add_trousers(mesh):
    hips = [(0.785, .085, .075, .085, 0), (0.80, .128, .098, .108, -.002), (0.84, .158, .112, .126, -.006),
            (0.89, .165, .114, .122, -.004), (0.95, .158, .108, .112, 0), (0.99, .140, .095, .098, 0)]
    loft(mesh, ellipse_rings(hips, 10, 32, 2.3), CHARTS["hips"].uv, hip_skin, "hips")
    stations = [(0.075, .076, .058, .058), (0.125, .082, .078, .082), (0.180, .086, .087, .093), (0.250, .091, .087, .092),
                (0.340, .094, .078, .082), (0.440, .095, .068, .071), (0.500, .096, .065, .067), (0.570, .097, .065, .066),
                (0.660, .098, .065, .067), (0.760, .099, .063, .064), (0.850, .100, .064, .065), (0.905, .100, .067, .069),
                (0.915, .100, .060, .062)]
    depth = [(0.0, 0.0), (0.2, -.004), (0.48, .010), (0.62, -.004), (0.78, -.012), (0.93, -.006)]
    for name, side in SIDES:
        centres, radii = [], []
        for down, x, across, along in spline(stations, 32):
            z = _interpolate(depth, down)
            centres.append((side * x, 1 - down, z))
            radii.append((across, along))
        chart = CHARTS[f"{name}_leg"]
        # The seam runs down the inside.
        rings = tube_rings(centres, radii, (1.0, 0.0, 0.0), 22, 2.15, math.pi if side > 0 else 0.0)
        loft(mesh, rings, chart.uv, leg_skin(name), f"{name}_leg")


def _interpolate(table, x):
    for (x0, y0), (x1, y1) in zip(table, table[1:]):
        if x <= x1:
            return mix(y0, y1, smoothstep(x0, x1, x))
    return table[-1][1]


def arm_distance(position):
    """How far down the arm, from the shoulder, by projection."""
    shoulder = arm_point(0.0, 1)
    return (abs(position[0]) - shoulder[0]) * ARM_DOWN - (position[1] - shoulder[1]) * ARM_DOWN


def arm_skin(name):
    joints = ["chest", f"{name}_upper_arm", f"{name}_forearm", f"{name}_hand"]
    stops = [0.0, UPPER_ARM, UPPER_ARM + FOREARM - 0.005]

    def skin(position):
        along = arm_distance(position)
        if along < 0.5 * UPPER_ARM:
            return chain_weights(along, joints[:2], stops[:1], 0.075)
        if along < UPPER_ARM + 0.6 * FOREARM:
            return chain_weights(along, joints[1:3], stops[1:2], 0.05)
        return chain_weights(along, joints[2:], stops[2:], 0.03)

    return skin


def add_arms(mesh):
    stations = [(-0.095, .030, .036), (-0.070, .044, .054), (-0.035, .056, .066), (0.0, .061, .067), (0.05, .059, .062),
                (0.13, .054, .055), (0.21, .050, .050), (0.275, .047, .047), (0.34, .047, .046), (0.42, .042, .042),
                (0.485, .038, .038), (0.505, .041, .041), (0.520, .041, .041), (0.526, .034, .034)]
    for name, side in SIDES:
        centres, radii = [], []
        for along, thick, deep in spline(stations, 28):
            bend = smoothstep(0.04, -0.10, along)  # near the body the sleeve comes out level
            centres.append(arm_point(along, side, (0.0, -0.055 * bend, 0.0)))
            radii.append((deep, thick))
        rings = tube_rings(centres, radii, (0.0, 0.0, 1.0), 18, 2.0, -math.pi / 2 * side)
        loft(mesh, rings, CHARTS[f"{name}_sleeve"].uv, arm_skin(name), f"{name}_arm")
        add_hand(mesh, name, side)


def add_hand(mesh, name, side):
    """Palms face the body, thumbs to the front. `out` is the back of the hand."""
    skin = arm_skin(name)
    out = (side * ARM_DOWN, ARM_DOWN, 0.0)
    chart = CHARTS["skin"].uv
    part = f"{name}_hand"

    def place(along, z, lift=0.0):
        return add(arm_point(along, side), add(scale(out, lift), (0.0, 0.0, z)))

    def tube(path, stations, columns):
        rings = tube_rings(path, stations, (0.0, 0.0, 1.0), columns)
        loft(mesh, rings, chart, skin, part, 0.014)

    palm = [(0.490, .020, .019), (0.520, .026, .021), (0.545, .034, .020), (0.575, .042, .019), (0.605, .043, .017),
            (0.622, .038, .013), (0.626, .030, .008)]
    rows = spline(palm, 10)
    tube([place(a, 0.004 * smoothstep(.52, .58, a)) for a, _, _ in rows], [(w, t) for _, w, t in rows], 14)
    for z, reach, radius in ((.033, .070, .0095), (.012, .080, .0100), (-.010, .075, .0095), (-.030, .058, .0085)):
        path, sizes = [], []
        for i in range(7):
            t = i / 6
            path.append(place(0.605 + reach * t, z * (1 + 0.15 * t) + 0.003, -0.012 * t * t))
            r = radius * (1 - 0.18 * t) * math.sqrt(max(0.04, 1 - max(0.0, (t - 0.8) / 0.2) ** 2))
            sizes.append((r, r))
        tube(path, sizes, 8)
    path, sizes = [], []
    for i in range(7):
        t = i / 6
        path.append(place(0.540 + 0.072 * t, 0.024 + 0.040 * math.sin(1.2 * t), -0.010 * t))
        r = (0.0135 - 0.003 * t) * math.sqrt(max(0.04, 1 - max(0.0, (t - 0.8) / 0.2) ** 2))
        sizes.append((r, r))
    tube(path, sizes, 8)


HEAD = (0.0, 1.612, 0.006)


def head_radius(azimuth, height):
    """Of the head's surface around its upright axis; azimuth 0 is the face, height −1 the chin's level to 1."""
    front, aside = math.cos(azimuth), math.sin(azimuth)
    round_ = math.sqrt(max(0.0, 1 - abs(height) ** 2.4))
    width = 0.077 * (1 - 0.22 * smoothstep(-0.1, -1.0, height))
    depth = (0.094 if front > 0 else 0.100) * (1 - (0.02 if front > 0 else 0.30) * smoothstep(-0.2, -1.0, height))
    radius = round_ / math.sqrt((aside / width) ** 2 + (front / depth) ** 2)
    if front > 0:
        x = math.atan2(aside, front) * 0.085  # metres across the face
        y = height * 0.118

        def bump(x0, y0, sx, sy, amount):
            return amount * math.exp(-(((x - x0) / sx) ** 2) - ((y - y0) / sy) ** 2)

        radius += bump(0, -.022, .0105, .015, .020) + bump(0, -.002, .008, .020, .010)  # nose, its bridge
        radius += bump(0, -.058, .022, .010, .006) + bump(0, -.096, .024, .018, .010)  # lips, chin
        radius += bump(.030, .022, .022, .008, .004) + bump(-.030, .022, .022, .008, .004)  # brows
        radius -= bump(.031, .002, .015, .010, .006) + bump(-.031, .002, .015, .010, .006)  # eyes
        radius += bump(.040, -.030, .024, .022, .003) + bump(-.040, -.030, .024, .022, .003)  # cheeks
    return radius


def head_rings(rows, columns, lift):
    """u = 0 at the back of the head; more columns over the face."""
    rings = []
    for r in range(rows):
        height = -math.cos(math.pi * (0.012 + 0.976 * r / (rows - 1)))
        ring = []
        for c in range(columns + 1):
            azimuth = head_azimuth((c % columns) / columns)
            radius = max(0.002, head_radius(azimuth, height) + lift(azimuth, height))
            up = 1 + max(0.0, lift(azimuth, height)) / 0.118
            ring.append(add(HEAD, (radius * math.sin(azimuth), 0.118 * height * up, radius * math.cos(azimuth))))
        rings.append(ring)
    return rings


def head_azimuth(u):
    """From −π at the back (u = 0) over 0 at the face to π; denser at the face."""
    turn = 2 * math.pi * u
    return turn - math.pi + 0.45 * math.sin(turn)


def head_skin(_):
    return {"head": 1.0}


def hairline(azimuth, height):
    """1 well inside the hair, 0 on the skin."""
    front = 0.5 + 0.5 * math.cos(azimuth)
    line = mix(-0.62, 0.52, smoothstep(0.25, 0.80, front)) + 0.10 * math.cos(3 * azimuth) * smoothstep(0.6, 1.0, front)
    return smoothstep(line - 0.10, line + 0.12, height)


def neck_skin(position):
    return chain_weights(position[1], ["chest", "neck", "head"], [1.445, 1.535], 0.035)


def add_header(mesh):
    neck = [(1.420, .058, .056, .056, -.016), (1.46, .054, .052, .054, -.014), (1.50, .051, .050, .054, -.008),
            (1.54, .052, .052, .058, -.002), (1.58, .048, .046, .056, .0)]
    loft(mesh, ellipse_rings(neck, 10, 20, 2.0), CHARTS["skin"].uv, neck_skin, "neck")
    loft(mesh, head_rings(28, 38, lambda a, h: 0.0), CHARTS["face"].uv, head_skin, "head")
    for _, side in SIDES:
        centres, radii = [], []
        for i in range(7):
            t = i / 6 * 2 - 1
            centres.append((side * (0.074 + 0.004 * t), 1.600 + 0.030 * t, -0.004 - 0.006 * t))
            r = math.sqrt(max(0.05, 1 - t * t))
            radii.append((0.018 * r, 0.010 * r))
        loft(mesh, tube_rings(centres, radii, (0.0, 0.0, 1.0), 10), CHARTS["skin"].uv, head_skin, "head", 0.005)
    add_hair(mesh)


def add_hair(mesh):
    def lift(azimuth, height):
        strands = 0.0016 * math.cos(14 * azimuth + 3 * height)
        return -0.012 + (0.027 + strands) * hairline(azimuth, height)

    loft(mesh, head_rings(24, 34, lift), CHARTS["hair"].uv, head_skin, "head")
    path = [(0.0, .0, 1.660, -.080, .018), (0.2, .0, 1.672, -.118, .034), (0.4, .0, 1.640, -.150, .036),
            (0.6, .0, 1.585, -.164, .033), (0.8, .0, 1.530, -.166, .026), (1.0, .0, 1.475, -.158, .008)]
    centres, radii = [], []
    for _, x, y, z, r in spline(path, 14):
        centres.append((x, y, z))
        radii.append((r, r * 0.85))

    def skin(position):
        tail = smoothstep(0.0, 0.06, length(sub(position, PLACE["ponytail"])) - 0.01)
        return weights(("head", 1 - tail), ("ponytail", tail))

    loft(mesh, tube_rings(centres, radii, (1.0, 0.0, 0.0), 12), CHARTS["tail"].uv, skin, "tail")


def add_shoes(mesh):
    # z from the ankle, half width, height.
    stations = [(-.082, .022, .050), (-.078, .032, .072), (-.055, .039, .098), (-.02, .041, .104), (.015, .042, .098),
                (.05, .045, .078), (.09, .050, .064), (.125, .050, .055), (.155, .041, .046), (.172, .028, .038),
                (.178, .016, .028)]
    for name, side in SIDES:
        ankle = PLACE[f"{name}_foot"]
        rings = []
        for z, half, height in spline(stations, 18):
            ring = []
            for c in range(19):
                x, s = superellipse(-math.pi / 2 + 2 * math.pi * (c % 18) / 18, 2.8)
                ring.append((ankle[0] + side * 0.004 - x * half, max(0.0, (0.5 + 0.5 * s) * height), ankle[2] + z))
            rings.append(ring)
        loft(mesh, rings, CHARTS["shoe"].uv, lambda _, n=name: {f"{n}_foot": 1.0}, f"{name}_shoe")


def make_body():
    mesh = Mesh()
    add_torso(mesh)
    add_trousers(mesh)
    add_arms(mesh)
    add_header(mesh)
    add_shoes(mesh)
    return mesh
