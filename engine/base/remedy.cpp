#include "base/remedy.h"

#include <cstddef>
#include <iterator>

namespace neuvv {

namespace {

struct Words {
    Remedy remedy;
    const char* words;
};

constexpr Words kWords[] = {
    {Remedy::kNone, ""},
    {Remedy::kChooseDevice, "choose one of the list of devices"},
    {Remedy::kInstallDevice, "the list of devices says what each lacks (mesa-vulkan-drivers brings a software device)"},
    {Remedy::kLeaveDeviceOut, "choose no device, also not by NEUVV_DEVICE"},
    {Remedy::kAfterDeviceLosses,
     "look at the driver's messages (dmesg), or choose another device; unsaved edits are kept for recovery"},
    {Remedy::kFewerLeaves, "choose a clip of fewer leaves, a smaller image, or another device"},
    {Remedy::kFewerLeavesOrStorage, "NEUVV_BUFFERS=storage reads them otherwise, or choose a clip of fewer leaves"},
    {Remedy::kSmallerImageOrOtherDevice, "choose a smaller image, or another device"},
    {Remedy::kLessDeviceMemory, "choose a smaller image, less memory for slices, no coarse levels, or another device"},
    {Remedy::kSmallerImage, "choose a smaller image"},
    {Remedy::kSmallerImageOrFewerRays, "choose a smaller image or fewer rays a pixel"},
    {Remedy::kCheaperBlend, "choose a smaller image, fewer rays a pixel, or the paper's blending"},
    {Remedy::kNoSlices, "show the scene without slices"},
    {Remedy::kFewerFrames, "export fewer frames, or a file for each, as in out_%04d.glb"},
    {Remedy::kFewerSplats, "choose fewer splats"},
    {Remedy::kFewerCells, "choose a lower resolution, or a smaller box"},
    {Remedy::kRenderAnew, "render anew, or choose another file"},
    {Remedy::kNameClip, "name a clip that was trained"},
    {Remedy::kNamePaint, "name a layer of paint"},
    {Remedy::kNamePaintFolder, "name a folder of paint on this clip"},
    {Remedy::kNameStream, "name a .nvs"},
    {Remedy::kMakeStage, "make a stage for it, and add it there"},
    {Remedy::kOpenTrained, "open a folder that a training writes into, a .nvv or a stage"},
    {Remedy::kWriteSkeletonAgain, "write the skeleton again"},
    {Remedy::kLookAtOrigin, "streams take origins of up to nine digits, and powers of ten as the unit"},
    {Remedy::kAddCamera, "the stage has none that is perspective: add one"},
    {Remedy::kGiveName, "give another name"},
    {Remedy::kGiveSound, "give it a sound"},
    {Remedy::kChoosePerformer, "choose one of its performers"},
    {Remedy::kMakeSkeleton, "make one of its clip or of a motion, or name its file in the stage"},
    {Remedy::kCountJoints, "look at how many joints of each file are measured"},
    {Remedy::kUpIfLying, "choose y as up if it lies"},
    {Remedy::kUpIfTrue, "choose {} as up if that axis is up"},
    {Remedy::kGiveUnit, "export its offsets, or give its unit"},
    {Remedy::kUnitIfWrong, "give its unit or the body's height where that is wrong"},
    {Remedy::kMakeMattes, "make mattes for {}"},
    {Remedy::kMakeMattesOrGive,
     "make mattes for {}, or give RGBA PNGs whose alpha is 255 on the performer and 0 elsewhere"},
    {Remedy::kMoreCameras, "hold fewer back or none, or choose more cameras"},
    {Remedy::kMoreCamerasOrHoldNone, "give two cameras or more, or hold none out"},
    {Remedy::kMoreFilesOrHoldNone,
     "give two cameras or more, transforms_train.json and transforms_test.json, or hold none out"},
    {Remedy::kTrainAnew, "train anew"},
    {Remedy::kGoOnTraining, "{}, from which the training can go on"},
    {Remedy::kMoreLeaves, "allow more, or choose a lower resolution"},
    {Remedy::kLowerResolution, "choose a lower resolution or degree of harmonics"},
    {Remedy::kHigherResolution, "check that alpha is the matte, or raise the resolution"},
    {Remedy::kBeginWithHull, "begin with the hull"},
    {Remedy::kTrainLonger, "train it longer, or begin with the hull"},
    {Remedy::kNotAligned, "do not align it"},
    {Remedy::kKeepTimes, "train without correcting times"},
};
static_assert(std::size(kWords) == static_cast<size_t>(Remedy::kCount), "each remedy has words");
static_assert(
    [] {
        for (size_t i = 0; i < std::size(kWords); ++i)
            if (kWords[i].remedy != static_cast<Remedy>(i)) return false;
        return true;
    }(),
    "words are in the order of remedies");

}  // namespace

std::string with_value(const char* words, const std::string& value) {
    std::string text = words;
    if (const size_t at = text.find("{}"); at != std::string::npos) text.replace(at, 2, value);
    return text;
}

std::string plain_words(const Fix& fix) {
    if (fix.remedy == Remedy::kNone) return fix.words;
    return with_value(kWords[static_cast<size_t>(fix.remedy)].words, fix.value);
}

}  // namespace neuvv
