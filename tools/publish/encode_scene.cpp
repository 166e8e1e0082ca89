#include "tools/publish/encode_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/platform.h"
#include "base/threads/parallel.h"
#include "stream/transport/nvs_writer.h"
#include "tools/compared_views.h"
#include "tools/report.h"
#include "voctree/files/clip.h"
#include "voctree/files/occupied_box.h"
#include "voctree/files/world_frame.h"
#include "voctree/tree_slice.h"

namespace neuvv::tools {

namespace {

// How coarsely the coefficients are rounded: 4 more double the steps. At kUsualSteps, images of held-out cameras lose
// about 0.3 dB of 31.
constexpr int kStepSizes = 33, kUsualSteps = 16;

// Steps of the coefficients at kUsualSteps, by stream::Kind. Steps in other proportions lost more for the bytes that
// they save, or the same.
stream::Steps steps_of(int strength) {
    constexpr std::array<double, stream::kKinds> kSteps = {0.22, 0.066, 0.145, 0.145, 0.085, 0.185};
    const double scale = std::exp2((strength - kUsualSteps) / 4.0);
    stream::Steps steps{};
    for (size_t i = 0; i < steps.size(); ++i)
        steps[i] = static_cast<uint16_t>(std::clamp(std::lround(kSteps[i] * scale * stream::kUnit), 1l, 65535l));
    return steps;
}

// The largest strength for which `keeps` holds, which must hold for all below it; nothing where it holds for none.
std::optional<int> largest_strength(const std::function<bool(int)>& keeps) {
    std::optional<int> best;
    for (int low = 0, high = kStepSizes; low < high;) {
        const int strength = (low + high) / 2;
        const bool kept = keeps(strength);
        if (kept) best = strength;
        (kept ? low : high) = kept ? strength + 1 : strength;
    }
    return best;
}

std::vector<stream::FrameSymbols> encode_group(const std::vector<stream::QuantisedSlice>& slices, int strength) {
    std::vector<stream::FrameSymbols> frames;
    stream::QuantisedSlice decoded, before;
    for (size_t i = 0; i < slices.size(); ++i) {
        before = std::move(decoded);
        std::optional<stream::FrameBefore> frame_before;
        if (i > 0) frame_before.emplace(stream::FrameBefore{slices[i - 1], before});
        frames.push_back(stream::encode(slices[i], steps_of(strength), frame_before, decoded, parallel_for));
    }
    return frames;
}

// Around the leaves of all slices.
stream::BoxPart filled_part(const std::vector<stream::QuantisedSlice>& slices) {
    glm::dvec3 low(1), high(0);
    for (const stream::QuantisedSlice& slice : slices) {
        if (slice.leaves.empty()) continue;
        const auto [from, to] = voctree::occupied_box(voctree::leaf_positions(slice), glm::vec3(0), glm::vec3(1));
        low = glm::min(low, from);
        high = glm::max(high, to);
    }
    stream::BoxPart part;
    for (int axis = 0; axis < 3 && low.x < high.x; ++axis) {
        part.low[static_cast<size_t>(axis)] = static_cast<float>(low[axis]);
        part.high[static_cast<size_t>(axis)] = static_cast<float>(high[axis]);
    }
    return part;
}

class SceneEncoder {
  public:
    SceneEncoder(const EncodingOptions& options, const PublishedScene& scene, const CommonOptions& common,
                 std::filesystem::path output)
        : options_(options),
          scene_(scene),
          output_(std::move(output)),
          progress_("publish", scene.index.frames()),
          capture_(voctree::frame_for_stream(voctree::read_world_frame(scene.clip), scene.clip)) {
        group_frames_ = std::clamp(static_cast<uint32_t>(std::lround(options.group_s * double{scene.index.fps})), 1u,
                                   stream::kMaxGroupFrames);
        if (options.rate_mbps) return;
        device_.emplace(common.device);
        encoded_.psnr = 99;
    }
    EncodedStream encode();

  private:
    void encode_segment(const voctree::ClipSegment& segment, stream::Writer& writer);
    int strength_for_quality(const voctree::VOctree& tree, std::span<const voctree::PaintStep> paint,
                             const std::filesystem::path& file);
    int strength_for_rate(const std::vector<stream::QuantisedSlice>& slices) const;
    void expect_to_go_on() const {
        if (stop_requested()) throw RuntimeFailure(fmt::format("{}: stopped before the end", output_.string()));
    }
    const EncodingOptions& options_;
    const PublishedScene& scene_;
    std::filesystem::path output_;
    Progress progress_;
    uint32_t group_frames_ = 1;
    stream::CaptureFrame capture_;
    std::optional<gpu::Device> device_;
    EncodedStream encoded_;
};

// Only frames that a view shows are encoded, each as a key frame.
int SceneEncoder::strength_for_quality(const voctree::VOctree& tree, std::span<const voctree::PaintStep> paint,
                                       const std::filesystem::path& file) {
    if (tree.leaf_count == 0) return kUsualSteps;
    ComparedViews views(*device_, tree, parse_size(options_.size), options_.views);
    views.round_frames();
    const std::vector<media::Image> truth = views.render(tree, paint);
    std::vector<stream::QuantisedSlice> slices;
    for (size_t i = 0; i < views.count(); ++i)
        slices.push_back(slice::quantised(voctree::slice_of(tree, static_cast<uint32_t>(views.frame_of(i)), paint)));
    double last = 0, kept = 0;
    const auto strength = largest_strength([&](int one) {
        expect_to_go_on();
        last = 99;
        for (size_t i = 0; i < slices.size(); ++i) {
            stream::QuantisedSlice decoded;
            stream::encode(slices[i], steps_of(one), {}, decoded, parallel_for);
            const media::Image image = views.render_still(
                voctree::tree_of(slice::values_of(decoded, tree.box_min, tree.box_size), tree.fps), i);
            last = std::min(last, worst_psnr({truth[i]}, {image}));
        }
        if (last >= options_.quality) kept = last;
        return last >= options_.quality;
    });
    if (!strength)
        throw InputError(file.string(), "",
                         fmt::format("the finest steps show {:.1f} dB, not {:.1f}", last, options_.quality),
                         fmt::format("ask for --quality {:.0f}", std::floor(last)));
    encoded_.psnr = std::min(*encoded_.psnr, kept);
    return *strength;
}

// The finest whose bytes fit into the rate, or else the coarsest.
int SceneEncoder::strength_for_rate(const std::vector<stream::QuantisedSlice>& slices) const {
    const double seconds = static_cast<double>(slices.size()) / double{scene_.index.fps};
    const auto too_large = largest_strength([&](int strength) {
        expect_to_go_on();
        const uint64_t bytes =
            stream::bytes_of(encode_group(slices, strength)).count() + stream::header_bytes(1, slices.size());
        return 8e-6 * static_cast<double>(bytes) / seconds > *options_.rate_mbps;
    });
    return too_large ? std::min(*too_large + 1, kStepSizes - 1) : 0;
}

void SceneEncoder::encode_segment(const voctree::ClipSegment& segment, stream::Writer& writer) {
    const voctree::VOctree tree = voctree::read_segment(segment);
    const SegmentLayers paint = read_segment_layers(scene_, segment, tree);
    int strength = options_.rate_mbps ? 0 : strength_for_quality(tree, paint.steps, segment.file);
    for (uint32_t first = 0; first < segment.frames; first += group_frames_) {
        std::vector<stream::QuantisedSlice> slices;
        for (uint32_t i = first; i < std::min(first + group_frames_, segment.frames); ++i) {
            expect_to_go_on();
            slices.push_back(slice::quantised(voctree::slice_of(tree, i, paint.steps)));
        }
        if (options_.rate_mbps) strength = strength_for_rate(slices);
        stream::Group group;
        group.format = {slices[0].depth, slices[0].degree, 0};
        for (const stream::QuantisedSlice& slice : slices)
            group.format.most_leaves = std::max(group.format.most_leaves, static_cast<uint32_t>(slice.leaves.size()));
        for (int axis = 0; axis < 3; ++axis) {
            group.box_min[static_cast<size_t>(axis)] = tree.box_min[axis];
            group.box_size[static_cast<size_t>(axis)] = tree.box_size[axis];
        }
        group.filled = filled_part(slices);
        if (group.format.most_leaves > stream::kMaxStreamLeaves)
            throw InputError(segment.file.string(), fmt::format("frame {}", first), "has too many leaves for a stream",
                             "train it with a smaller --resolution");
        const uint64_t bytes = writer.add(group, encode_group(slices, strength));
        encoded_.most_mbps = std::max(encoded_.most_mbps, 8e-6 * static_cast<double>(bytes) * double{scene_.index.fps} /
                                                              static_cast<double>(slices.size()));
        progress_.update(segment.first + first + slices.size());
    }
}

EncodedStream SceneEncoder::encode() {
    catch_stop_signals();
    uint32_t groups = 0;
    for (const voctree::ClipSegment& segment : scene_.index.segments)
        groups += (segment.frames + group_frames_ - 1) / group_frames_;
    stream::Writer writer(output_, scene_.index.fps, scene_.index.frames(), groups, capture_);
    for (const voctree::ClipSegment& segment : scene_.index.segments) encode_segment(segment, writer);
    encoded_.bytes = writer.finish();
    progress_.finish();
    return encoded_;
}

}  // namespace

void add_encoding_options(Command verb, EncodingOptions& options) {
    Option rate =
        verb.add_option("--rate", options.rate_mbps, "Of a stream: Mbit/s, which every group of frames keeps to")
            .number_between(0.01, 1e5);
    verb.add_option("--quality", options.quality,
                    "In place of it, PSNR in dB that images keep at least, against the clip's own, painted")
        .number_between(10, 60)
        .excludes(rate)
        .show_default();
    verb.add_option("--group", options.group_s,
                    "Of a stream: seconds of frames that are played without any before them")
        .number_between(0.01, 60)
        .show_default();
}

EncodedStream encode_scene(const EncodingOptions& options, const PublishedScene& scene, const CommonOptions& common,
                           const std::filesystem::path& output) {
    return SceneEncoder(options, scene, common, output).encode();
}

}  // namespace neuvv::tools
