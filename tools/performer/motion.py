"""The dance: 3 s at 120 beats a minute, the end joining the start. Steps are planned on the floor, the hips follow them,
the knees are solved; arms, chest and head move by the beat."""
import math

from skeleton import ANKLE, JOINTS, KNEE, PLACE, THIGH_TOP, local_place, mirrored
from vectors import (add, cross, length, mix, quat_axis, quat_between, quat_conj, quat_frame, quat_mul, rotate, scale,
                     smoothstep, sub, unit)

NAME = "dance"
DURATION_S = 3.0
FPS = 25
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)

# Each foot's steps: start and end in seconds, where it lands (x, z), how high it swings.
STEPS = {
    "left": [(0.00, 0.40, (0.36, 0.02), 0.09), (1.50, 1.90, (-0.06, 0.10), 0.10), (2.50, 2.95, (0.10, 0.00), 0.16)],
    "right": [(0.50, 0.90, (0.12, 0.04), 0.08), (1.00, 1.45, (-0.34, 0.00), 0.10), (2.02, 2.45, (-0.10, 0.00), 0.12)],
}
REST = {"left": (0.10, 0.00), "right": (-0.10, 0.00)}


place = local_place  # of a joint below its parent


def wave(t, cycles, phase=0.0):
    """A sine that makes `cycles` turns in the clip; phase in turns."""
    return math.sin(2 * math.pi * (cycles * t / DURATION_S + phase))


def beat(t):
    """0 between the beats, 1 on each."""
    return 0.5 + 0.5 * math.cos(2 * math.pi * t / 0.5)


def foot(name, t):
    """Where the foot stands at t: x, z, height of the swing, and how far through a step it is (0 or 1: standing)."""
    place, lift, share = REST[name], 0.0, 0.0
    for start, end, landing, height in STEPS[name]:
        if t >= end:
            place = landing
        elif t > start:
            share = (t - start) / (end - start)
            place = mix(place, landing, smoothstep(0, 1, share))
            lift = height * math.sin(math.pi * share) ** 2
    return place, lift, share


def settled(t):
    """The middle between the feet as the hips follow it: smoothed over half a second."""
    total, middle = 0.0, (0.0, 0.0)
    for i in range(-12, 13):
        amount = math.exp(-((i / 7) ** 2))
        at = (t + 0.035 * i) % DURATION_S
        (left, _, _), (right, _, _) = foot("left", at), foot("right", at)
        middle = add2(middle, scale2(add2(left, right), 0.5 * amount))
        total += amount
    return scale2(middle, 1 / total)


def add2(a, b):
    return (a[0] + b[0], a[1] + b[1])


def scale2(a, s):
    return (a[0] * s, a[1] * s)


def body_yaw(t):
    return 0.62 * wave(t, 1, -0.04) + 0.12 * wave(t, 2)


def solve_leg(top, ankle, forward, longer=1.0):
    """The knee's place for a thigh and shin of fixed length; `forward` is where the knee points."""
    thigh, shin = longer * length(sub(KNEE, THIGH_TOP)), longer * length(sub(ANKLE, KNEE))
    reach = sub(ankle, top)
    distance = min(length(reach), 0.9995 * (thigh + shin))
    along = unit(reach)
    bent = unit(sub(forward, scale(along, sum(a * b for a, b in zip(forward, along)))))
    x = (thigh * thigh - shin * shin + distance * distance) / (2 * distance)
    out = math.sqrt(max(0.0, thigh * thigh - x * x))
    return add(add(top, scale(along, x)), scale(bent, out)), add(top, scale(along, distance))


def pose(t):
    """World turn of each joint, and the hips' place. Joints that are not named go with their parents."""
    world = {}
    yaw = body_yaw(t)
    middle = settled(t)
    sway = 0.05 * wave(t, 3, 0.1)
    height = PLACE["hips"][1] - 0.050 - 0.035 * beat(t) - 0.02 * wave(t, 1, 0.3) ** 2
    hips = (middle[0] + sway * math.cos(yaw), height, middle[1] - sway * math.sin(yaw) + 0.015)
    turn = quat_axis(Y, yaw)
    world["hips"] = quat_mul(turn, quat_mul(quat_axis(Z, 0.10 * wave(t, 3, 0.35)), quat_axis(X, 0.05)))
    lean = quat_mul(quat_axis(X, 0.06 + 0.06 * beat(t)), quat_axis(Z, -0.10 * wave(t, 3, 0.35)))
    world["spine"] = quat_mul(world["hips"], lean)
    pose_above(world, t, yaw)
    for name, side in (("left", 1), ("right", -1)):
        place_leg(world, name, side, hips, 0.75 * yaw + side * 0.16, foot(name, t))
    return world, hips


def pose_above(world, t, yaw):
    """Chest, head and arms above a spine; the head turns back from the body's `yaw`."""
    twist = quat_mul(quat_axis(Y, 0.28 * wave(t, 2, 0.15)), quat_axis(Z, -0.13 * wave(t, 1, 0.1)))
    world["chest"] = quat_mul(world["spine"], twist)
    nod = quat_mul(quat_axis(Y, -0.45 * yaw - 0.15 * wave(t, 2, 0.15)), quat_axis(X, -0.10 + 0.12 * beat(t)))
    world["neck"] = quat_mul(world["chest"], quat_mul(quat_axis(Y, -0.2 * yaw), quat_axis(Z, 0.07 * wave(t, 3, 0.2))))
    world["head"] = quat_mul(world["neck"], nod)
    swing = quat_mul(quat_axis(X, 0.12 - 0.22 * wave(t, 6, 0.12)), quat_axis(Z, 0.42 * wave(t, 3, 0.05)))
    world["ponytail"] = quat_mul(world["head"], swing)
    for name, side, phase in (("left", 1, 0.0), ("right", -1, 0.5)):
        pose_arm(world, name, side, t, phase)


def pose_arm(world, name, side, t, phase):
    """Aimed in the chest's frame: `rise` from hanging (−1) to overhead (1), `ahead` from the side to the front."""
    rise = 0.08 + 0.78 * wave(t, 1, phase + 0.02) + 0.12 * wave(t, 3, phase)
    ahead = 0.45 + 0.35 * wave(t, 2, phase + 0.2)
    elevation, azimuth = 1.15 * rise, 0.95 * ahead
    upper = (side * math.cos(elevation) * math.cos(azimuth), math.sin(elevation),
             math.cos(elevation) * math.sin(azimuth))
    bend = 0.80 + 0.45 * wave(t, 2, phase + 0.35)
    # The forearm folds up and to the front, more up where the arm is raised.
    towards = unit((-0.15 * side, 0.55 + 0.45 * rise, 0.75 - 0.3 * rise))
    hinge = unit(cross(upper, towards))
    lower = rotate(quat_axis(hinge, bend), upper)
    chest = world["chest"]
    rest = (side * 0.7071067811865476, -0.7071067811865476, 0.0)
    world[f"{name}_upper_arm"] = quat_mul(chest, quat_between(rest, upper))
    elbow = quat_mul(quat_between(upper, lower), quat_between(rest, upper))
    world[f"{name}_forearm"] = quat_mul(chest, elbow)
    flick = quat_mul(quat_axis(Z, side * 0.35 * wave(t, 4, phase)), quat_axis(Y, 0.25 * wave(t, 2, phase + 0.1)))
    world[f"{name}_hand"] = quat_mul(world[f"{name}_forearm"], flick)


def place_leg(world, name, side, hips, facing, step):
    """Hip to sole, for a foot that is where `step` says (foot) and points along `facing`."""
    (x, z), lift, share = step
    pitch = 0.75 * lift / 0.1 * (1 - 1.5 * share) if share > 0 else 0.0  # toes last off the floor, heel first down
    sole = quat_mul(quat_axis(Y, facing), quat_axis(X, pitch))
    # The ankle stands above the sole; a pitched foot turns about its ball or heel, which keeps it out of the floor.
    raised = ANKLE[1] + lift + 0.10 * abs(math.sin(pitch))
    ankle = (x, raised, z + ANKLE[2])
    top = add(hips, rotate(world["hips"], sub(mirrored(THIGH_TOP, side), PLACE["hips"])))
    forward = rotate(quat_axis(Y, facing), unit((0.10 * side, 0.0, 1.0)))
    knee, ankle = solve_leg(top, ankle, forward)
    turn_leg(world, name, side, (top, knee, ankle), forward)
    world[f"{name}_foot"] = sole


def turn_leg(world, name, side, places, forward):
    """Turns thigh and shin along the leg's places: top, knee, ankle."""
    top, knee, ankle = places
    rest_thigh = sub(mirrored(KNEE, side), mirrored(THIGH_TOP, side))
    rest_shin = sub(mirrored(ANKLE, side), mirrored(KNEE, side))
    for joint, rest, now in ((f"{name}_thigh", rest_thigh, sub(knee, top)), (f"{name}_shin", rest_shin, sub(ankle, knee))):
        unturn = quat_conj(quat_frame(rest, Z))
        world[joint] = quat_mul(quat_frame(now, forward), unturn)


def make_keys(pose, duration_s):
    """Times, the hips' places, and each joint's local turns, key by key, of a motion whose end joins its start."""
    count = round(duration_s * FPS) + 1
    times = [i / FPS for i in range(count)]
    places, turns = [], {name: [] for name, _, _ in JOINTS}
    for t in times:
        world, hips = pose(t % duration_s)
        places.append(hips)
        for name, parent, _ in JOINTS:
            local = quat_mul(quat_conj(world[parent]), world[name]) if parent else world[name]
            if turns[name] and sum(a * b for a, b in zip(turns[name][-1], local)) < 0:
                local = tuple(-c for c in local)
            turns[name].append(local)
    return times, places, turns
