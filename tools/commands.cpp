#include "tools/commands.h"

#include "base/error.h"
#include "training/data/layouts/formats.h"
#include "voctree/files/clip.h"

namespace neuvv::tools {

Option add_switch(Command verb, const std::string& name, std::optional<bool>& value, const std::string& help) {
    return verb.add_option(name, value, help + ": on or off").one_of({"on", "off"});
}

Option add_samples_option(Command verb, uint32_t& samples) {
    return verb.add_option("--samples", samples, "Rays a pixel along each side: 2 averages 4 of them, for smooth edges")
        .in_range(1, 4)
        .show_default();
}

void add_far_levels_option(Command verb, std::optional<bool>& far_levels) {
    add_switch(
        verb, "--far-levels", far_levels,
        "Whether performers whose leaves look smaller than the distance between two rays, except for painted ones "
        "streams and clips whose frames share bases, are drawn from coarser levels of their tree, so that they do not "
        "shimmer (default: on)");
}

void add_slice_budget_option(Command verb, double& mebibytes) {
    verb.add_option("--slice-budget", mebibytes,
                    "MiB on the device for frames' slices that are kept, however many instances there are; less where "
                    "half of what it has left, or an eighth of its memory where it does not tell, is less; 0: no "
                    "slices, all numbers at each sample (slow). Frames of streams are slices, and take more")
        .number_between(0, 1048576)
        .show_default();
}

void add_format_option(Command verb, std::string& format) {
    verb.add_option("--format", format, "The data set's layout; auto: by the files in it")
        .one_of(training::format_names())
        .show_default();
}

void add_holdout_option(Command verb, std::string& holdout) {
    verb.add_option("--holdout", holdout,
                    "Which cameras are held out for the test: a number of them (0: none), a share (12.5%), both spread "
                    "evenly, or names (cam03,cam07). The same for train, eval and dataset (default: those that the "
                    "files name, else every 8th)");
}

void add_up_option(Command verb, std::optional<voctree::UpAxis>& up) {
    static constexpr const char* kNames[] = {"z", "y"};  // of UpAxis
    add_choice(verb, "--up", up, kNames,
               "Of a PlenOctree: its axis that is up, which its file does not say (default: z, as in volrend and the "
               "NeRF scenes). It is turned so that y is, as the cameras of such scenes are");
}

voctree::UpAxis up_of(const std::filesystem::path& clip, std::optional<voctree::UpAxis> up) {
    if (up && voctree::kind_of(clip) != voctree::ClipKind::kPlenoctree)
        throw InputError("--up", clip.string(), "is no PlenOctree, and its y is up", "leave it out");
    return up.value_or(voctree::UpAxis::kZ);
}

}  // namespace neuvv::tools
