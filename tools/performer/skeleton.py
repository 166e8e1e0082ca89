"""The joints in the rest pose: arms 45° down, feet a little apart, facing +Z; metres, +X is the performer's left."""
from vectors import add, scale, sub

ARM_DOWN = 0.7071067811865476
UPPER_ARM, FOREARM = 0.275, 0.245
THIGH_TOP, KNEE, ANKLE = (0.088, 0.905, 0.0), (0.094, 0.500, 0.012), (0.100, 0.085, -0.010)
SHOULDER = (0.172, 1.395, -0.015)


def arm_point(distance, side, offset=(0.0, 0.0, 0.0)):
    """A point down the arm in its rest direction."""
    x = SHOULDER[0] + ARM_DOWN * distance + offset[0]
    return (side * x, SHOULDER[1] - ARM_DOWN * distance + offset[1], SHOULDER[2] + offset[2])


def mirrored(point, side):
    return (side * point[0], point[1], point[2])


# Name, parent, place in the rest pose. Parents come first.
JOINTS = [
    ("hips", None, (0.0, 0.94, 0.0)),
    ("spine", "hips", (0.0, 1.08, -0.005)),
    ("chest", "spine", (0.0, 1.23, -0.010)),
    ("neck", "chest", (0.0, 1.455, -0.018)),
    ("head", "neck", (0.0, 1.535, -0.005)),
    ("ponytail", "head", (0.0, 1.635, -0.105)),
]
for _name, _side in (("left", 1), ("right", -1)):
    JOINTS += [
        (f"{_name}_upper_arm", "chest", arm_point(0.0, _side)),
        (f"{_name}_forearm", f"{_name}_upper_arm", arm_point(UPPER_ARM, _side)),
        (f"{_name}_hand", f"{_name}_forearm", arm_point(UPPER_ARM + FOREARM, _side)),
        (f"{_name}_thigh", "hips", mirrored(THIGH_TOP, _side)),
        (f"{_name}_shin", f"{_name}_thigh", mirrored(KNEE, _side)),
        (f"{_name}_foot", f"{_name}_shin", mirrored(ANKLE, _side)),
    ]

INDEX = {name: i for i, (name, _, _) in enumerate(JOINTS)}
PLACE = {name: place for name, _, place in JOINTS}
PARENT = {name: parent for name, parent, _ in JOINTS}


def local_place(name):
    return sub(PLACE[name], PLACE[PARENT[name]]) if PARENT[name] else PLACE[name]
