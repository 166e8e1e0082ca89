"""Another figure: longer arms and shorter legs than the dancer's, doing two squats in 4 s, the end joining the start."""
import math

from motion import X, Y, solve_leg, turn_leg
from skeleton import ANKLE, KNEE, PLACE, THIGH_TOP, local_place, mirrored
from vectors import add, length, quat_axis, quat_between, quat_mul, rotate, scale, sub, unit

NAME = "squats"
DURATION_S = 4.0
PERIOD_S = 2.0
LEGS, ARMS, BACK = 0.90, 1.12, 1.06
DEPTH, BEHIND = 0.36, 0.20  # metres that the hips go down and back


def place(name):
    """Of a joint below its parent."""
    longer = {"shin": LEGS, "foot": LEGS, "forearm": ARMS, "hand": ARMS, "chest": BACK, "spine": BACK}
    return scale(local_place(name), longer.get(name.split("_", 1)[-1], 1.0)) if name != "hips" else PLACE[name]


def pose(t):
    """World turn of each joint, and the hips' place. Joints that are not named go with their parents."""
    down = (0.5 - 0.5 * math.cos(2 * math.pi * t / PERIOD_S)) ** 1.2
    sway = math.sin(2 * math.pi * t / DURATION_S)
    leg = LEGS * (length(sub(KNEE, THIGH_TOP)) + length(sub(ANKLE, KNEE)))
    standing = ANKLE[1] + 0.985 * leg + PLACE["hips"][1] - THIGH_TOP[1]
    hips = (0.01 * sway, standing - DEPTH * down, -BEHIND * down)
    world = {"hips": quat_mul(quat_axis(Y, 0.05 * sway), quat_axis(X, 0.35 * down))}
    world["spine"] = quat_mul(world["hips"], quat_axis(X, 0.18 * down))
    world["chest"] = quat_mul(world["spine"], quat_axis(X, 0.10 * down))
    world["neck"] = quat_mul(world["chest"], quat_axis(X, -0.25 * down))
    world["head"] = quat_mul(world["neck"], quat_mul(quat_axis(X, -0.22 * down), quat_axis(Y, 0.1 * sway)))
    world["ponytail"] = quat_mul(world["head"], quat_axis(X, 0.3 * down))
    for name, side in (("left", 1), ("right", -1)):
        raised = 0.15 + 1.35 * down
        upper = unit((side * (0.28 - 0.15 * down), -math.cos(raised), math.sin(raised)))
        lower = rotate(quat_axis(X, -0.25 + 0.1 * down), upper)
        rest = (side * 0.7071067811865476, -0.7071067811865476, 0.0)
        world[f"{name}_upper_arm"] = quat_between(rest, upper)
        world[f"{name}_forearm"] = quat_mul(quat_between(upper, lower), quat_between(rest, upper))
        world[f"{name}_hand"] = world[f"{name}_forearm"]
        ankle = (side * 0.15, ANKLE[1], ANKLE[2])
        top = add(hips, rotate(world["hips"], sub(mirrored(THIGH_TOP, side), PLACE["hips"])))
        forward = unit((0.30 * side, 0.0, 1.0))
        knee, ankle = solve_leg(top, ankle, forward, LEGS)
        turn_leg(world, name, side, (top, knee, ankle), forward)
        world[f"{name}_foot"] = quat_axis(Y, 0.25 * side)
    return world, hips
