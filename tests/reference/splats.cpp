#include "reference/splats.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "reference/hh.h"

namespace neuvv::reference {

namespace {

double phase(int m) {
    return m % 2 == 0 ? 1 : -1;  // Condon-Shortley
}

glm::dvec3 colour_of(const GaussianSplat& splat, const glm::dvec3& direction) {
    const auto degree = static_cast<uint32_t>(std::lround(std::sqrt(splat.sh.size()))) - 1;
    const std::vector<double> basis = sh_basis(degree, direction);
    glm::dvec3 sum(0.5);
    for (int l = 0; l <= static_cast<int>(degree); ++l)
        for (int m = -l; m <= l; ++m) sum += phase(m) * basis[sh_index(l, m)] * splat.sh[sh_index(l, m)];
    return glm::max(sum, glm::dvec3(0));
}

// The splat on the image: its centre and the inverse of its covariance.
struct Projected {
    glm::dvec2 centre;
    glm::dmat2 inverse;
};

Projected project(const GaussianSplat& splat, const glm::dvec3& at, const SplatCamera& camera) {
    const glm::dmat3 r = glm::mat3_cast(glm::normalize(splat.rotation));
    const glm::dmat3 s(splat.scale.x, 0, 0, 0, splat.scale.y, 0, 0, 0, splat.scale.z);
    const glm::dmat3 sigma = r * s * glm::transpose(s) * glm::transpose(r);
    const glm::dmat3 w = camera.camera_from_world;
    const glm::dmat3 seen = w * sigma * glm::transpose(w);
    const glm::dvec3 jx(camera.fx / at.z, 0, -camera.fx * at.x / (at.z * at.z));
    const glm::dvec3 jy(0, camera.fy / at.z, -camera.fy * at.y / (at.z * at.z));
    const glm::dmat2 covariance(glm::dot(jx, seen * jx) + 0.3, glm::dot(jx, seen * jy), glm::dot(jy, seen * jx),
                                glm::dot(jy, seen * jy) + 0.3);
    return {{camera.cx + camera.fx * at.x / at.z, camera.cy + camera.fy * at.y / at.z}, glm::inverse(covariance)};
}

}  // namespace

std::vector<GaussianSplat> read_splats(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::string line;
    std::map<std::string, size_t> columns;
    size_t count = 0;
    while (std::getline(in, line) && line != "end_header") {
        std::istringstream words(line);
        std::string word, type, name;
        words >> word;
        if (word == "element") words >> type >> count;
        if (word == "property") {
            words >> type >> name;
            EXPECT_EQ(type, "float") << line;
            const size_t column = columns.size();
            columns[name] = column;
        }
    }
    EXPECT_EQ(line, "end_header") << file;
    std::vector<GaussianSplat> splats;
    std::vector<float> row(columns.size());
    const auto value = [&](const std::string& name) { return double{row.at(columns.at(name))}; };
    size_t rest = 0;
    while (columns.contains("f_rest_" + std::to_string(rest))) ++rest;
    for (size_t i = 0; i < count; ++i) {
        in.read(reinterpret_cast<char*>(row.data()), static_cast<std::streamsize>(row.size() * sizeof(float)));
        GaussianSplat splat;
        splat.position = {value("x"), value("y"), value("z")};
        splat.scale = glm::exp(glm::dvec3(value("scale_0"), value("scale_1"), value("scale_2")));
        splat.rotation = glm::dquat(value("rot_0"), value("rot_1"), value("rot_2"), value("rot_3"));
        splat.opacity = 1 / (1 + std::exp(-value("opacity")));
        splat.sh.push_back({value("f_dc_0"), value("f_dc_1"), value("f_dc_2")});
        for (size_t k = 0; k < rest / 3; ++k) {
            glm::dvec3 one;
            for (size_t c = 0; c < 3; ++c)
                one[static_cast<int>(c)] = value("f_rest_" + std::to_string(c * (rest / 3) + k));
            splat.sh.push_back(one);
        }
        splats.push_back(splat);
    }
    EXPECT_TRUE(in.good() && in.peek() == std::ifstream::traits_type::eof()) << file;
    return splats;
}

std::vector<glm::dvec3> draw_splats(std::vector<GaussianSplat> splats, const SplatCamera& camera,
                                    const glm::dvec3& background) {
    const auto in_camera = [&](const GaussianSplat& splat) {
        return camera.camera_from_world * (splat.position - camera.position);
    };
    std::sort(splats.begin(), splats.end(),
              [&](const GaussianSplat& a, const GaussianSplat& b) { return in_camera(a).z < in_camera(b).z; });
    std::vector<glm::dvec3> pixels(static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height),
                                   glm::dvec3(0));
    std::vector<double> transmittance(pixels.size(), 1);
    for (const GaussianSplat& splat : splats) {
        const glm::dvec3 at = in_camera(splat);
        if (at.z < 0.01) continue;
        const Projected on_image = project(splat, at, camera);
        const glm::dvec3 colour = colour_of(splat, glm::normalize(splat.position - camera.position));
        for (size_t i = 0; i < pixels.size(); ++i) {
            const auto width = static_cast<size_t>(camera.width);
            const glm::dvec2 pixel(static_cast<double>(i % width) + 0.5, static_cast<double>(i / width) + 0.5);
            const glm::dvec2 d = pixel - on_image.centre;
            const double alpha = std::min(0.99, splat.opacity * std::exp(-0.5 * glm::dot(d, on_image.inverse * d)));
            if (alpha < 1 / 255.0) continue;
            pixels[i] += transmittance[i] * alpha * colour;
            transmittance[i] *= 1 - alpha;
        }
    }
    for (size_t i = 0; i < pixels.size(); ++i)
        pixels[i] = glm::min(pixels[i] + transmittance[i] * background, glm::dvec3(1));
    return pixels;
}

}  // namespace neuvv::reference
