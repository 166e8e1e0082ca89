"""Three-vectors and quaternions (x, y, z, w) as tuples."""
import math


def add(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scale(a, s):
    return (a[0] * s, a[1] * s, a[2] * s)


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def length(a):
    return math.sqrt(dot(a, a))


def unit(a):
    size = length(a)
    return scale(a, 1 / size) if size > 1e-12 else (0.0, 1.0, 0.0)


def mix(a, b, t):
    """Of two numbers or two tuples."""
    if isinstance(a, tuple):
        return tuple(x + (y - x) * t for x, y in zip(a, b))
    return a + (b - a) * t


def smoothstep(low, high, x):
    t = min(1.0, max(0.0, (x - low) / (high - low)))
    return t * t * (3 - 2 * t)


def quat_axis(axis, angle):
    s = math.sin(angle / 2)
    return (axis[0] * s, axis[1] * s, axis[2] * s, math.cos(angle / 2))


def quat_mul(a, b):
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz)


def quat_conj(q):
    return (-q[0], -q[1], -q[2], q[3])


def rotate(q, v):
    u = q[:3]
    t = scale(cross(u, v), 2)
    return add(add(v, scale(t, q[3])), cross(u, t))


def quat_between(a, b):
    """The shortest turn from one direction to another."""
    a, b = unit(a), unit(b)
    axis = cross(a, b)
    w = 1 + dot(a, b)
    if w < 1e-9:
        return quat_axis(unit(cross(a, (1.0, 0.0, 0.0) if abs(a[0]) < 0.9 else (0.0, 1.0, 0.0))), math.pi)
    size = math.sqrt(dot(axis, axis) + w * w)
    return (axis[0] / size, axis[1] / size, axis[2] / size, w / size)


def quat_frame(down, front):
    """The turn that takes −Y to `down` and +Z as near to `front` as it can."""
    y = scale(unit(down), -1)
    x = unit(cross(y, front))
    z = cross(x, y)
    trace = x[0] + y[1] + z[2]
    if trace > 0:
        s = math.sqrt(trace + 1) * 2
        return ((y[2] - z[1]) / s, (z[0] - x[2]) / s, (x[1] - y[0]) / s, s / 4)
    if x[0] > y[1] and x[0] > z[2]:
        s = math.sqrt(1 + x[0] - y[1] - z[2]) * 2
        return (s / 4, (y[0] + x[1]) / s, (z[0] + x[2]) / s, (y[2] - z[1]) / s)
    if y[1] > z[2]:
        s = math.sqrt(1 + y[1] - x[0] - z[2]) * 2
        return ((y[0] + x[1]) / s, s / 4, (z[1] + y[2]) / s, (z[0] - x[2]) / s)
    s = math.sqrt(1 + z[2] - x[0] - y[1]) * 2
    return ((z[0] + x[2]) / s, (z[1] + y[2]) / s, s / 4, (x[1] - y[0]) / s)
