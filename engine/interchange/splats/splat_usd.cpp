#include "interchange/splats/splat_usd.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <string>

#include "base/platform.h"

namespace neuvv::interchange {

namespace {

constexpr float kReach = 3;  // deviations that count as inside the extent

using Element = std::function<void(const Splat& splat, std::string& text)>;

void append_vector(const glm::vec3& v, std::string& text) {
    fmt::format_to(std::back_inserter(text), "({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z);
}

// "[a, b, …]", one element or several of each splat.
std::string array_text(const Splats& splats, const Element& element) {
    std::string text = "[";
    for (const Splat& splat : splats.splats) {
        if (text.size() > 1) text += ", ";
        element(splat, text);
    }
    return text + "]";
}

// Writes "type name = value", or samples of it at the frames.
class Attributes {
  public:
    Attributes(std::span<const Splats> frames, const ByteSink& sink) : frames_(frames), sink_(sink) {}
    void write(const std::string& name, const std::function<std::string(const Splats&)>& value,
               const std::string& metadata = "") const {
        const bool is_still = frames_.size() == 1;
        const auto samples = [&] {
            print(fmt::format("        {}.timeSamples = {{\n", name));
            for (size_t i = 0; i < frames_.size(); ++i)
                print(fmt::format("            {}: {},\n", i, value(frames_[i])));
            print("        }\n");
        };
        // Metadata belong to the attribute's declaration.
        if (is_still) print(fmt::format("        {} = {}{}\n", name, value(frames_[0]), metadata));
        if (!is_still && !metadata.empty()) print(fmt::format("        {}{}\n", name, metadata));
        if (!is_still) samples();
    }
    void write_elements(const std::string& name, const Element& element, const std::string& metadata = "") const {
        write(
            name, [&](const Splats& splats) { return array_text(splats, element); }, metadata);
    }
    void print(const std::string& text) const { sink_(text.data(), text.size()); }

  private:
    std::span<const Splats> frames_;
    const ByteSink& sink_;
};

std::string extent_text(const Splats& splats) {
    glm::vec3 low(0), high(0);
    for (size_t i = 0; i < splats.splats.size(); ++i) {
        const Splat& splat = splats.splats[i];
        const glm::vec3 reach(kReach * glm::length(splat.deviation));
        low = i == 0 ? splat.centre - reach : glm::min(low, splat.centre - reach);
        high = i == 0 ? splat.centre + reach : glm::max(high, splat.centre + reach);
    }
    std::string text = "[";
    append_vector(low, text);
    text += ", ";
    append_vector(high, text);
    return text + "]";
}

}  // namespace

size_t usda_bytes_of_splat(uint32_t degree) {
    return 115 + size_t{36} * sh_count(degree);
}

void write_splat_usda(const std::filesystem::path& file, std::span<const Splats> frames, double fps,
                      const glm::dvec3& origin) {
    const uint32_t degree = frames[0].degree, count = sh_count(degree);
    write_file_atomically(file, [&](const ByteSink& sink) {
        const Attributes attributes(frames, sink);
        attributes.print(
            fmt::format("#usda 1.0\n(\n    defaultPrim = \"Clip\"\n    metersPerUnit = 1\n    upAxis = \"Y\"\n"
                        "    startTimeCode = 0\n    endTimeCode = {}\n    timeCodesPerSecond = {:.9g}\n)\n\n"
                        "def Xform \"Clip\" (\n    kind = \"component\"\n)\n{{\n",
                        frames.size() - 1, fps));
        if (origin != glm::dvec3(0))
            attributes.print(
                fmt::format("    double3 xformOp:translate = ({:.15g}, {:.15g}, {:.15g})\n"
                            "    uniform token[] xformOpOrder = [\"xformOp:translate\"]\n",
                            origin.x, origin.y, origin.z));
        attributes.print("    def ParticleField3DGaussianSplat \"Splats\"\n    {\n");
        attributes.write("float3[] extent", extent_text);
        attributes.write_elements("point3f[] positions",
                                  [](const Splat& s, std::string& text) { append_vector(s.centre, text); });
        attributes.write_elements("quatf[] orientations", [](const Splat& s, std::string& text) {
            const glm::quat& r = s.rotation;
            fmt::format_to(std::back_inserter(text), "({:.6g}, {:.6g}, {:.6g}, {:.6g})", r.w, r.x, r.y, r.z);
        });
        attributes.write_elements("float3[] scales",
                                  [](const Splat& s, std::string& text) { append_vector(s.deviation, text); });
        attributes.write_elements("float[] opacities", [](const Splat& s, std::string& text) {
            fmt::format_to(std::back_inserter(text), "{:.5g}", s.opacity);
        });
        attributes.print(fmt::format("        uniform int radiance:sphericalHarmonicsDegree = {}\n", degree));
        attributes.write_elements(
            "float3[] radiance:sphericalHarmonicsCoefficients",
            [&](const Splat& s, std::string& text) {
                for (uint32_t k = 0; k < count; ++k) {
                    if (k > 0) text += ", ";
                    append_vector(s.colour[k], text);
                }
            },
            fmt::format(" (\n            elementSize = {}\n            interpolation = \"vertex\"\n        )", count));
        attributes.print(
            "        uniform token projectionModeHint = \"perspective\"\n"
            "        uniform token sortingModeHint = \"cameraDistance\"\n    }\n}\n");
    });
}

}  // namespace neuvv::interchange
