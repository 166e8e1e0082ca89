"""Closed surfaces lofted through rings of points, with normals, UVs, skin weights and baked light."""
import math

from vectors import add, cross, dot, length, scale, smoothstep, sub, unit


class Mesh:
    def __init__(self):
        self.positions, self.normals, self.uvs, self.parts = [], [], [], []
        self.skins = []  # per vertex: {joint name: weight}
        self.indices = []
        self.occluders = []  # (centre, radius, part): the body as balls, for the baked light

    def add_part(self, positions, uvs, triangles, skin, part):
        """`skin(position)` gives a vertex's weights; normals are means over faces, across seams of the UVs too."""
        first = len(self.positions)
        sums = {}
        key = [tuple(round(c * 1e5) for c in p) for p in positions]
        for a, b, c in triangles:
            face = cross(sub(positions[b], positions[a]), sub(positions[c], positions[a]))
            for v in (a, b, c):
                sums[key[v]] = add(sums.get(key[v], (0.0, 0.0, 0.0)), face)
        for i, position in enumerate(positions):
            self.positions.append(position)
            self.normals.append(unit(sums.get(key[i], (0.0, 1.0, 0.0))))
            self.uvs.append(uvs[i])
            self.skins.append(skin(position))
            self.parts.append(part)
        for a, b, c in triangles:
            if len({key[a], key[b], key[c]}) == 3:
                self.indices += [first + a, first + b, first + c]

    def baked_light(self):
        """A soft sky and contact shadows in the rest pose: one grey a vertex, linear."""
        greys = []
        for position, normal, part in zip(self.positions, self.normals, self.parts):
            light = 1.0
            for centre, radius, other in self.occluders:
                if other == part:
                    continue
                to = sub(centre, position)
                distance = max(length(to), radius)
                if distance > 5 * radius:
                    continue
                facing = max(0.0, dot(normal, to) / distance * 0.85 + 0.15)
                light *= 1 - 0.38 * facing * (radius / distance) ** 2
            key = max(0.0, dot(normal, unit((0.35, 0.75, 0.55))))
            greys.append(min(1.0, max(0.25, light) * (0.70 + 0.16 * (0.5 + 0.5 * normal[1]) + 0.16 * key)))
        return greys


def weights(*pairs):
    """Joint weights from (name, amount) pairs, normalised; what is nearly nothing is dropped."""
    kept = {}
    for name, amount in pairs:
        if amount > 0.004:
            kept[name] = kept.get(name, 0.0) + amount
    total = sum(kept.values())
    return {name: amount / total for name, amount in kept.items()}


def chain_weights(along, joints, stops, width):
    """Along a limb: joints[i] hands over to joints[i + 1] around stops[i], within ± width."""
    amounts = [1.0] + [0.0] * (len(joints) - 1)
    for i, stop in enumerate(stops):
        share = smoothstep(stop - width, stop + width, along)
        amounts[i + 1] = amounts[i] * share
        amounts[i] *= 1 - share
    return weights(*zip(joints, amounts))


def spline(stations, count):
    """Catmull-Rom through tuples whose first number is the parameter; `count` samples evenly along it."""
    out = []
    low, high = stations[0][0], stations[-1][0]
    for i in range(count):
        s = low + (high - low) * i / (count - 1)
        k = 0
        while k + 2 < len(stations) and stations[k + 1][0] < s:
            k += 1
        a, b = stations[k], stations[k + 1]
        before = stations[k - 1] if k > 0 else a
        after = stations[k + 2] if k + 2 < len(stations) else b
        h = b[0] - a[0]
        t = (s - a[0]) / h
        values = [s]
        for c in range(1, len(a)):
            m0 = (b[c] - before[c]) / max(1e-9, b[0] - before[0]) * h
            m1 = (after[c] - a[c]) / max(1e-9, after[0] - a[0]) * h
            values.append((2 * t**3 - 3 * t**2 + 1) * a[c] + (t**3 - 2 * t**2 + t) * m0
                          + (3 * t**2 - 2 * t**3) * b[c] + (t**3 - t**2) * m1)
        out.append(tuple(values))
    return out


def superellipse(angle, exponent):
    """The point at this angle of a unit superellipse; 2 is a circle, more is boxier."""
    c, s = math.cos(angle), math.sin(angle)
    return (math.copysign(abs(c) ** (2 / exponent), c), math.copysign(abs(s) ** (2 / exponent), s))


def loft(mesh, rings, chart, skin, part, ball_radius=None):
    """`rings`: rows of points around, the last the same as the first, from one end to the other. `chart` maps (u around,
    v along) to texture space. Both ends are closed; triangles are turned to face outward."""
    rows, columns = len(rings), len(rings[0])
    positions, uvs, triangles = [], [], []
    travelled = [0.0]
    middles = [scale(_sum(ring[:-1]), 1 / (columns - 1)) for ring in rings]
    for r in range(1, rows):
        travelled.append(travelled[-1] + length(sub(rings[r][0], rings[r - 1][0])) + 1e-9)
    for r, ring in enumerate(rings):
        for c, point in enumerate(ring):
            positions.append(point)
            uvs.append(chart(c / (columns - 1), travelled[r] / travelled[-1]))
    for r in range(rows - 1):
        for c in range(columns - 1):
            a, b = r * columns + c, (r + 1) * columns + c
            triangles += [(a, a + 1, b), (a + 1, b + 1, b)]
    for r, v in ((0, 0.0), (rows - 1, 1.0)):
        pole = len(positions)
        positions.append(middles[r])
        uvs.append(chart(0.5, v))
        for c in range(columns - 1):
            a = r * columns + c
            triangles.append((pole, a + 1, a) if r == 0 else (pole, a, a + 1))
    if _volume(positions, triangles) < 0:
        triangles = [(a, c, b) for a, b, c in triangles]
    mesh.add_part(positions, uvs, triangles, skin, part)
    for r in range(0, rows, 2):
        radius = ball_radius or min(length(sub(p, middles[r])) for p in rings[r])
        if radius > 0.015:
            mesh.occluders.append((middles[r], radius, part))


def _volume(positions, triangles):
    origin = positions[0]
    return sum(dot(sub(positions[a], origin), cross(sub(positions[b], origin), sub(positions[c], origin)))
               for a, b, c in triangles)


def _sum(points):
    total = (0.0, 0.0, 0.0)
    for point in points:
        total = add(total, point)
    return total


def tube_rings(centres, radii, side_axis, columns, exponent=2.0, seam=math.pi):
    """Rings around a path of centres. `radii`: (along side_axis, across it) for each. u = 0 lies at angle `seam`, counted
    from side_axis towards side_axis × path."""
    rings = []
    for i, centre in enumerate(centres):
        before, after = centres[max(0, i - 1)], centres[min(len(centres) - 1, i + 1)]
        along = unit(sub(after, before))
        across = unit(cross(side_axis, along))
        side = cross(along, across)
        ring = []
        for c in range(columns + 1):
            x, y = superellipse(seam + 2 * math.pi * (c % columns) / columns, exponent)
            ring.append(add(centre, add(scale(side, x * radii[i][0]), scale(across, y * radii[i][1]))))
        rings.append(ring)
    return rings
