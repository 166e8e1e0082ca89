#include "render/set/environment.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "base/threads/parallel.h"
#include "voctree/files/half.h"

namespace neuvv::render {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr uint32_t kMaxWidth = 2048, kMinHeight = 8;
constexpr uint32_t kMinRows = 256;  // in sums over all directions; the texels of smaller images are divided

struct Level {
    uint32_t width = 0, height = 0;
    std::vector<glm::vec3> texels;
};

// The image as linear light, scaled down by the power of two that makes it at most kMaxWidth wide.
Level linear_level(const media::Image& image) {
    uint32_t block = 1;
    while (image.width / block > kMaxWidth) block *= 2;
    Level level{std::max(1u, image.width / block), std::max(1u, image.height / block), {}};
    level.texels.reserve(size_t{level.width} * level.height);
    for (uint32_t y = 0; y < level.height; ++y)
        for (uint32_t x = 0; x < level.width; ++x) {
            glm::vec3 sum(0);
            for (uint32_t i = 0; i < block * block; ++i) {
                const uint8_t* pixel = image.at(std::min(x * block + i % block, image.width - 1),
                                                std::min(y * block + i / block, image.height - 1));
                sum += glm::vec3(media::linear_from_srgb_byte(pixel[0]), media::linear_from_srgb_byte(pixel[1]),
                                 media::linear_from_srgb_byte(pixel[2]));
            }
            level.texels.push_back(sum / static_cast<float>(block * block));
        }
    return level;
}

Level halved(const Level& from) {
    Level to{std::max(1u, from.width / 2), std::max(1u, from.height / 2), {}};
    for (uint32_t y = 0; y < to.height; ++y)
        for (uint32_t x = 0; x < to.width; ++x) {
            glm::vec3 sum(0);
            for (uint32_t i = 0; i < 4; ++i)
                sum += from.texels[size_t{std::min(2 * y + i / 2, from.height - 1)} * from.width +
                                   std::min(2 * x + i % 2, from.width - 1)];
            to.texels.push_back(sum / 4.0f);
        }
    return to;
}

glm::vec3 bilinear(const Level& level, const glm::dvec3& dir) {
    const double u = 0.5 + std::atan2(dir.x, -dir.z) / (2 * kPi), v = std::acos(std::clamp(dir.y, -1.0, 1.0)) / kPi;
    const double x = u * level.width - 0.5, y = std::clamp(v * level.height - 0.5, 0.0, level.height - 1.0);
    const auto share_x = static_cast<float>(x - std::floor(x)), share_y = static_cast<float>(y - std::floor(y));
    const auto at = [&](double column, double row) {
        const auto c = static_cast<uint32_t>(static_cast<int64_t>(column) + level.width) % level.width;
        const auto r = std::min(static_cast<uint32_t>(row), level.height - 1);
        return level.texels[size_t{r} * level.width + c];
    };
    const double left = std::floor(x), top = std::floor(y);
    return glm::mix(glm::mix(at(left, top), at(left + 1, top), share_x),
                    glm::mix(at(left, top + 1), at(left + 1, top + 1), share_x), share_y);
}

// The SH coefficients of the light, times those of the cosine lobe divided by π, which are 1, 2/3 and 1/4 by degree
// (Ramamoorthi and Hanrahan 2001), times the constants of the SH functions.
Irradiance irradiance_of(const Level& level) {
    const double y00 = 0.28209479177387814, y1 = 0.4886025119029199, y2 = 1.0925484305920792, y20 = 0.31539156525252005,
                 y22 = 0.5462742152960396;
    const double constants[9] = {y00, y1, y1, y1, y2, y2, y20, y2, y22};
    Irradiance sums{};
    const uint32_t parts = std::max(1u, (kMinRows + level.height - 1) / level.height);  // of a texel, along each axis
    const uint32_t rows = parts * level.height, columns = parts * level.width;
    for (uint32_t row = 0; row < rows; ++row) {
        const double band = std::cos(kPi * row / rows) - std::cos(kPi * (row + 1) / rows);
        const double solid_angle = band * 2 * kPi / columns;
        for (uint32_t column = 0; column < columns; ++column) {
            const glm::dvec3 n = environment_direction((column + 0.5) / columns, (row + 0.5) / rows);
            const glm::dvec3 light =
                solid_angle * glm::dvec3(level.texels[size_t{row / parts} * level.width + column / parts]);
            const double basis[9] = {
                1, n.y, n.z, n.x, n.x * n.y, n.y * n.z, 3 * n.z * n.z - 1, n.x * n.z, n.x * n.x - n.y * n.y};
            for (size_t i = 0; i < 9; ++i) sums[i] += basis[i] * light;
        }
    }
    for (size_t i = 0; i < 9; ++i) sums[i] *= constants[i] * constants[i] * (i == 0 ? 1.0 : i < 4 ? 2.0 / 3 : 0.25);
    return sums;
}

double radical_inverse(uint32_t i) {
    double value = 0, digit = 0.5;
    for (; i > 0; i >>= 1, digit /= 2) value += (i & 1) * digit;
    return value;
}

// The light that a surface with normal n and this roughness mirrors to a viewer straight above it. GGX is sampled by
// importance; each sample reads the level of the pyramid whose texels are as large as the solid angle that the sample
// represents (Křivánek and Colbert 2008).
glm::vec3 blurred(const std::vector<Level>& pyramid, const glm::dvec3& n, double roughness, uint32_t samples) {
    const double alpha2 = std::pow(roughness, 4);
    const glm::dvec3 helper_axis = std::abs(n.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    const glm::dvec3 t = glm::normalize(glm::cross(helper_axis, n)), b = glm::cross(n, t);
    const double texel = 4 * kPi / (double{1} * pyramid[0].width * pyramid[0].height);
    glm::dvec3 sum(0);
    double weights = 0;
    for (uint32_t i = 0; i < samples; ++i) {
        const double u = (i + 0.5) / samples, phi = 2 * kPi * radical_inverse(i);
        const double cos2 = (1 - u) / (1 + (alpha2 - 1) * u), cosine = std::sqrt(cos2), sine = std::sqrt(1 - cos2);
        const glm::dvec3 half = sine * std::cos(phi) * t + sine * std::sin(phi) * b + cosine * n;
        const glm::dvec3 dir = 2 * cosine * half - n;
        const double nl = glm::dot(n, dir);
        if (nl <= 0) continue;
        const double lobe = cos2 * (alpha2 - 1) + 1, density = alpha2 / (kPi * lobe * lobe) / 4;
        const double lod = 0.5 * std::log2(1 / (samples * density * texel));
        const auto level =
            static_cast<size_t>(std::clamp(std::round(lod), 0.0, static_cast<double>(pyramid.size() - 1)));
        sum += nl * glm::dvec3(bilinear(pyramid[level], glm::normalize(dir)));
        weights += nl;
    }
    return weights > 0 ? glm::vec3(sum / weights) : bilinear(pyramid[0], n);
}

void store(std::vector<uint16_t>& to, size_t texel, const glm::vec3& light) {
    for (int k = 0; k < 3; ++k) to[4 * texel + static_cast<size_t>(k)] = voctree::half_from_float(light[k]);
    to[4 * texel + 3] = voctree::half_from_float(1);
}

}  // namespace

glm::dvec3 environment_direction(double u, double v) {
    const double phi = 2 * kPi * (u - 0.5), theta = kPi * v;
    return {std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi)};
}

Environment make_environment(const media::Image& image) {
    std::vector<Level> pyramid{linear_level(image)};
    Environment out;
    out.width = pyramid[0].width;
    out.height = pyramid[0].height;
    out.irradiance = irradiance_of(pyramid[0]);
    while (pyramid.back().width > 1 || pyramid.back().height > 1) pyramid.push_back(halved(pyramid.back()));
    size_t count = 1;
    while (count < pyramid.size() && pyramid[count].height >= kMinHeight) ++count;
    for (size_t i = 0; i < count; ++i) {
        const Level& shape = pyramid[i];
        std::vector<uint16_t>& level = out.levels.emplace_back(4 * shape.texels.size());
        const double roughness = static_cast<double>(i) / static_cast<double>(std::max<size_t>(count - 1, 1));
        parallel_for(shape.texels.size(), 1024, [&](size_t begin, size_t end) {
            for (size_t texel = begin; texel < end; ++texel) {
                const double u = (static_cast<double>(texel % shape.width) + 0.5) / shape.width;
                const double v = (static_cast<double>(texel / shape.width) + 0.5) / shape.height;
                store(level, texel,
                      i == 0 ? shape.texels[texel]
                             : blurred(pyramid, environment_direction(u, v), roughness, 8u << std::min<size_t>(i, 5)));
            }
        });
    }
    return out;
}

Environment dark_environment() {
    Environment out;
    out.levels.emplace_back(4);
    store(out.levels[0], 0, glm::vec3(0));
    return out;
}

SetEnvironment::SetEnvironment(const gpu::Device& device, const media::Image* source) : has_image(source != nullptr) {
    const Environment environment = source ? make_environment(*source) : dark_environment();
    std::vector<std::vector<uint8_t>> levels;
    for (const std::vector<uint16_t>& level : environment.levels) {
        levels.emplace_back(level.size() * sizeof(uint16_t));
        std::memcpy(levels.back().data(), level.data(), levels.back().size());
    }
    image = gpu::DeviceImage(device, "environment",
                             {environment.width, environment.height, VK_FORMAT_R16G16B16A16_SFLOAT,
                              VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT, VK_SAMPLE_COUNT_1_BIT,
                              static_cast<uint32_t>(levels.size())});
    gpu::upload_levels(device, image, levels);
    gpu::SamplerShape shape;
    shape.wrap_v = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    sampler = gpu::Sampler(device, "environment", shape);
    irradiance = environment.irradiance;
    last_level = static_cast<float>(levels.size() - 1);
}

}  // namespace neuvv::render
