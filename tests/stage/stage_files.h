// Stages and clips for tests.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "stage/file/stage_file.h"
#include "support/random_tree.h"
#include "support/temporary_folder.h"
#include "voctree/files/nvv.h"

namespace neuvv::test {

// A .nvv of 7 frames.
inline std::filesystem::path put_clip(const std::filesystem::path& path, uint32_t frames = 7, float fps = 25) {
    std::filesystem::create_directories(path.parent_path());
    RandomTreeOptions options;
    options.leaves = 40;
    options.frames = frames;
    voctree::VOctree tree = random_tree(options);
    tree.fps = fps;
    voctree::write_nvv(path, tree);
    return path;
}

// A stage as another program could export it: members of this program's extensions, of glTF and of unknown extensions,
// and numbers as people type them. It has 25 frames per second and uses anna.nvv beside it.
inline const std::string kForeignStage = R"({
	"asset" : {
		"generator" : "Khronos glTF Blender I/O v4.2.83",
		"version" : "2.0",   "extras": {"by hand":1e-3}
	},
	"extensionsUsed" : [ "KHR_lights_punctual", "NEUVV_performer", "NEUVV_stage", "KHR_texture_transform", "ACME_fog" ],
	"extensionsRequired" : [ "KHR_lights_punctual" ],
	"extensions" : {
		"KHR_lights_punctual" : {
			"lights" : [
				{ "color" : [ 1, 0.50, 2.5e-1 ], "intensity" : 54.35141306588226, "type" : "spot", "range":1E+1,
				  "spot" : { "innerConeAngle" : 0.3, "outerConeAngle" : 0.60 }, "name" : "Spot" },
				{ "intensity" : 3, "type" : "directional", "name" : "Sun", "extras" : { "soft" : 0.10 } }
			]
		},
		"ACME_fog" : { "density" : 0.0100, "layers" : [ 1.0, 2.0 ,3.0 ] }
	},
	"scene" : 0,
	"scenes" : [
		{ "name" : "Scene", "extras" : { "unit" : "m" },
		  "extensions" : { "NEUVV_stage" : { "duration" : 4.0, "fps" : 30.0, "ambient" : [ 0.1, 0.1, 0.2 ], "later" : 1e0 } },
		  "nodes" : [ 0, 1, 2, 3 ] }
	],
	"nodes" : [
		{ "mesh" : 0, "name" : "Floor", "scale" : [ 5.000, 1.0, 5.0 ] },
		{ "camera" : 0, "name" : "Camera", "rotation" : [ 0, 0, 0, 1 ], "translation" : [ 0, 1.50, 4 ] },
		{ "extensions" : { "KHR_lights_punctual" : { "light" : 0 } }, "name" : "Spot",
		  "rotation" : [ -0.70710678118654757, -0.0, 0.0, 0.70710678118654757 ], "translation" : [ 0.0, 4.0, 0 ] },
		{ "name" : "Pivot", "children" : [ 4, 5 ], "scale" : [ 2, 1, 1 ], "translation" : [ 1.0, 0, 0 ] },
		{ "name" : "Anna", "extras" : { "cast" : true }, "rotation" : [ 0, 0, 0.38268343236508978, 0.92387953251128674 ],
		  "extensions" : { "NEUVV_performer" : { "uri" : "anna.nvv", "spin" : 90.0, "opacity" : 0.50, "mood" : "good",
		    "time" : [ { "operator" : "loop" }, { "operator" : "offset", "by" : "2f", "why" : 1.0 } ] }, "ACME_fog" : { "off" : true } } },
		{ "extensions" : { "KHR_lights_punctual" : { "light" : 1 } }, "name" : "Sun" }
	],
	"cameras" : [ { "name" : "Lens", "type" : "perspective",
		"perspective" : { "aspectRatio" : 1.7777777777777777, "yfov" : 0.8, "zfar" : 1000, "znear" : 0.10000000149011612 } } ],
	"animations" : [ { "name" : "CameraAction",
		"channels" : [ { "sampler" : 0, "target" : { "node" : 1, "path" : "translation" } } ],
		"samplers" : [ { "input" : 3, "interpolation" : "LINEAR", "output" : 4 } ] } ],
	"materials" : [ { "name" : "Wood", "pbrMetallicRoughness" : { "baseColorTexture" : { "index" : 0 }, "metallicFactor" : 0.0 } } ],
	"textures" : [ { "source" : 0 } ],
	"images" : [ { "name" : "wood", "mimeType" : "image/png", "uri" : "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGNoSHAAAAKEASFpy73iAAAAAElFTkSuQmCC" } ],
	"meshes" : [ { "name" : "Plane", "primitives" : [ { "attributes" : { "POSITION" : 0, "NORMAL" : 1, "TEXCOORD_0" : 2 }, "material" : 0 } ] } ],
	"accessors" : [
		{ "bufferView" : 0, "componentType" : 5126, "count" : 3, "max" : [ 1, 0, 1 ], "min" : [ -1, 0, -1 ], "type" : "VEC3" },
		{ "bufferView" : 1, "componentType" : 5126, "count" : 3, "type" : "VEC3" },
		{ "bufferView" : 2, "componentType" : 5126, "count" : 3, "type" : "VEC2" },
		{ "bufferView" : 3, "componentType" : 5126, "count" : 2, "type" : "SCALAR", "max" : [ 2 ], "min" : [ 0 ] },
		{ "bufferView" : 4, "componentType" : 5126, "count" : 2, "type" : "VEC3" }
	],
	"bufferViews" : [
		{ "buffer" : 0, "byteLength" : 36 },
		{ "buffer" : 0, "byteLength" : 36, "byteOffset" : 36 },
		{ "buffer" : 0, "byteLength" : 24, "byteOffset" : 72 },
		{ "buffer" : 0, "byteLength" : 8, "byteOffset" : 96 },
		{ "buffer" : 0, "byteLength" : 24, "byteOffset" : 104 }
	],
	"buffers" : [ { "byteLength" : 128, "uri" : "stage%20data.bin" } ]
}
)";

// The buffer of kForeignStage: a triangle, and a camera that goes from (0, 1.5, 4) to (2, 1.5, 4) in 2 s.
inline std::string foreign_buffer() {
    const float numbers[32] = {-1, 0, 1, 1, 0, 1, 0,    0, -1, 0, 1, 0,    0, 1, 0,    0,
                               1,  0, 0, 0, 1, 0, 0.5f, 1, 0,  2, 0, 1.5f, 4, 2, 1.5f, 4};
    return {reinterpret_cast<const char*>(numbers), sizeof numbers};
}

// Writes stage.gltf, its buffer and its clip.
inline std::filesystem::path put_foreign_stage(const std::filesystem::path& folder) {
    write_text(folder / "stage.gltf", kForeignStage);
    write_text(folder / "stage data.bin", foreign_buffer());
    put_clip(folder / "anna.nvv");
    return folder / "stage.gltf";
}

}  // namespace neuvv::test
