// Gaussian splats in glTF, by KHR_gaussian_splatting.
#pragma once

#include <filesystem>
#include <span>

#include "interchange/splats/splats.h"
#include "stage/gltf/glb_writer.h"

namespace neuvv::interchange {

constexpr const char* kSplatExtension = "KHR_gaussian_splatting";

// Adds the arrays of splats, of which there is at least one, and returns a mesh of them for the document's list.
nlohmann::ordered_json add_splat_mesh(const Splats& splats, stage::GlbWriter& glb);

// A .glb with a node for each frame. Where there are several, an animation shows one after the other by their scales.
// Programs that do not know the extension show the splats as coloured points. Written atomically. Throws InputError
// where it would have more than 4 GiB, RuntimeFailure where it cannot be written.
void write_splat_glb(const std::filesystem::path& file, std::span<const Splats> frames, double fps,
                     const glm::dvec3& origin = glm::dvec3(0));  // of the splats, as gltf_frames.h has it
size_t glb_bytes_of_splat(uint32_t degree);

}  // namespace neuvv::interchange
