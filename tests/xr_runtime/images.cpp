#include "images.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>

namespace neuvv::xr_runtime {

namespace {

float linear_from_srgb(uint8_t byte) {
    const float value = static_cast<float>(byte) / 255;
    return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f);
}

float float_from_half(uint16_t half) {
    const int exponent = half >> 10 & 31, mantissa = half & 1023;
    const float sign = half & 0x8000 ? -1.0f : 1.0f;
    if (exponent == 31) return mantissa ? 0 : sign * 65504;
    if (exponent == 0) return sign * std::ldexp(static_cast<float>(mantissa), -24);
    return sign * std::ldexp(static_cast<float>(1024 + mantissa), exponent - 25);
}

template <typename T>
T read_as(const uint8_t* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

bool is_bgra(int64_t format) {
    return format == VK_FORMAT_B8G8R8A8_SRGB || format == VK_FORMAT_B8G8R8A8_UNORM;
}
bool is_srgb(int64_t format) {
    return format == VK_FORMAT_R8G8B8A8_SRGB || format == VK_FORMAT_B8G8R8A8_SRGB;
}

void decode(const uint8_t* texel, int64_t format, float* rgba) {
    switch (format) {
        case VK_FORMAT_R16G16B16A16_SFLOAT:
            for (int i = 0; i < 4; ++i) rgba[i] = float_from_half(read_as<uint16_t>(texel + 2 * i));
            return;
        case VK_FORMAT_D32_SFLOAT:
            rgba[0] = read_as<float>(texel);
            return;
        case VK_FORMAT_D16_UNORM:
            rgba[0] = static_cast<float>(read_as<uint16_t>(texel)) / 65535;
            return;
        default:
            break;
    }
    for (int i = 0; i < 3; ++i) {
        const uint8_t byte = texel[is_bgra(format) ? 2 - i : i];
        rgba[i] = is_srgb(format) ? linear_from_srgb(byte) : static_cast<float>(byte) / 255;
    }
    rgba[3] = static_cast<float>(texel[3]) / 255;
}

uint8_t byte_of(float value) {
    return static_cast<uint8_t>(std::clamp(value, 0.0f, 1.0f) * 255 + 0.5f);
}

void write_png(const std::filesystem::path& path, uint32_t width, uint32_t height, uint32_t format,
               const std::vector<uint8_t>& bytes) {
    png_image image = {};
    image.version = PNG_IMAGE_VERSION;
    image.width = width;
    image.height = height;
    image.format = format;
    if (!png_image_write_to_file(&image, path.c_str(), 0, bytes.data(), 0, nullptr))
        throw std::runtime_error(fmt::format("cannot write {}: {}", path.string(), image.message));
}

std::vector<uint8_t> srgb_bytes(const LinearImage& image) {
    std::vector<uint8_t> bytes(image.rgba.size());
    for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = i % 4 == 3 ? byte_of(image.rgba[i]) : srgb_byte(image.rgba[i]);
    return bytes;
}

struct Texels {
    std::vector<uint8_t> bytes;
    int64_t format;
    uint32_t width, height;
    LinearImage linear() const { return linear_image(bytes, format, width, height); }
};

Texels texels_of(const VulkanDevice& vulkan, const SubImage& image) {
    const Swapchain& swapchain = *image.swapchain;
    return {read_texels(vulkan, swapchain.images.images[*swapchain.released], swapchain.info.format, image.rect,
                        image.array_layer),
            swapchain.info.format, static_cast<uint32_t>(image.rect.extent.width),
            static_cast<uint32_t>(image.rect.extent.height)};
}

// Copies 8-bit formats byte by byte, and converts half floats to sRGB.
void write_colour(const std::filesystem::path& path, const Texels& texels) {
    std::vector<uint8_t> bytes = texels.bytes;
    if (texels.format == VK_FORMAT_R16G16B16A16_SFLOAT) bytes = srgb_bytes(texels.linear());
    if (is_bgra(texels.format))
        for (size_t i = 0; i < bytes.size(); i += 4) std::swap(bytes[i], bytes[i + 2]);
    write_png(path, texels.width, texels.height, PNG_FORMAT_RGBA, bytes);
}

void write_depth(const std::filesystem::path& stem, const Texels& texels) {
    const LinearImage image = texels.linear();
    std::vector<uint8_t> grey;
    std::vector<float> depths;
    for (size_t i = 0; i < image.rgba.size(); i += 4) {
        grey.push_back(byte_of(image.rgba[i]));
        depths.push_back(image.rgba[i]);
    }
    write_png(stem.string() + ".png", texels.width, texels.height, PNG_FORMAT_GRAY, grey);
    std::ofstream stream(stem.string() + ".bin", std::ios::binary);
    stream.write(reinterpret_cast<const char*>(depths.data()),
                 static_cast<std::streamsize>(depths.size() * sizeof(float)));
    if (!stream) throw std::runtime_error("cannot write " + stem.string() + ".bin");
}

}  // namespace

uint8_t srgb_byte(float linear) {
    const float value = std::clamp(linear, 0.0f, 1.0f);
    return byte_of(value <= 0.0031308f ? value * 12.92f : 1.055f * std::pow(value, 1 / 2.4f) - 0.055f);
}

LinearImage linear_image(const std::vector<uint8_t>& texels, int64_t format, uint32_t width, uint32_t height) {
    LinearImage image = {width, height, std::vector<float>(size_t{width} * height * 4)};
    const size_t step = bytes_per_texel(format);
    for (size_t i = 0; i < size_t{width} * height; ++i) decode(&texels[i * step], format, &image.rgba[i * 4]);
    return image;
}

namespace {

// Writes colour and depth of a view, and returns its colour.
LinearImage save_view(const VulkanDevice& vulkan, const ProjectionView& view, const std::filesystem::path& stem,
                      const std::string& layer) {
    const Texels texels = texels_of(vulkan, view.colour);
    write_colour(stem.string() + layer + ".png", texels);
    if (view.depth) write_depth(stem.string() + "_depth", texels_of(vulkan, *view.depth));
    return texels.linear();
}

}  // namespace

void save_images(const VulkanDevice& vulkan, const Frame& frame, const std::vector<Layer>& layers,
                 XrEnvironmentBlendMode blend) {
    const std::filesystem::path folder = runtime().report.folder;
    const char* const kEyes[] = {"left", "right"};
    for (uint32_t eye = 0; eye < 2; ++eye) {
        const std::filesystem::path stem = folder / fmt::format("frame_{:04}_{}", frame.index, kEyes[eye]);
        std::vector<LinearImage> images(layers.size()), narrow(layers.size());
        int quads = 0, projections = 0;
        for (size_t i = 0; i < layers.size(); ++i) {
            const Layer& layer = layers[i];
            if (layer.is_quad()) {
                const Texels texels = texels_of(vulkan, layer.image);
                images[i] = texels.linear();
                if (eye == 0) write_colour(folder / fmt::format("frame_{:04}_quad{}.png", frame.index, quads), texels);
                ++quads;
            }
            if (!layer.is_projection()) continue;
            // A second projection layer must not overwrite the files of the first.
            const std::string number = projections ? fmt::format("_layer{}", projections) : "";
            images[i] = save_view(vulkan, layer.views[eye], stem, number);
            if (layer.views.size() > 2)
                narrow[i] = save_view(vulkan, layer.views[2 + eye], stem.string() + "_narrow", number);
            ++projections;
        }
        const LinearImage seen = compose(layers, images, narrow, eye, frame.display_time, blend);
        write_png(stem.string() + "_seen.png", seen.width, seen.height, PNG_FORMAT_RGBA, srgb_bytes(seen));
    }
}

}  // namespace neuvv::xr_runtime
