#!/usr/bin/env python3
"""Makes performer.glb: an animated, skinned, textured dancer. Standard library only.

    python3 tools/performer/make_performer.py [OUTPUT.glb]            # the dancer
    python3 tools/performer/make_performer.py --squats OUTPUT.glb     # longer arms, shorter legs, squats (squats.py)
    python3 tools/performer/make_performer.py --walk OUTPUT.glb       # the dancer walks a circle for 12 s (walk.py)
    python3 tools/performer/make_performer.py --trainee OUTPUT.glb    # joints alone, with mistakes (trainee.py)
"""
import json
import pathlib
import struct
import sys

sys.dont_write_bytecode = True

from atlas import encode_png, paint_texture
from body import make_body
import motion
import squats
import trainee
import walk
from skeleton import INDEX, JOINTS

U8, U16, F32 = 5121, 5123, 5126
VERTICES, INDICES = 34962, 34963
ASSET = {"version": "2.0", "generator": "make_performer.py", "copyright": "NeuVV contributors, Apache-2.0"}


class Glb:
    def __init__(self):
        self.binary = bytearray()
        self.views, self.accessors = [], []

    def view(self, data, target=None):
        self.binary += b"\0" * (-len(self.binary) % 4)
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)}
        if target:
            view["target"] = target
        self.views.append(view)
        self.binary += data
        return len(self.views) - 1

    def accessor(self, rows, component, kind, target=None, normalized=False, bounds=False):
        """`rows`: tuples of numbers."""
        code = {U8: "B", U16: "H", F32: "f"}[component]
        flat = [value for row in rows for value in row]
        data = struct.pack(f"<{len(flat)}{code}", *flat)
        accessor = {"bufferView": self.view(data, target), "componentType": component, "count": len(rows), "type": kind}
        if normalized:
            accessor["normalized"] = True
        if bounds:
            single = [struct.unpack(f"<{len(row)}f", struct.pack(f"<{len(row)}f", *row)) for row in rows]
            accessor["min"] = [min(column) for column in zip(*single)]
            accessor["max"] = [max(column) for column in zip(*single)]
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def pack(self, root):
        root["buffers"] = [{"byteLength": len(self.binary) + -len(self.binary) % 4}]
        root["bufferViews"], root["accessors"] = self.views, self.accessors
        text = json.dumps(root, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        self.binary += b"\0" * (-len(self.binary) % 4)
        size = 12 + 8 + len(text) + 8 + len(self.binary)
        return (struct.pack("<4sII", b"glTF", 2, size) + struct.pack("<I4s", len(text), b"JSON") + text
                + struct.pack("<I4s", len(self.binary), b"BIN\0") + bytes(self.binary))


def skin_rows(skins):
    """The four strongest joints of each vertex, their weights as bytes that sum to 255."""
    joints, weights = [], []
    for skin in skins:
        strongest = sorted(skin.items(), key=lambda item: (-item[1], INDEX[item[0]]))[:4]
        total = sum(weight for _, weight in strongest)
        amounts = [round(255 * weight / total) for _, weight in strongest]
        amounts[0] += 255 - sum(amounts)
        pad = [0] * (4 - len(strongest))
        joints.append([INDEX[name] for name, _ in strongest] + pad)
        weights.append(amounts + pad)
    return joints, weights


def add_mesh(glb, mesh):
    joints, weights = skin_rows(mesh.skins)
    light = [(grey, grey, grey, 255) for grey in (round(255 * value) for value in mesh.baked_light())]
    attributes = {
        "POSITION": glb.accessor(mesh.positions, F32, "VEC3", VERTICES, bounds=True),
        "NORMAL": glb.accessor(mesh.normals, F32, "VEC3", VERTICES),
        "TEXCOORD_0": glb.accessor(mesh.uvs, F32, "VEC2", VERTICES),
        "COLOR_0": glb.accessor(light, U8, "VEC4", VERTICES, normalized=True),
        "JOINTS_0": glb.accessor(joints, U8, "VEC4", VERTICES),
        "WEIGHTS_0": glb.accessor(weights, U8, "VEC4", VERTICES, normalized=True),
    }
    indices = glb.accessor([(i,) for i in mesh.indices], U16, "SCALAR", INDICES)
    return {"attributes": attributes, "indices": indices, "material": 0}


def add_joints(figure):
    """Joint i is node i."""
    nodes = []
    for name, _, _ in JOINTS:
        node = {"name": name, "translation": list(figure.place(name))}
        children = [INDEX[child] for child, parent, _ in JOINTS if parent == name]
        if children:
            node["children"] = children
        nodes.append(node)
    return nodes


def add_animation(glb, figure):
    times, places, turns = motion.make_keys(figure.pose, figure.DURATION_S)
    clock = glb.accessor([(t,) for t in times], F32, "SCALAR", bounds=True)
    samplers, channels = [], []

    def animate(joint, path, values, kind):
        samplers.append({"input": clock, "output": glb.accessor(values, F32, kind), "interpolation": "LINEAR"})
        channels.append({"sampler": len(samplers) - 1, "target": {"node": joint, "path": path}})

    animate(0, "translation", places, "VEC3")
    for name, _, _ in JOINTS:
        animate(INDEX[name], "rotation", turns[name], "VEC4")
    return {"name": figure.NAME, "samplers": samplers, "channels": channels}


def make_performer(figure):
    """`figure` has a NAME, a DURATION_S, pose(t), and the place(name) of each joint below its parent."""
    glb = Glb()
    primitive = add_mesh(glb, make_body())
    # At rest every joint's axes are the world's, so that undoing it is a translation.
    binds = [(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -x, -y, -z, 1) for _, _, (x, y, z) in JOINTS]
    inverse_binds = glb.accessor(binds, F32, "MAT4")
    animation = add_animation(glb, figure)
    texture = glb.view(encode_png(paint_texture()))
    return glb.pack({
        "asset": ASSET,
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{"nodes": [0, len(JOINTS)]}],
        "nodes": add_joints(figure) + [{"name": "performer", "mesh": 0, "skin": 0}],
        "meshes": [{"name": "performer", "primitives": [primitive]}],
        "skins": [{"joints": list(range(len(JOINTS))), "skeleton": 0, "inverseBindMatrices": inverse_binds}],
        "materials": [{
            "name": "clothes and skin",
            "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0, "roughnessFactor": 0.9},
            "extensions": {"KHR_materials_unlit": {}},
        }],
        "textures": [{"source": 0, "sampler": 0}],
        "samplers": [{"magFilter": 9729, "minFilter": 9987, "wrapS": 33071, "wrapT": 33071}],
        "images": [{"bufferView": texture, "mimeType": "image/png"}],
        "animations": [animation],
    })


def make_motion(figure):
    """The figure's joints and their animation, without a body."""
    glb = Glb()
    animation = add_animation(glb, figure)
    return glb.pack({
        "asset": ASSET,
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": add_joints(figure),
        "animations": [animation],
    })


MAKERS = {
    "--squats": lambda: make_performer(squats),
    "--walk": lambda: make_performer(walk),
    "--trainee": lambda: make_motion(trainee),
}

if __name__ == "__main__":
    options = [word for word in sys.argv[1:] if word in MAKERS]
    names = [word for word in sys.argv[1:] if word not in MAKERS]
    if options and not names:
        sys.exit(f"make_performer.py: {options[0]} needs the name of a file to write")
    output = pathlib.Path(names[0]) if names else pathlib.Path(__file__).resolve().parent / "performer.glb"
    output.write_bytes(MAKERS[options[0]]() if options else make_performer(motion))
