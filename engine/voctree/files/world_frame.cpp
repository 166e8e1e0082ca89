#include "voctree/files/world_frame.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>

#include "base/error.h"
#include "voctree/files/chunk_file.h"
#include "voctree/files/clip.h"
#include "voctree/files/clip_index.h"
#include "voctree/kinds/stream_source.h"

namespace neuvv::voctree {

namespace {

constexpr char kChunkName[] = "wRLD";
using FrameNumbers = std::array<double, 4>;  // origin, unit: 4 f64

void expect_sound(const WorldFrame& world, const std::string& file, const std::string& place) {
    bool sound = world.unit >= kMinWorldUnit && world.unit <= kMaxWorldUnit;
    for (int i = 0; i < 3; ++i) sound &= std::abs(world.origin[i]) <= kMaxWorldDistance;
    if (!sound) throw InputError(file, place, "says no place of a capture", "write the file again");
}

WorldFrame frame_in_file(const std::filesystem::path& path) {
    ChunkReader file(path);
    ChunkHeader chunk;
    while (file.next(chunk)) {
        if (chunk.name != kChunkName) {
            file.skip(false);
            continue;
        }
        FrameNumbers numbers{};
        std::memcpy(numbers.data(), file.take(sizeof numbers).data(), sizeof numbers);
        const WorldFrame world{{numbers[0], numbers[1], numbers[2]}, numbers[3]};
        expect_sound(world, file.path(), std::string("chunk ") + kChunkName);
        return world;
    }
    return {};
}

double power_of_ten(int exponent) {
    return std::pow(10.0, exponent);
}

WorldFrame frame_of_stream(const stream::CaptureFrame& frame) {
    WorldFrame world{glm::dvec3(0), power_of_ten(frame.unit)};
    for (int i = 0; i < 3; ++i) world.origin[i] = frame.origin[static_cast<size_t>(i)] * power_of_ten(frame.step);
    return world;
}

}  // namespace

ChunkOfFrame::ChunkOfFrame(const WorldFrame& frame) {
    if (frame.is_same()) return;
    const FrameNumbers numbers = {frame.origin.x, frame.origin.y, frame.origin.z, frame.unit};
    chunks_.push_back({kChunkName, std::vector<uint8_t>(sizeof numbers)});
    std::memcpy(chunks_[0].bytes.data(), numbers.data(), sizeof numbers);
}

std::vector<NvvChunkView> ChunkOfFrame::views() const {
    std::vector<NvvChunkView> views;
    for (const NvvChunk& chunk : chunks_) views.emplace_back(chunk);
    return views;
}

WorldFrame read_world_frame(const std::filesystem::path& clip) {
    switch (kind_of(clip)) {
        case ClipKind::kStream: {
            const WorldFrame world = frame_of_stream(open_stream(clip)->index().capture);
            expect_sound(world, clip.string(), "header");
            return world;
        }
        case ClipKind::kSegments:
            for (const ClipSegment& segment : read_clip_index(clip).segments)
                if (content_of(segment.file) == FileContent::kClip) return frame_in_file(segment.file);
            return {};
        case ClipKind::kNvv:
            return content_of(clip) == FileContent::kClip ? frame_in_file(clip) : WorldFrame{};
        case ClipKind::kPlenoctree:
            return {};
    }
    throw std::logic_error("a kind of clip without a frame");
}

stream::CaptureFrame frame_for_stream(const WorldFrame& frame, const std::filesystem::path& clip) {
    constexpr int kMost = stream::CaptureFrame::kMostExponent;
    stream::CaptureFrame said;
    said.unit = static_cast<int16_t>(std::lround(std::log10(frame.unit)));
    for (int step = kMost; step >= -kMost; --step) {
        const glm::dvec3 steps = glm::round(frame.origin / power_of_ten(step));
        if (glm::any(glm::greaterThan(glm::abs(steps), glm::dvec3(INT32_MAX)))) break;
        said.step = static_cast<int16_t>(step);
        for (int i = 0; i < 3; ++i) said.origin[static_cast<size_t>(i)] = static_cast<int32_t>(steps[i]);
        if (frame_of_stream(said) == frame) return said;
    }
    throw InputError(clip.string(), "", "has an origin or a unit in its capture that no stream can say",
                     Remedy::kLookAtOrigin);
}

}  // namespace neuvv::voctree
