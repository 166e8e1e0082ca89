#include "interchange/splats/splat_ply.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/platform.h"

namespace neuvv::interchange {

namespace {

constexpr float kLeastLogit = 1e-4f;

float logit_of(float opacity) {
    const float p = std::clamp(opacity, kLeastLogit, 1 - kLeastLogit);
    return std::log(p / (1 - p));
}

std::string header(const Splats& splats) {
    std::string text = fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", splats.splats.size());
    const auto property = [&](const std::string& name) { text += "property float " + name + "\n"; };
    for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) property(name);
    for (int i = 0; i < 3; ++i) property(fmt::format("f_dc_{}", i));
    for (uint32_t i = 0; i < 3 * (sh_count(splats.degree) - 1); ++i) property(fmt::format("f_rest_{}", i));
    property("opacity");
    for (int i = 0; i < 3; ++i) property(fmt::format("scale_{}", i));
    for (int i = 0; i < 4; ++i) property(fmt::format("rot_{}", i));
    return text + "end_header\n";
}

void append(const Splat& splat, uint32_t degree, std::vector<float>& numbers) {
    for (int i = 0; i < 3; ++i) numbers.push_back(splat.centre[i]);
    for (int i = 0; i < 3; ++i) numbers.push_back(0);
    for (int c = 0; c < 3; ++c) numbers.push_back(splat.colour[0][c]);
    for (int c = 0; c < 3; ++c)
        for (uint32_t k = 1; k < sh_count(degree); ++k) numbers.push_back(splat.colour[k][c]);
    numbers.push_back(logit_of(splat.opacity));
    for (int i = 0; i < 3; ++i) numbers.push_back(std::log(splat.deviation[i]));
    const glm::quat& r = splat.rotation;
    numbers.insert(numbers.end(), {r.w, r.x, r.y, r.z});
}

}  // namespace

size_t ply_bytes_of_splat(uint32_t degree) {
    return sizeof(float) * (14 + size_t{3} * sh_count(degree));
}

void write_splat_ply(const std::filesystem::path& file, const Splats& splats) {
    std::vector<float> numbers;
    numbers.reserve(splats.splats.size() * ply_bytes_of_splat(splats.degree) / sizeof(float));
    for (const Splat& splat : splats.splats) append(splat, splats.degree, numbers);
    const std::string text = header(splats);
    write_file_atomically(file, [&](const ByteSink& sink) {
        sink(text.data(), text.size());
        sink(numbers.data(), numbers.size() * sizeof(float));
    });
}

}  // namespace neuvv::interchange
