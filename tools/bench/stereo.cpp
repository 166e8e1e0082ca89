// neuvv-bench stereo: the time of both eyes of a headset, at full resolution and with settings that save rays.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>

#include "base/platform.h"
#include "media/psnr.h"
#include "tools/bench/measure.h"
#include "tools/report.h"
#include "tools/view_path.h"
#include "voctree/files/clip.h"
#include "voctree/files/occupied_box.h"

namespace neuvv::bench {

namespace {

// How both eyes are drawn, and how long that took.
struct StereoVariant {
    std::string name;
    const char* key;  // in JSON
    double scale = 1;
    std::vector<render::Fovea> foveae;
    bool one_by_one = false;  // each eye in a frame of its own
    std::vector<double> ms;
    std::vector<PassSum> passes;
    double rays = 0;
    double psnr = 0;  // the lower one of both images, against the first variant
};

constexpr double kEyeDistance_m = 0.063;

// The eyes of an upright person one height of the performer away, with a horizontal angle of view of 90°.
std::vector<stage::Camera> eyes_before(const std::pair<glm::dvec3, glm::dvec3>& box, media::ImageSize size,
                                       double turn) {
    const glm::dvec3 centre = 0.5 * (box.first + box.second);
    const double away_m = box.second.y - box.first.y;
    const glm::dmat4 turned = glm::rotate(glm::translate(glm::dmat4(1), centre), turn, glm::dvec3(0, 1, 0));
    std::vector<stage::Camera> eyes;
    for (const double side : {-0.5, 0.5})
        eyes.push_back(tools::centred_camera(size, 0.5 * size.width,
                                             glm::translate(turned, glm::dvec3(side * kEyeDistance_m, 0, away_m))));
    return eyes;
}

// Returns the passes of both eyes.
std::vector<gpu::PassTime> draw(render::FrameRenderer& renderer, const std::vector<stage::Camera>& eyes,
                                const render::FrameSettings& settings, bool one_by_one) {
    if (!one_by_one) {
        renderer.draw(eyes, settings);
        return renderer.pass_times();
    }
    std::vector<gpu::PassTime> passes;
    for (const stage::Camera& eye : eyes) {
        renderer.draw({&eye, 1}, settings);
        const std::vector<gpu::PassTime> of_eye = renderer.pass_times();
        passes.insert(passes.end(), of_eye.begin(), of_eye.end());
    }
    return passes;
}

// A clip of 25 frames a second that plays on a display of 90 Hz; every slice is new.
struct Playing {
    std::vector<double> needed_ms,
        ahead_ms;  // per frame of the display; slices built when needed, or ahead
};

struct StereoResult {
    std::vector<StereoVariant> variants;
    Playing playing;
    double covered = 0;    // share of pixels
    double copy_tb_s = 0;  // bytes that a copy reads and writes, in TB/s
};

std::vector<StereoVariant> all_variants() {
    const render::Fovea inset{{0.3, 0.3}, {0.7, 0.7}, 0.4};
    return {{"both eyes in one dispatch", "stereo", 1, {}, false, {}, {}},
            {"one eye after the other", "one_by_one", 1, {}, true, {}, {}},
            {"inset of 40 %, beside it 0.4 rays a pixel's side", "foveated", 1, {inset, inset}, false, {}, {}},
            {"0.7 rays a pixel's side, upscaled", "scaled", 0.7, {}, false, {}, {}},
            {"0.5 rays a pixel's side, upscaled", "half", 0.5, {}, false, {}, {}}};
}

std::vector<media::Image> images_of(render::FrameRenderer& renderer, const std::vector<stage::Camera>& eyes,
                                    const render::FrameSettings& settings, bool one_by_one) {
    if (!one_by_one) return renderer.render_views(eyes, settings);
    std::vector<media::Image> images;
    for (const stage::Camera& eye : eyes) images.push_back(renderer.render(eye, settings));
    return images;
}

void measure(render::FrameRenderer& renderer, StereoVariant& variant, const std::vector<stage::Camera>& eyes,
             uint32_t repeats, std::vector<media::Image>& truth, StereoResult& result) {
    render::FrameSettings settings = play_settings({eyes[0].width, eyes[0].height});
    settings.scale = variant.scale;
    settings.foveae = variant.foveae;
    warm_up([&] { draw(renderer, eyes, settings, variant.one_by_one); });
    for (uint32_t i = 0; i < repeats && !stop_requested(); ++i) {
        const std::vector<gpu::PassTime> passes = draw(renderer, eyes, settings, variant.one_by_one);
        variant.ms.push_back(milliseconds(passes));
        add_image(variant.passes, passes);
    }
    const std::vector<media::Image> images = images_of(renderer, eyes, settings, variant.one_by_one);
    variant.rays = 2 * static_cast<double>(renderer.radiance().size());
    if (truth.empty()) {
        truth = images;
        const std::vector<glm::vec4> rays = renderer.radiance();
        result.covered = static_cast<double>(covered_rays(rays)) / static_cast<double>(rays.size());
    }
    variant.psnr = std::min(media::psnr_db(truth[0], images[0]), media::psnr_db(truth[1], images[1]));
}

std::vector<double> play(render::FrameRenderer& renderer, const std::vector<stage::Camera>& eyes, uint32_t clip_frames,
                         bool ahead) {
    constexpr double kClipFps = 25, kDisplayHz = 90;
    constexpr uint32_t kDisplayFrames = 72;
    render::FrameSettings settings = play_settings({eyes[0].width, eyes[0].height});
    warm_up([&] { renderer.draw(eyes, settings); });
    renderer.forget_slices();
    std::vector<double> ms;
    for (uint32_t i = 0; i < kDisplayFrames && !stop_requested(); ++i) {
        const auto frame = static_cast<uint32_t>(i * kClipFps / kDisplayHz);
        settings.instances[0].frame = static_cast<float>(frame % clip_frames);
        if (ahead) settings.next_instances = {{static_cast<float>((frame + 1) % clip_frames)}};
        renderer.draw(eyes, settings);
        if (i >= kDisplayHz / kClipFps)
            ms.push_back(milliseconds(renderer.pass_times()));  // the first slice cannot be built ahead
    }
    return ms;
}

StereoResult measure_all(const gpu::Device& device, const voctree::VOctree& tree, const BenchOptions& options) {
    const render::Field field = render::upload_field(device, tree, render::WeightPrecision::kHalf);
    const media::ImageSize size = tools::parse_size(options.size);
    const std::vector<stage::Camera> eyes = eyes_before(voctree::occupied_box(tree), size, 0.4);
    render::FrameRenderer renderer(device, field, {size.width, size.height, 1, 2});
    StereoResult result;
    result.variants = all_variants();
    std::vector<media::Image> truth;
    tools::Progress progress("bench", result.variants.size() + 2);
    for (size_t i = 0; i < result.variants.size() && !stop_requested(); ++i) {
        measure(renderer, result.variants[i], eyes, options.repeats, truth, result);
        progress.update(i + 1);
    }
    result.playing.needed_ms = play(renderer, eyes, tree.frames, false);
    progress.update(result.variants.size() + 1);
    result.playing.ahead_ms = play(renderer, eyes, tree.frames, true);
    progress.update(result.variants.size() + 2);
    result.copy_tb_s = 1e-12 * copied_bytes_per_second(device);
    return result;
}

double mrays_per_second(const StereoVariant& variant) {
    return variant.rays / median(variant.ms) / 1000;
}

void print(const StereoResult& result, const gpu::Device& device, const BenchOptions& options) {
    fmt::print("{}: {}, 2 x {}, {:.0f} % of the pixels covered, slices resident; a copy moves {:.3f} TB/s\n",
               device.summary().name, options.scene, options.size, 100 * result.covered, result.copy_tb_s);
    fmt::print("{:<50} {:>9} {:>9} {:>8} {:>16} {:>8}\n", "", "ms (p50)", "p99", "Mrays/s", "Mrays/s per TB/s", "PSNR");
    for (const StereoVariant& variant : result.variants)
        fmt::print("{:<50} {:>9} {:>9} {:>8.1f} {:>16.0f} {:>8}\n", variant.name, ms_text(median(variant.ms)),
                   ms_text(quantile(variant.ms, 0.99)), mrays_per_second(variant),
                   mrays_per_second(variant) / result.copy_tb_s,
                   variant.psnr > 90 ? "same" : fmt::format("{:.1f}", variant.psnr));
    const auto playing = [](const char* name, const std::vector<double>& ms) {
        fmt::print("{:<50} {:>9} {:>9}\n", name, ms_text(median(ms)), ms_text(quantile(ms, 0.99)));
    };
    playing("playing at 25 fps on 90 Hz, slices when needed", result.playing.needed_ms);
    playing("the same, slices built ahead", result.playing.ahead_ms);
    for (const StereoVariant& variant : result.variants)
        fmt::print("passes of {}: {} ms\n", variant.name, passes_text(variant.passes));
}

nlohmann::ordered_json json_of(const StereoResult& result) {
    auto variants = nlohmann::ordered_json::object();
    for (const StereoVariant& variant : result.variants)
        variants[variant.key] = {{"ms", median(variant.ms)}, {"p99_ms", quantile(variant.ms, 0.99)},
                                 {"rays", variant.rays},     {"mrays_per_second", mrays_per_second(variant)},
                                 {"psnr_db", variant.psnr},  {"passes_ms", passes_json(variant.passes)}};
    return {{"covered", result.covered},
            {"copy_tb_s", result.copy_tb_s},
            {"ways", variants},
            {"playing",
             {{"needed_p99_ms", quantile(result.playing.needed_ms, 0.99)},
              {"ahead_p99_ms", quantile(result.playing.ahead_ms, 0.99)}}}};
}

void run_stereo(const BenchOptions& options, const tools::CommonOptions& common) {
    catch_stop_signals();
    const voctree::VOctree tree = voctree::read_clip(options.scene, voctree::PlenoctreeColours::kAsStored);
    const gpu::Device device(common.device);
    const StereoResult result = measure_all(device, tree, options);
    expect_not_stopped();
    report(options, device, json_of(result), [&] { print(result, device, options); });
}

}  // namespace

void add_stereo(tools::Command app, const tools::CommonOptions& common) {
    auto [verb, options] =
        add_verb(app, common,
                 {"stereo",
                  "Both eyes of a headset",
                  "Draws the performer for two eyes that stand one height away and see 90 degrees, and prints "
                  "GPU time, rays a second,\nalso for each TB/s that a copy moves, and how far images of "
                  "fewer rays are from those of all.\n",
                  {"work/performer.nvv", "work/performer.nvv --size 1032x1104 --repeats 5"}},
                 run_stereo);
    options.size = "2064x2208";
    options.repeats = 20;
    add_size_option(verb, options, "WIDTHxHEIGHT of an eye");
    add_repeats_option(verb, options, "Frames that the medians are over");
    add_json_flag(verb, options);
}

}  // namespace neuvv::bench
