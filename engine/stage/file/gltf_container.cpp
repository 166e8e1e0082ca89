#include "stage/file/gltf_container.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "base/error.h"
#include "voctree/files/chunk_file.h"

namespace neuvv::stage {

uint32_t gltf_word_at(const std::vector<uint8_t>& bytes, size_t offset) {
    uint32_t word;
    std::memcpy(&word, bytes.data() + offset, 4);
    return word;
}

// A .glb has a header of 12 bytes, then a JSON chunk, then usually a BIN chunk; chunk headers have 8 bytes. Further
// chunks are not checked.
GltfContainer find_gltf_json(const std::vector<uint8_t>& bytes, const std::string& file) {
    if (const voctree::FileContent ours =
            voctree::content_of(std::span(bytes).first(std::min<size_t>(bytes.size(), 16)));
        ours != voctree::FileContent::kOther)
        throw InputError(file, "",
                         ours == voctree::FileContent::kClip ? "is a clip, not a glTF scene" : "is a layer of paint",
                         Remedy::kMakeStage);
    GltfContainer container{false, 0, bytes.size()};
    container.binary = bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
    if (!container.binary) return container;
    const auto fail = [&](const char* place, const std::string& problem) {
        throw InputError(file, place, problem, "export the .glb again");
    };
    if (bytes.size() < 20) fail("header", fmt::format("has {} bytes, a .glb has at least 20", bytes.size()));
    if (gltf_word_at(bytes, 4) != 2) fail("header", fmt::format("is glTF version {}, need 2", gltf_word_at(bytes, 4)));
    const uint64_t length = gltf_word_at(bytes, 8);
    if (length > bytes.size())
        fail("header", fmt::format("says {} bytes, the file has {}: it is cut off", length, bytes.size()));
    const uint64_t json_end = uint64_t{20} + gltf_word_at(bytes, 12);
    if (gltf_word_at(bytes, 16) != kGlbJson) fail("first chunk", "is not JSON");
    if (json_end > length) fail("JSON chunk", "runs past the end of the file");
    if (json_end < length) {
        if (json_end + 8 > length) fail("second chunk", "runs past the end of the file");
        const uint64_t size = gltf_word_at(bytes, json_end);
        if (json_end + 8 + size > length) fail("BIN chunk", "runs past the end of the file");
        if (gltf_word_at(bytes, json_end + 4) == kGlbBin) {
            container.bin_begin = json_end + 8;
            container.bin_size = size;
        }
    }
    container.json_begin = 20;
    container.json_size = json_end - 20;
    return container;
}

}  // namespace neuvv::stage
