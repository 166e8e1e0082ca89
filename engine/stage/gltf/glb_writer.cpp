#include "stage/gltf/glb_writer.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/platform.h"

namespace neuvv::stage {

namespace {

constexpr size_t kGlbMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

void append_glb_word(std::vector<uint8_t>& bytes, size_t word) {
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<uint8_t>(word >> shift));
}

}  // namespace

GlbWriter::GlbWriter() {
    json["asset"] = {{"version", "2.0"}, {"generator", "NeuVV"}};
}

size_t GlbWriter::add_view(const void* data, size_t size) {
    const size_t offset = bytes.size();
    bytes.resize((offset + size + 3) / 4 * 4);
    if (size > 0) std::memcpy(&bytes[offset], data, size);
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}});
    return json["bufferViews"].size() - 1;
}

size_t GlbWriter::add_accessor(size_t view, size_t count, const char* type, uint32_t component_type) {
    json["accessors"].push_back(
        {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}});
    return json["accessors"].size() - 1;
}

size_t GlbWriter::add_vectors(const std::vector<glm::vec3>& vectors) {
    std::vector<float> numbers;
    numbers.reserve(vectors.size() * 3);
    for (const glm::vec3& v : vectors) numbers.insert(numbers.end(), {v.x, v.y, v.z});
    return add(numbers, "VEC3", 3, kGltfFloat);
}

size_t GlbWriter::add_positions(const std::vector<glm::vec3>& positions) {
    const size_t accessor = add_vectors(positions);
    glm::vec3 low = positions[0], high = positions[0];
    for (const glm::vec3& p : positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    json["accessors"][accessor]["min"] = {low.x, low.y, low.z};
    json["accessors"][accessor]["max"] = {high.x, high.y, high.z};
    return accessor;
}

size_t GlbWriter::add_times(const std::vector<float>& times) {
    const size_t accessor = add(times, "SCALAR", 1, kGltfFloat);
    json["accessors"][accessor]["min"] = {times.front()};
    json["accessors"][accessor]["max"] = {times.back()};
    return accessor;
}

void GlbWriter::write(const std::filesystem::path& file, const Fix& fix) const {
    nlohmann::ordered_json document = json;
    if (!bytes.empty()) document["buffers"] = nlohmann::ordered_json::array({{{"byteLength", bytes.size()}}});
    std::string text = document.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const size_t size = 12 + 8 + text.size() + (bytes.empty() ? 0 : 8 + bytes.size());
    if (size > UINT32_MAX)
        throw InputError(
            file.string(), "",
            fmt::format("would have {:.1f} GB; a .glb has at most 4 GiB", 1e-9 * static_cast<double>(size)), fix);
    std::vector<uint8_t> head, middle;
    for (const size_t word : {kGlbMagic, size_t{2}, size, text.size(), kJsonChunk}) append_glb_word(head, word);
    for (const size_t word : {bytes.size(), kBinaryChunk}) append_glb_word(middle, word);
    write_file_atomically(file, [&](const ByteSink& sink) {
        sink(head.data(), head.size());
        sink(text.data(), text.size());
        if (bytes.empty()) return;
        sink(middle.data(), middle.size());
        sink(bytes.data(), bytes.size());
    });
}

void add_gltf_channel(nlohmann::ordered_json& animation, size_t times, size_t values, size_t node, const char* path,
                      const char* interpolation) {
    animation["samplers"].push_back({{"input", times}, {"output", values}, {"interpolation", interpolation}});
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
}

}  // namespace neuvv::stage
