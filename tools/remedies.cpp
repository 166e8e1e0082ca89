#include "tools/remedies.h"

#include <map>

namespace neuvv::tools {

namespace {

// The remedies that name an option or a verb; others are as plain_words() has them.
const std::map<Remedy, const char*> kWords = {
    {Remedy::kChooseDevice, "`neuvv devices` lists them"},
    {Remedy::kInstallDevice, "`neuvv devices` says what each lacks (mesa-vulkan-drivers brings a software device)"},
    {Remedy::kLeaveDeviceOut, "leave --device and NEUVV_DEVICE out"},
    {Remedy::kAfterDeviceLosses,
     "look at the driver's messages (dmesg), or choose another device by --device; unsaved edits are kept for "
     "recovery"},
    {Remedy::kFewerLeaves,
     "choose a clip of fewer leaves (--max-leaves of `neuvv train`), a smaller --size, or another device (`neuvv "
     "devices` lists them)"},
    {Remedy::kFewerLeavesOrStorage,
     "NEUVV_BUFFERS=storage reads them otherwise, or choose a clip of fewer leaves (--max-leaves of `neuvv train`)"},
    {Remedy::kSmallerImageOrOtherDevice, "choose a smaller --size, or another device (`neuvv devices` lists them)"},
    {Remedy::kLessDeviceMemory,
     "choose a smaller --size or --slice-budget, --far-levels off, or another device (`neuvv devices` lists them)"},
    {Remedy::kSmallerImage, "choose a smaller --size"},
    {Remedy::kSmallerImageOrFewerRays, "choose a smaller --size or --samples"},
    {Remedy::kCheaperBlend, "choose a smaller --size or --samples, or --blend paper"},
    {Remedy::kNoSlices, "show the scene without slices (--slice-budget 0)"},
    {Remedy::kFewerFrames, "export fewer --frames, or a file for each, as in out_%04d.glb"},
    {Remedy::kFewerSplats, "choose a lower --most-splats"},
    {Remedy::kFewerCells, "choose a smaller --resolution, or --box"},
    {Remedy::kRenderAnew, "render anew without --resume, or choose another --output"},
    {Remedy::kNameClip, "name a file that `neuvv train` wrote"},
    {Remedy::kNamePaint, "name a file that `neuvv paint` wrote"},
    {Remedy::kNamePaintFolder, "name a folder that `neuvv paint` made for this clip"},
    {Remedy::kNameStream, "name a .nvs of `neuvv publish`"},
    {Remedy::kMakeStage, "make a stage for it: `neuvv stage new`, then `neuvv stage add` or `paint`"},
    {Remedy::kOpenTrained, "open a folder that `neuvv train` writes into, a .nvv or a stage"},
    {Remedy::kWriteSkeletonAgain, "write the skeleton again with `neuvv skeleton`"},
    {Remedy::kLookAtOrigin,
     "streams take origins of up to nine digits, and powers of ten as the unit (`neuvv info` says them)"},
    {Remedy::kAddCamera, "the stage has none that is perspective: add one, or choose --orbit"},
    {Remedy::kGiveName, "give another name, of a performer by --name"},
    {Remedy::kGiveSound, "give it a --sound"},
    {Remedy::kChoosePerformer, "`neuvv stage info` lists them"},
    {Remedy::kMakeSkeleton,
     "make one with `neuvv skeleton extract` or `import`, or name it with `neuvv stage set --skeleton`"},
    {Remedy::kCountJoints, "`neuvv skeleton import` prints how many joints of a file are measured"},
    {Remedy::kUpIfLying, "--up=y if it lies"},
    {Remedy::kUpIfTrue, "--up={} if that axis is up"},
    {Remedy::kGiveUnit, "export its offsets, or give --unit"},
    {Remedy::kUnitIfWrong, "--unit or --height where that is wrong"},
    {Remedy::kMakeMattes, "run `neuvv matte {}`"},
    {Remedy::kMakeMattesOrGive,
     "run `neuvv matte {}`, or give RGBA PNGs whose alpha is 255 on the performer and 0 elsewhere; `neuvv train "
     "--background learn` takes images as they are, without a performer"},
    {Remedy::kMoreCameras, "choose a lower --holdout (0: none), or more cameras"},
    {Remedy::kMoreCamerasOrHoldNone, "give two cameras or more, or `--holdout 0`"},
    {Remedy::kMoreFilesOrHoldNone,
     "give two cameras or more, transforms_train.json and transforms_test.json, or `--holdout 0`"},
    {Remedy::kTrainAnew, "train without --resume"},
    {Remedy::kGoOnTraining, "{}, from which --resume goes on"},
    {Remedy::kMoreLeaves, "allow more, or choose a lower --resolution"},
    {Remedy::kLowerResolution, "choose a lower --resolution or --hh-degree"},
    {Remedy::kHigherResolution, "check that alpha is the matte, or raise --resolution"},
    {Remedy::kBeginWithHull, "begin with --init hull"},
    {Remedy::kTrainLonger, "train it longer, or begin with --init hull"},
    {Remedy::kNotAligned, "leave out --align"},
    {Remedy::kKeepTimes, "train without --refine time"},
};

std::string with_fix(const std::string& cause, const Fix& fix) {
    const auto found = kWords.find(fix.remedy);
    const std::string words =
        shortened(found == kWords.end() ? plain_words(fix) : with_value(found->second, fix.value));
    return words.empty() ? cause : cause + "; " + words;
}

}  // namespace

std::string message_of(const std::exception& error) {
    const auto* failure = dynamic_cast<const Failure*>(&error);
    if (failure == nullptr) return error.what();
    return with_fix((failure->is_about_setting() ? "--" : "") + failure->cause(), failure->fix());
}

std::string message_of(const Note& note) {
    return with_fix(note.text, note.fix);
}

}  // namespace neuvv::tools
