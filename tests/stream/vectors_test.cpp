// The test vectors of the format's page: they are decoded as they always were. NEUVV_ACCEPT_VECTORS=1 writes them anew,
// after a change of the version.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/formats/json.h"
#include "stream/random_slice.h"
#include "stream/transport/nvs_reader.h"
#include "stream/transport/nvs_writer.h"

namespace neuvv::test::vectors_test {
namespace {

using stream::QuantisedSlice;

const std::filesystem::path kFolder = NEUVV_SOURCE_DIR "/tests/stream/vectors";

struct Vector {
    const char* name;
    uint32_t depth, degree, leaves;
    uint16_t step;
};
// The last has large coefficients, which need escapes.
constexpr Vector kVectors[] = {{"small", 2, 0, 20, 60}, {"usual", 6, 1, 250, 90}, {"fine", 8, 3, 60, 17}};

// Opacities up to 0 and 1 and beyond what is told apart, colours beyond what they are clamped to.
QuantisedSlice extreme_slice(uint64_t seed, const Vector& vector) {
    QuantisedSlice slice = random_slice(seed, vector.depth, vector.leaves, vector.degree);
    for (size_t plane = 0; plane < slice.planes.size(); ++plane)
        for (int16_t& value : slice.planes[plane])
            value = static_cast<int16_t>(plane == 0 ? std::clamp(3 * value - 1100, 1, stream::kUnit) : 9 * value);
    return slice;
}

// A key frame, one that repeats most of it, a key frame of its own group, and one without leaves.
void write_vector(const Vector& vector) {
    const QuantisedSlice first = extreme_slice(vector.depth, vector);
    QuantisedSlice second = first;
    for (size_t i = 0; i < second.leaves.size() / 4; ++i)
        for (auto& plane : second.planes) plane[i] = static_cast<int16_t>(1024 - plane[i]);
    QuantisedSlice none = first;
    none.leaves.clear();
    for (auto& plane : none.planes) plane.clear();
    const std::vector<std::vector<QuantisedSlice>> groups = {{first, second},
                                                             {extreme_slice(vector.depth + 1, vector), none}};
    stream::Steps steps;
    for (size_t i = 0; i < steps.size(); ++i) steps[i] = static_cast<uint16_t>(vector.step + 3 * i);
    stream::Writer writer(kFolder / fmt::format("{}.nvs", vector.name), 25, 4, 2);
    for (const std::vector<QuantisedSlice>& slices : groups) {
        std::vector<stream::FrameSymbols> frames;
        QuantisedSlice decoded, before;
        for (size_t i = 0; i < slices.size(); ++i) {
            before = std::move(decoded);
            std::optional<stream::FrameBefore> frame_before;
            if (i > 0) frame_before.emplace(stream::FrameBefore{slices[i - 1], before});
            frames.push_back(stream::encode(slices[i], steps, frame_before, decoded));
        }
        stream::Group group;
        group.format = {vector.depth, vector.degree, 1000};
        writer.add(group, frames);
    }
    writer.finish();
}

nlohmann::ordered_json json_of(const QuantisedSlice& slice) {
    auto leaves = nlohmann::ordered_json::array();
    for (const stream::Leaf& leaf : slice.leaves) leaves.push_back({leaf.cell, leaf.depth});
    return {{"leaves", leaves}, {"planes", slice.planes}};
}

TEST(StreamVectors, AreDecodedAsTheyAlwaysWere) {
    const bool accept = std::getenv("NEUVV_ACCEPT_VECTORS") != nullptr;
    for (const Vector& vector : kVectors) {
        if (accept) write_vector(vector);
        stream::Reader reader(kFolder / fmt::format("{}.nvs", vector.name));
        const auto frames = static_cast<uint32_t>(reader.index().frames.size());
        EXPECT_EQ(frames, 4u);
        nlohmann::ordered_json shown = {{"frames", nlohmann::ordered_json::array()},
                                        {"first_parts", nlohmann::ordered_json::array()}};
        for (uint32_t i = 0; i < frames; ++i) shown["frames"].push_back(json_of(*reader.frame(i)));
        for (const stream::Part last : {stream::kShape, stream::kCoarse, stream::kShCoarse, stream::kFine})
            shown["first_parts"].push_back(json_of(*reader.frame(0, last)));
        const std::filesystem::path file = kFolder / fmt::format("{}.json", vector.name);
        if (accept) std::ofstream(file) << shown.dump() << "\n";
        std::ifstream expected(file);
        ASSERT_TRUE(expected) << file;
        EXPECT_EQ(nlohmann::ordered_json::parse(expected), shown) << vector.name;
    }
}

}  // namespace
}  // namespace neuvv::test::vectors_test
