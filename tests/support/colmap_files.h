// Writes sparse models in COLMAP's two file formats.
#pragma once

#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace neuvv::test {

struct ColmapSample {
    struct Camera {
        int id, model;
        std::string model_name;
        uint64_t width, height;
        std::vector<double> parameters;
    };
    struct Image {
        int id;
        std::array<double, 7> pose;  // camera from world: w x y z, translation
        int camera;
        std::string name;
    };
    std::vector<Camera> cameras;
    std::vector<Image> images;
    std::vector<std::array<double, 3>> points;
};

template <typename T>
void append(std::string& bytes, T value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

inline std::string binary_cameras(const ColmapSample& sample) {
    std::string bytes;
    append(bytes, uint64_t{sample.cameras.size()});
    for (const auto& camera : sample.cameras) {
        append(bytes, int32_t{camera.id});
        append(bytes, int32_t{camera.model});
        append(bytes, camera.width);
        append(bytes, camera.height);
        for (const double parameter : camera.parameters) append(bytes, parameter);
    }
    return bytes;
}

inline std::string binary_images(const ColmapSample& sample) {
    std::string bytes;
    append(bytes, uint64_t{sample.images.size()});
    for (const auto& image : sample.images) {
        append(bytes, int32_t{image.id});
        for (const double number : image.pose) append(bytes, number);
        append(bytes, int32_t{image.camera});
        bytes += image.name + '\0';
        append(bytes, uint64_t{1});
        append(bytes, 1.5);
        append(bytes, 2.5);
        append(bytes, int64_t{-1});
    }
    return bytes;
}

inline std::string binary_points(const ColmapSample& sample) {
    std::string bytes;
    append(bytes, uint64_t{sample.points.size()});
    for (size_t i = 0; i < sample.points.size(); ++i) {
        append(bytes, uint64_t{i});
        for (const double coordinate : sample.points[i]) append(bytes, coordinate);
        bytes += std::string("\xff\x80\x00", 3);
        append(bytes, 0.5);
        append(bytes, uint64_t{2});
        for (const int32_t number : {1, 0, 2, 0}) append(bytes, number);
    }
    return bytes;
}

inline std::string text_cameras(const ColmapSample& sample) {
    std::string text = "# Camera list with one line of data per camera:\n";
    for (const auto& camera : sample.cameras) {
        text += fmt::format("{} {} {} {}", camera.id, camera.model_name, camera.width, camera.height);
        for (const double parameter : camera.parameters) text += fmt::format(" {}", parameter);
        text += '\n';
    }
    return text;
}

// Every other image sees no point: its second line is empty.
inline std::string text_images(const ColmapSample& sample) {
    std::string text = "# Image list with two lines of data per image:\n";
    for (size_t i = 0; i < sample.images.size(); ++i) {
        const auto& image = sample.images[i];
        text += fmt::format("{} {} {} {}\n{}\n", image.id, fmt::join(image.pose, " "), image.camera, image.name,
                            i % 2 == 0 ? "1.5 2.5 -1" : "");
    }
    return text;
}

inline std::string text_points(const ColmapSample& sample) {
    std::string text = "# 3D point list with one line of data per point:\n";
    for (size_t i = 0; i < sample.points.size(); ++i)
        text += fmt::format("{} {} 255 128 0 0.5 1 0 2 0\n", i, fmt::join(sample.points[i], " "));
    return text;
}

inline void write_colmap(const std::filesystem::path& folder, const ColmapSample& sample, bool binary) {
    const char* ending = binary ? ".bin" : ".txt";
    const auto write = [&](const char* stem, const std::string& content) {
        write_text(folder / (std::string(stem) + ending), content);
    };
    write("cameras", binary ? binary_cameras(sample) : text_cameras(sample));
    write("images", binary ? binary_images(sample) : text_images(sample));
    if (!sample.points.empty()) write("points3D", binary ? binary_points(sample) : text_points(sample));
}

}  // namespace neuvv::test
