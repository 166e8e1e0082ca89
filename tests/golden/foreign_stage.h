// A stage as another program might write it: a checked floor, a camera that moves around the performer in two seconds,
// and a spotlight. Only the performer's clip, figure.nvv, is in this program's format.
#pragma once

#include <string>

namespace neuvv::test {

// Little-endian: 4 positions, 4 normals, 4 texture coordinates, 6 indices of 2 bytes, 2 times, 2 translations, 2
// rotations.
inline const std::string kForeignBuffer =
    "AABAwAAAAAAAAEBAAABAQAAAAAAAAEBAAABAQAAAAAAAAEDAAABAwAAAAAAAAEDAAAAAAAAAgD8AAAAAAAAAAAAAgD8AAAAA"
    "AAAAAAAAgD8AAAAAAAAAAAAAgD8AAAAAAAAAAAAAQEAAAEBAAABAQAAAQEAAAAAAAAAAAAAAAAAAAAEAAgAAAAIAAwAAAAAA"
    "AAAAQAAAAABmZqY/ZmaGQGZmJkAzM/M/zcxMQAo+hb0AAACAAAAAgCd1fz/T1QK++bipPqzOOT28BG8/";

// A PNG of 2×2 texels, brown and green.
inline const std::string kForeignChecks =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAE0lEQVR42mM4MS0qKs+GAYiBLAAnbgV5PntA8AAAAABJRU5E"
    "rkJggg==";

inline const std::string kForeignScene = R"({
  "asset": {"version": "2.0", "generator": "By hand"},
  "extensionsUsed": ["KHR_lights_punctual", "NEUVV_performer"],
  "extensions": {"KHR_lights_punctual": {"lights": [
    {"type": "spot", "color": [1, 0.9, 0.7], "intensity": 90, "spot": {"innerConeAngle": 0.3, "outerConeAngle": 0.45}}
  ]}},
  "scene": 0,
  "scenes": [{"nodes": [0, 1, 2, 3]}],
  "nodes": [
    {"name": "Floor", "mesh": 0},
    {"name": "Camera", "camera": 0},
    {"name": "Spot", "translation": [-1.6, 3.4, 1.6], "rotation": [-0.412050301, -0.342514279, -0.170676823, 0.826902618],
      "extensions": {"KHR_lights_punctual": {"light": 0}}},
    {"name": "Figure", "rotation": [0, 0.258819045, 0, 0.965925826],
      "extensions": {"NEUVV_performer": {"uri": "figure.nvv"}}}
  ],
  "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}],
  "animations": [{
    "samplers": [{"input": 4, "output": 5}, {"input": 4, "output": 6}],
    "channels": [
      {"sampler": 0, "target": {"node": 1, "path": "translation"}},
      {"sampler": 1, "target": {"node": 1, "path": "rotation"}}
    ]
  }],
  "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0, "roughnessFactor": 0.8}}],
  "textures": [{"source": 0, "sampler": 0}],
  "samplers": [{"magFilter": 9728, "minFilter": 9987}],
  "images": [{"uri": "data:image/png;base64,)" +
                                         kForeignChecks + R"("}],
  "meshes": [{"primitives": [{
    "attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3, "material": 0}]}],
  "accessors": [
    {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-3, 0, -3], "max": [3, 0, 3]},
    {"bufferView": 0, "byteOffset": 48, "componentType": 5126, "count": 4, "type": "VEC3"},
    {"bufferView": 0, "byteOffset": 96, "componentType": 5126, "count": 4, "type": "VEC2"},
    {"bufferView": 0, "byteOffset": 128, "componentType": 5123, "count": 6, "type": "SCALAR"},
    {"bufferView": 0, "byteOffset": 140, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [2]},
    {"bufferView": 0, "byteOffset": 148, "componentType": 5126, "count": 2, "type": "VEC3"},
    {"bufferView": 0, "byteOffset": 172, "componentType": 5126, "count": 2, "type": "VEC4"}
  ],
  "bufferViews": [{"buffer": 0, "byteLength": 204}],
  "buffers": [{"byteLength": 204, "uri": "data:application/octet-stream;base64,)" +
                                         kForeignBuffer + R"("}]
})";

}  // namespace neuvv::test
