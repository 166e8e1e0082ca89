"""Somebody who walks a circle, 1.4 m across, in 12 s, the end joining the start: a clip that is long and uses all of its
box. Above the hips it is the dance."""
import math

import motion
from motion import X, Y, Z, add2, place_leg, pose_above, scale2
from skeleton import ANKLE, PLACE, local_place
from vectors import mix, quat_axis, quat_mul, smoothstep

NAME = "walk"
DURATION_S = 12.0
RADIUS = 0.7
STANDS_S, LIFT = 0.58, 0.07  # each foot steps once a second: it stands for so long, then swings so high
OUTWARDS = 0.09              # of each foot from the line that is walked

place = local_place  # of a joint below its parent


def heading(t):
    """The turn about +Y of somebody who faces along the circle."""
    return math.pi / 2 + 2 * math.pi * t / DURATION_S


def path(t, aside=0.0):
    """Where the circle is at t: x, z; `aside` metres to the left of it."""
    angle = 2 * math.pi * t / DURATION_S
    return scale2((math.sin(angle), math.cos(angle)), RADIUS - aside)


def foot(side, t):
    """Where a foot is at t: x, z, height of the swing, and how far through its step (0: standing), and its turn."""
    steps = t - (0.0 if side > 0 else 0.5)
    begun = math.floor(steps)
    share = max(0.0, (steps - begun - STANDS_S) / (1 - STANDS_S))
    middle = t - steps + begun + 0.5 * STANDS_S  # when the hips pass the foot that stands
    before, after = path(middle, side * OUTWARDS), path(middle + 1, side * OUTWARDS)
    turn = heading(middle + smoothstep(0, 1, share))
    # place_leg has the ankle off the foot's middle along Z, as of somebody who faces that way.
    ankle = scale2((math.sin(turn), math.cos(turn) - 1), ANKLE[2])
    where = add2(mix(before, after, smoothstep(0, 1, share)), ankle)
    return where, LIFT * math.sin(math.pi * share) ** 2, share, turn


def pose(t):
    """World turn of each joint, and the hips' place. Joints that are not named go with their parents."""
    yaw = heading(t)
    stride = 2 * math.pi * t  # two steps a second, one of each foot
    x, z = add2(path(t), scale2((math.cos(yaw), -math.sin(yaw)), 0.02 * math.cos(stride)))
    hips = (x, PLACE["hips"][1] - 0.045 - 0.012 * math.cos(2 * stride), z)
    world = {"hips": quat_mul(quat_axis(Y, yaw + 0.12 * math.sin(stride)), quat_axis(X, 0.04))}
    world["spine"] = quat_mul(world["hips"], quat_mul(quat_axis(X, 0.04), quat_axis(Z, -0.03 * math.cos(stride))))
    pose_above(world, t % motion.DURATION_S, 0.0)
    for name, side in (("left", 1), ("right", -1)):
        where, lift, share, turn = foot(side, t)
        place_leg(world, name, side, hips, turn + 0.16 * side, (where, lift, share))
    return world, hips
