// neuvv publish: writes a clip, or a performer of a stage with its paint, as a stream: small enough for a rate, or good
// enough for a quality; alone, or in a folder with a page that plays it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "base/error.h"
#include "base/formats/json.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "base/threads/parallel.h"
#include "stream/transport/byte_source.h"
#include "stream/transport/nvs_writer.h"
#include "tools/commands.h"
#include "tools/compared_views.h"
#include "tools/publish/published_scene.h"
#include "tools/publish/web_page.h"
#include "tools/report.h"
#include "tools/results.h"
#include "tools/say.h"
#include "voctree/files/clip.h"
#include "voctree/files/clip_sound.h"
#include "voctree/files/occupied_box.h"
#include "voctree/files/world_frame.h"
#include "voctree/tree_slice.h"

namespace neuvv::tools {

namespace {

struct PublishOptions {
    std::string scene, performer, output, web, size = "480x270";  // either `output` or `web`
    double quality = 47, group_s = 0.5;
    std::optional<double> rate_mbps;
    uint32_t views = 6;
    bool json = false;
    std::optional<voctree::UpAxis> up;
    std::string encoding;  // an option that was given of those that say how a stream is encoded
    // Where the stream is when all is done.
    std::filesystem::path stream() const {
        return web.empty() ? std::filesystem::path(output) : std::filesystem::path(web) / kPageStream;
    }
};

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

struct Published {
    uint64_t bytes = 0;
    std::optional<double> psnr{};  // of the worst compared image, where a quality was asked for
    double most_mbps = 0;          // of a group
};

class Publisher {
  public:
    Publisher(const PublishOptions& options, const PublishedScene& scene, const CommonOptions& common,
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
        published_.psnr = 99;
    }
    Published publish();

  private:
    void publish_segment(const voctree::ClipSegment& segment, stream::Writer& writer);
    int strength_for_quality(const voctree::VOctree& tree, std::span<const voctree::PaintStep> paint,
                             const std::filesystem::path& file);
    int strength_for_rate(const std::vector<stream::QuantisedSlice>& slices) const;
    void expect_to_go_on() const {
        if (stop_requested())
            throw RuntimeFailure(fmt::format("{}: stopped before the end", options_.stream().string()));
    }
    const PublishOptions& options_;
    const PublishedScene& scene_;
    std::filesystem::path output_;
    Progress progress_;
    uint32_t group_frames_ = 1;
    stream::CaptureFrame capture_;
    std::optional<gpu::Device> device_;
    Published published_;
};

// Only frames that a view shows are encoded, each as a key frame.
int Publisher::strength_for_quality(const voctree::VOctree& tree, std::span<const voctree::PaintStep> paint,
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
    published_.psnr = std::min(*published_.psnr, kept);
    return *strength;
}

// The finest whose bytes fit into the rate, or else the coarsest.
int Publisher::strength_for_rate(const std::vector<stream::QuantisedSlice>& slices) const {
    const double seconds = static_cast<double>(slices.size()) / double{scene_.index.fps};
    const auto too_large = largest_strength([&](int strength) {
        expect_to_go_on();
        const uint64_t bytes =
            stream::bytes_of(encode_group(slices, strength)).count() + stream::header_bytes(1, slices.size());
        return 8e-6 * static_cast<double>(bytes) / seconds > *options_.rate_mbps;
    });
    return too_large ? std::min(*too_large + 1, kStepSizes - 1) : 0;
}

void Publisher::publish_segment(const voctree::ClipSegment& segment, stream::Writer& writer) {
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
        published_.most_mbps =
            std::max(published_.most_mbps,
                     8e-6 * static_cast<double>(bytes) * double{scene_.index.fps} / static_cast<double>(slices.size()));
        progress_.update(segment.first + first + slices.size());
    }
}

Published Publisher::publish() {
    catch_stop_signals();
    uint32_t groups = 0;
    for (const voctree::ClipSegment& segment : scene_.index.segments)
        groups += (segment.frames + group_frames_ - 1) / group_frames_;
    stream::Writer writer(output_, scene_.index.fps, scene_.index.frames(), groups, capture_);
    for (const voctree::ClipSegment& segment : scene_.index.segments) publish_segment(segment, writer);
    published_.bytes = writer.finish();
    progress_.finish();
    return published_;
}

// The sound that goes along with the clip; nothing where it has none, or where it is that of the output already.
std::optional<std::filesystem::path> sound_to_copy(const std::filesystem::path& clip,
                                                   const std::filesystem::path& output) {
    const auto sound = voctree::sound_beside(clip);
    std::error_code error;
    if (!sound || std::filesystem::equivalent(*sound, voctree::sound_file(output), error)) return std::nullopt;
    prepare_result("--output", voctree::sound_file(output));
    return sound;
}

// As it is.
void copy_sound(const std::optional<std::filesystem::path>& sound, const std::filesystem::path& output) {
    if (!sound) return;
    const std::filesystem::path to = voctree::sound_file(output);
    const media::SoundFile file = voctree::sound_here(*sound);
    const std::vector<uint8_t> bytes = file.bytes ? *file.bytes : read_file(file.path);
    write_file_atomically(to, [&](const ByteSink& sink) { sink(bytes.data(), bytes.size()); });
}

// Writes the stream, and its sound beside it.
Published publish_stream(const PublishOptions& options, const PublishedScene& scene, const CommonOptions& common,
                         const std::filesystem::path& output) {
    const auto sound = sound_to_copy(scene.clip, output);
    const Published published = Publisher(options, scene, common, output).publish();
    copy_sound(sound, output);
    return published;
}

bool is_stream(const PublishedScene& scene) {
    return voctree::kind_of(scene.clip) == voctree::ClipKind::kStream;
}

// A stream is copied as it is: nothing of it can be chosen.
void expect_copyable(const PublishOptions& options, const std::filesystem::path& stream) {
    if (stream::is_address(stream))
        throw InputError(stream.string(), "", "is on a server", "download it, and its sound beside it");
    if (!options.encoding.empty())
        throw InputError(options.encoding, stream.string(), "is a stream, which is copied as it is",
                         "leave the option out");
}

// With its sound.
Published copy_stream(const std::filesystem::path& stream, const std::filesystem::path& output) {
    std::error_code error;
    std::filesystem::copy_file(stream, output, error);
    if (error) throw RuntimeFailure(fmt::format("{}: cannot be written: {}", output.string(), error.message()));
    copy_sound(sound_to_copy(stream, output), output);
    return {std::filesystem::file_size(output)};
}

Published publish_page(const PublishOptions& options, const PublishedScene& scene, const CommonOptions& common) {
    if (is_stream(scene)) expect_copyable(options, scene.clip);
    const UnfinishedWebPage page(options.web, find_web_player(), voctree::sound_beside(scene.clip).has_value());
    const Published published = is_stream(scene) ? copy_stream(scene.clip, page.stream())
                                                 : publish_stream(options, scene, common, page.stream());
    const std::string name = scene.stage ? scene.stage->performers[scene.performer].name : "";
    page.finish(name.empty() ? scene.clip.stem().string() : name);
    return published;
}

void report(const PublishOptions& options, const PublishedScene& scene, const Published& published) {
    const std::string stream = options.stream().string(),
                      page = (std::filesystem::path(options.web) / "index.html").string();
    const uint32_t frames = scene.index.frames();
    const double bytes_per_frame = static_cast<double>(published.bytes) / frames;
    const double mbps = 8e-6 * bytes_per_frame * double{scene.index.fps};
    if (options.rate_mbps && published.most_mbps > *options.rate_mbps)
        say("{}: --rate {:g} is not reached: a group takes up to {:.3g} Mbit/s, though rounded as coarsely as is "
            "possible; fewer leaves take less (--max-leaves of `neuvv train`)\n",
            stream, *options.rate_mbps, published.most_mbps);
    if (options.json) {
        nlohmann::ordered_json json = {{"input", options.scene}, {"output", stream}};
        if (!options.web.empty()) json.update({{"web", options.web}, {"page", page}});
        json.update(
            {{"bytes", published.bytes}, {"frames", frames}, {"bytes_per_frame", bytes_per_frame}, {"mbps", mbps}});
        if (!scene.layers.empty()) json["paint_layers"] = scene.layers.size();
        if (options.rate_mbps) json["most_mbps"] = published.most_mbps;
        if (published.psnr) json["psnr_db"] = *published.psnr;
        tell("{}", json_text(json));
        return;
    }
    const std::string quality = published.psnr ? fmt::format("; the worst image has {:.1f} dB", *published.psnr) : "";
    const std::string paint =
        scene.layers.empty() ? "" : fmt::format("; visible layers of paint: {}", scene.layers.size());
    tell("{}: {} for {} frames, {:.0f} KB each, {:.1f} Mbit/s{}{}\n", stream, size_text(published.bytes), frames,
         bytes_per_frame / 1000, mbps, quality, paint);
    if (!options.web.empty()) tell("{} plays it from any file server: tools/serve {}\n", page, options.web);
}

void run(const PublishOptions& options, const CommonOptions& common) {
    const bool alone = options.web.empty();
    if (alone && std::filesystem::path(options.output).extension() != ".nvs")
        throw InputError("--output", options.output, "does not end with .nvs", "name it so");
    if (alone) prepare_result("--output", options.output);
    const PublishedScene scene = read_published_scene(options.scene, options.performer, options.up);
    if (alone) voctree::expect_no_stream(scene.clip);
    report(options, scene,
           alone ? publish_stream(options, scene, common, options.output) : publish_page(options, scene, common));
}

}  // namespace

void add_publish(Command app, CommonOptions& common) {
    Command verb = app.add_verb("publish", "Write a clip as a stream: a quarter of the bytes or less, to be played");
    const auto options = std::make_shared<PublishOptions>();
    verb.add_option("scene", options->scene,
                    "The .nvv, in segments or not, the .npz of a PlenOctree, or a stage, .gltf or .glb; for --web "
                    "also a .nvs")
        .required();
    verb.add_option("--performer", options->performer,
                    "Of a stage: which, by its name or index; may be left out where there is one");
    Command result = verb.add_group("What is written");
    result.add_option("-o,--output", options->output, "The .nvs to write");
    result.add_option("--web", options->web,
                      "A folder to write for any file server: the stream, and a page that plays it in browsers");
    result.require_options(1, 1);
    add_up_option(verb, options->up);
    Option rate = verb.add_option("--rate", options->rate_mbps, "Mbit/s, which every group of frames keeps to")
                      .number_between(0.01, 1e5);
    verb.add_option("--quality", options->quality,
                    "In place of it, PSNR in dB that images keep at least, against the clip's own, painted")
        .number_between(10, 60)
        .excludes(rate)
        .show_default();
    verb.add_option("--group", options->group_s, "Seconds of frames that are played without any before them")
        .number_between(0.01, 60)
        .show_default();
    verb.add_option("--views", options->views, "Images that are compared, over one orbit as the clip plays")
        .in_range(1, 100)
        .show_default();
    verb.add_option("--size", options->size, "WIDTHxHEIGHT of them").show_default();
    verb.add_flag("--json", options->json,
                  "Print JSON: output, page, bytes, frames, bytes_per_frame, mbps, most_mbps (of a group), psnr_db, "
                  "paint_layers");
    verb.footer(
        {"A stream has every frame as it is shown. It is played as the clip is, but it cannot be trained on or "
         "painted,\nand between two frames it shows the nearer one. Segments that overlap do not fade into each other "
         "there.\n--quality is measured on frames by themselves; that frames repeat what stays is not.\n"
         "Of a stage, a performer's clip is written with the visible layers of its paint in it. Nothing else of the "
         "stage\ngoes along: neither transform, time map, lights nor opacity, nor the performer's own sound; the "
         "clip's sound does.\n"
         "--web takes the player for browsers that tools/web/build has made (`tools/install-packages web` installs "
         "what that\nneeds), and copies a .nvs as it is.\n",
         kDeviceHelp, kExamplesHead,
         "  neuvv publish work/performer.nvv -o work/performer.nvs\n"
         "  neuvv publish work/performer.nvv -o work/phone.nvs --rate 10\n"
         "  neuvv publish work/phone.nvs --web work/web\n"
         "  neuvv render work/performer.nvs -o work/turn.mp4\n"
         "  neuvv info https://example.com/performer.nvs\n"
         "  neuvv stage new work/show.gltf\n"
         "  neuvv stage add work/show.gltf work/performer.nvv --name anna\n"
         "  neuvv paint region work/show.gltf work/anna.nvpaint --node anna --box -1,0,-1,1,0.9,1 --hue 120\n"
         "  neuvv publish work/show.gltf --performer anna -o work/anna.nvs"});
    verb.callback([options, verb, &common] {
        for (const char* name : {"--rate", "--quality", "--group", "--views", "--size"})
            if (verb.count(name) > 0) options->encoding = name;
        run(*options, common);
    });
}

}  // namespace neuvv::tools
