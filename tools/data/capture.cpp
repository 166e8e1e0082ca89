// neuvv capture: renders an animated model into a multi-view data set.
#include <fmt/format.h>

#include <memory>

#include "base/error.h"
#include "base/platform.h"
#include "gpu/device.h"
#include "tools/commands.h"
#include "tools/options.h"
#include "tools/report.h"
#include "tools/say.h"
#include "tools/unfinished_folder.h"
#include "training/capture/capture.h"

namespace neuvv::tools {

namespace {

constexpr const char* kFooter = R"(
Images go to DIR/images/cNN_fNNN.png, cameras to DIR/transforms_train.json and transforms_test.json. An earlier capture
there is replaced with --overwrite, once this one is whole.
Where the model is a person, its joints go to DIR/skeleton.glb (`neuvv skeleton --help`).
Frame i shows the animation at i / fps seconds; an animation that ends earlier keeps its last pose, a model without
animation shows its rest pose. There are no lights: unlit materials show their base colour, others get a soft sky.

--background clear    straight-alpha images: the performer alone
--background checker  the image as a camera in a checkered room sees it, alpha the matte, plus DIR/plates/cNN.png

--studio SEED simulates the cameras of a real studio in that room, and the mistakes of its people, to try how training
copes. A lamp above casts the performer's soft shadow on the floor. Each camera has sensor noise, channel gains of 0.7
to 1.4, vignetting, and JPEG of quality 85; mattes are in DIR/mattes. The recordings of two cameras are exchanged, two
cameras have a wrong plate or none, and 1 % of the mattes lack a part or show too much. DIR/studio.json says what was
done to each camera. Held-out cameras stay as with --background checker, so that `neuvv eval` measures against the
truth.

--videos, with one of the two, leaves what recorders leave: DIR/videos/cNN.mp4 in place of images, and no mattes.
`neuvv matte` then makes them, of held-out cameras, too.

Examples (from the repository's root):
  neuvv capture tools/performer/performer.glb -o work/performer
  neuvv capture tools/performer/performer.glb -o work/small --cameras 12 --frames 10 --size 160x160
  neuvv capture tools/performer/performer.glb -o work/checker --cameras 8 --frames 5 --background checker
  neuvv capture tools/performer/performer.glb -o work/studio --cameras 12 --frames 24 --size 128x128 --studio 1
  neuvv capture tools/performer/performer.glb -o work/videos --cameras 14 --frames 24 --studio 1 --videos)";

struct Options {
    std::string model, folder, size = "512x512", background = "clear";
    training::CaptureSettings settings;
};

void run_capture(Options& options, const CommonOptions& common) {
    training::CaptureSettings& settings = options.settings;
    const media::ImageSize size = parse_size(options.size);
    settings.width = size.width;
    settings.height = size.height;
    if (options.background != "clear" && options.background != "checker")
        throw InputError("capture", "--background", fmt::format("\"{}\" is not known", options.background),
                         "choose clear or checker");
    if (options.background == "checker") settings.background = training::CaptureBackground::kChecker;
    if (settings.videos && !settings.studio && options.background == "clear")
        throw InputError("capture", "--videos", "need a background that `neuvv matte` tells from the performer",
                         "add --background checker or --studio SEED");
    const UnfinishedFolder unfinished(options.folder);
    catch_stop_signals();
    const gpu::Device device(common.device);
    Progress progress("capture");
    const training::CaptureResult result =
        training::capture(device, options.model, unfinished.path(), settings, [&](uint64_t done, uint64_t total) {
            progress.set_total(total);
            progress.update(done, "images");
            return done == total || !stop_requested();
        });
    progress.finish();
    say_notes(options.model, result.notes);
    if (!result.complete) throw RuntimeFailure("stopped before the end; nothing was written");
    unfinished.finish();
    if (!result.no_skeleton.empty()) say("no {}: {}\n", training::kTrueSkeleton, result.no_skeleton);
    tell("{}: {} images, {} train and {} test cameras\n", options.folder, result.images, result.train_cameras,
         result.test_cameras);
}

}  // namespace

void add_capture(Command app, CommonOptions& common) {
    Command verb = app.add_verb("capture", "Render an animated glTF model into a multi-view data set");
    const auto options = std::make_shared<Options>();
    training::CaptureSettings& settings = options->settings;
    verb.add_option("MODEL", options->model, "the model, .glb or .gltf").required();
    verb.add_option("-o,--output", options->folder, "the data set's folder; created").required();
    verb.add_option("--cameras", settings.cameras, "cameras of the dome, in four rings").show_default();
    verb.add_option("--frames", settings.frames, "frames to capture").show_default();
    verb.add_option("--fps", settings.fps, "frames a second").show_default();
    verb.add_option("--size", options->size, "of the images, WxH pixels").show_default();
    verb.add_option("--animation", settings.animation, "its name or index; default: the first");
    verb.add_option("--holdout", settings.holdout, "share of the cameras kept for the test").show_default();
    verb.add_option("--background", options->background, "clear or checker").show_default();
    verb.add_option("--studio", settings.studio, "seed of a simulated studio: real cameras, and mistakes")
        .not_negative();
    verb.add_flag("--videos", settings.videos, "write a video of each camera, without mattes, in place of images");
    verb.footer({kFooter});
    verb.callback([options, &common] { run_capture(*options, common); });
}

}  // namespace neuvv::tools
