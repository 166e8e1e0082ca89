"""A trainee of the dance: shorter bones, another place, turned, a little slower, with two planted mistakes."""
import math

import motion
from motion import Y
from skeleton import local_place
from vectors import add, cross, quat_axis, quat_conj, quat_mul, rotate, scale, smoothstep, unit

NAME = "trainee"
DURATION_S = 3.2
LEGS, ARMS, BACK = 0.86, 0.89, 0.88
SPOT, TURN = (-1.3, 0.0, 0.5), quat_axis(Y, math.radians(40))

# The mistakes, in seconds of the dance as the performer shows it.
ARM_OFF = {"first": 0.4, "last": 1.4, "degrees": 28.0}  # the left arm, turned about its shoulder
LEG_LATE = {"first": 1.5, "last": 2.8, "seconds": 0.4}  # the right leg


def place(name):
    """Of a joint below its parent."""
    longer = {"shin": LEGS, "foot": LEGS, "forearm": ARMS, "hand": ARMS}
    return scale(local_place(name), longer.get(name.split("_", 1)[-1], BACK))


def turn_arm(world, t):
    """Upper arm and forearm turn by the same angle, about the axis across both."""
    rest = unit((1.0, -1.0, 0.0))
    axis = unit(cross(rotate(world["left_upper_arm"], rest), rotate(world["left_forearm"], rest)))
    amount = smoothstep(0, 0.12, t - ARM_OFF["first"]) * smoothstep(0, 0.12, ARM_OFF["last"] - t)
    off = quat_axis(axis, math.radians(ARM_OFF["degrees"]) * amount)
    for bone in ("upper_arm", "forearm", "hand"):
        world[f"left_{bone}"] = quat_mul(off, world[f"left_{bone}"])


def delay_leg(world, t):
    """The leg does below the hips what it should have done before: first it waits, at the end it catches up."""
    late = LEG_LATE["seconds"] * min(1.0, max(0.0, (t - LEG_LATE["first"]) / LEG_LATE["seconds"]),
                                     max(0.0, (LEG_LATE["last"] - t) / 0.25))
    before, _ = motion.pose(t - late)
    turn = quat_mul(world["hips"], quat_conj(before["hips"]))
    for bone in ("thigh", "shin", "foot"):
        world[f"right_{bone}"] = quat_mul(turn, before[f"right_{bone}"])


def pose(t):
    """World turn of each joint, and the hips' place."""
    shown = t * motion.DURATION_S / DURATION_S
    world, hips = motion.pose(shown)
    turn_arm(world, shown)
    delay_leg(world, shown)
    return ({joint: quat_mul(TURN, turn) for joint, turn in world.items()},
            add(SPOT, rotate(TURN, scale(hips, LEGS))))
