// neuvv matte: finds the part of each image that shows the performer, for captures without mattes.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <memory>
#include <set>
#include <utility>

#include "base/error.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "tools/commands.h"
#include "tools/options.h"
#include "tools/remedies.h"
#include "tools/report.h"
#include "tools/results.h"
#include "tools/say.h"
#include "tools/unfinished_folder.h"
#include "training/data/both_splits.h"
#include "training/data/layouts/formats.h"
#include "training/data/matte_sources.h"
#include "training/mattes/make_mattes.h"
#include "training/mattes/matte_model.h"

namespace neuvv::tools {

namespace {

constexpr const char* kMatteFooter = R"(
The background of a camera is its clean plate (plates/CAMERA.png, or a video there), or else, per pixel, the median of
up to 31 of its images: right where the performer stands for less than half of the clip. With five cameras and more,
what one camera lacks is taken from the others, and what it alone sees is left out. Each matte is an 8-bit grey PNG
named after its image; correct those that are wrong in any image editor: `neuvv train` and `eval` read them.
OUTPUT/contact_sheet.png shows image, matte, and the performer over magenta, worst cameras first.

--model runs a network with OpenCV, on the processor, and keeps its soft alpha. Networks are known by the names and
sizes of their inputs and outputs; any other sees RGB of 0 to 1. Robust Video Matting sees each camera's images in
order, and remembers; Background Matting V2 also sees the camera's background. OpenCV 4.6 opens few files that leave
sizes open: export those with fixed sizes, Robust Video Matting with a fixed downsample_ratio, too. NeuVV comes with no
network. A network is a program: use only those that you trust.

Examples:
  neuvv matte studio
  neuvv matte studio --threshold 20 --overwrite
  neuvv matte studio --model rvm_mobilenetv3.onnx
  neuvv matte studio --from rotoscoped)";

// Throws InputError where mattes, which have the names of images, would take the place of images or of other mattes.
void expect_other_folder(const training::MatteJob& what) {
    std::set<std::filesystem::path> folders{what.from};
    for (const training::Split split : {training::Split::kTrain, training::Split::kTest}) {
        try {
            for (const training::Shot& shot : training::read_rig(what.dataset, split, what.format).shots)
                folders.insert(shot.image.path.parent_path());
        } catch (const InputError&) {  // make_mattes says what is wrong
        }
    }
    std::error_code error;
    for (const std::filesystem::path& folder : folders)
        if (std::filesystem::equivalent(folder, what.output, error) && !error)
            throw InputError("--output", what.output.string(),
                             "holds what mattes are made of, and they would replace it", "choose another folder");
}

struct MatteOptions {
    training::MatteJob what;
    bool overrule = false;
};

// Mattes that this verb makes overrule what a data set has, and are worse than most of it.
void expect_no_mattes(const training::MatteJob& what) {
    std::vector<std::string> sources =
        training::matte_sources(training::read_both_splits(what.dataset, what.format).rigs);
    std::erase(sources, "mattes/");  // of which --overwrite decides
    if (!sources.empty())
        throw InputError(what.dataset.string(), "",
                         fmt::format("has mattes already, {}, which new ones would overrule in training", sources[0]),
                         "leave it as it is, or give --overrule");
}

// A camera whose mattes lack more of what the other cameras show, or show so much more, is worth a look.
constexpr double kWorthALook = 0.1;
constexpr double kWhiteBorders = 0.5;  // no performer fills more of the borders of all images

// What to do where no matte shows anybody.
const char* remedy_of_nothing(const training::MatteJob& what) {
    if (!what.model.empty()) return "export the network anew, or use another one";
    return what.from.empty() ? "lower --threshold, or give clean plates" : "--invert takes black for white";
}

// Throws InputError where mattes are of no use, so that they are not to be written.
void expect_a_performer(const MatteOptions& options, const training::MatteSummary& made) {
    const training::MatteJob& what = options.what;
    const std::string source = what.from.empty() ? what.dataset.string() : what.from.string();
    if (!made.shows_performer)
        throw InputError(source, "", "no matte shows anything of a performer, so none was written",
                         remedy_of_nothing(what));
    if (options.overrule || what.from.empty() || made.white_borders <= kWhiteBorders) return;
    throw InputError(source, "",
                     fmt::format("{:.0f} % of the images' borders would be white, as if white were the background, so "
                                 "no matte was written",
                                 100 * made.white_borders),
                     fmt::format("{}; or, where performers do fill them, --overrule",
                                 what.inverted ? "leave --invert out" : "give --invert, which takes black for white"));
}

void tell_findings(const training::MatteSummary& made) {
    for (const Note& plate : made.wrong_plates) say("{}\n", message_of(plate));
    for (const std::string& pair : made.swapped) say("{}\n", pair);
    if (!made.alone.empty()) say("each camera was looked at by itself: {}\n", message_of(made.alone));
    for (const training::CameraAgreement& camera : made.agreements) {
        if (camera.lacking > kWorthALook)
            say("camera {}: its mattes lack {:.0f} % of what the other cameras show there\n", camera.camera,
                100 * camera.lacking);
        if (camera.beyond > kWorthALook)
            say("camera {}: {:.0f} % of its mattes is nothing that the other cameras show\n", camera.camera,
                100 * camera.beyond);
    }
}

// Says which network it is, before it takes minutes. Throws InputError where it is none of mattes.
void tell_model(const std::filesystem::path& model) {
    const motion::OnnxFile onnx = motion::read_onnx_file(model);
    say("{}\n", training::text_of(training::find_matte_model(onnx), onnx));
}

void run_matte(MatteOptions options) {
    training::MatteJob& what = options.what;
    if (what.output.empty()) what.output = what.dataset / "mattes";
    expect_other_folder(what);
    if (!may_overwrite() && training::count_existing_mattes(what) > 0)
        throw InputError(what.output.string(), "", "holds mattes of this data set already, perhaps corrected by hand",
                         "--overwrite replaces them");
    if (!options.overrule) expect_no_mattes(what);
    if (!what.model.empty()) tell_model(what.model);
    const UnfinishedFiles unfinished(what.output);
    const std::filesystem::path output = std::exchange(what.output, unfinished.path());
    catch_stop_signals();
    Progress progress("matte");
    const training::MatteSummary made = training::make_mattes(what, [&](uint64_t done, uint64_t total) {
        progress.set_total(total);
        progress.update(done);
        return !stop_requested();
    });
    progress.finish();
    if (stop_requested()) throw RuntimeFailure("stopped before the end; the mattes are as they were before");
    expect_a_performer(options, made);
    unfinished.finish();
    if (!made.missing_split.empty())
        say("one split alone has mattes now, the other cannot be read: {}\n", message_of(made.missing_split));
    tell_findings(made);
    const bool seeks_plates = what.from.empty() && what.model.empty();  // a network need not
    const std::string plates = seeks_plates || made.cameras_with_plate > 0
                                   ? fmt::format(" ({} with a clean plate)", made.cameras_with_plate)
                                   : "";
    tell("wrote {} mattes of {} cameras{} into {}; judge them by contact_sheet.png there\n", made.images, made.cameras,
         plates, output.string());
    if (!made.agreements.empty())
        tell("its rows, the cameras that agree least with the others first: {}\n", fmt::join(made.sheet, ", "));
    if (made.white_borders > kWhiteBorders)
        say("these mattes are white along the borders of the images: {}\n",
            what.model.empty() ? "raise --threshold, or give clean plates" : "look at them before you train");
}

}  // namespace

void add_matte(Command app, CommonOptions&) {
    auto options = std::make_shared<MatteOptions>();
    training::MatteJob& what = options->what;
    Command verb = app.add_verb("matte", "Find the performer in images that have no alpha");
    verb.add_option("dataset", what.dataset, "The data set's folder (see training/data/layouts/README.md)").required();
    add_format_option(verb, what.format);
    verb.add_option("-o,--output", what.output, "Folder of the mattes (default: DATASET/mattes, where training looks)");
    Option model = verb.add_option("--model", what.model,
                                   "Let a network make them, .onnx: of Robust Video Matting, Background Matting V2, "
                                   "BiRefNet, U²-Net, IS-Net, MODNet, or any that gives the alpha of one image");
    Option from =
        verb.add_option("--from", what.from,
                        "Take the mattes of another program instead (alpha, or else brightness): .png or .jpg named "
                        "as the images, in folders by camera or not, or a video CAMERA.mov, .webm, .mkv or .mp4")
            .excludes(model);
    verb.add_flag("--invert", what.inverted, "They are black where the performer is").needs(from);
    verb.add_option("--threshold", what.settings.threshold,
                    "What differs from the background by so many times the camera's noise is the performer")
        .number_between(1, 250)
        .show_default()
        .excludes(from)
        .excludes(model);
    verb.add_flag("--alone", what.alone,
                  "Judge each image by its camera's background alone, not by what the other cameras see, too")
        .excludes(from)
        .excludes(model);
    verb.add_flag(
        "--overrule", options->overrule,
        "Make mattes even of a data set that has masks, or images with an alpha: what is made counts instead");
    verb.footer({kMatteFooter});
    verb.callback([options] { run_matte(*options); });
}

}  // namespace neuvv::tools
