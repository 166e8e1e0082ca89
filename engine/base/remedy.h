// What a user can do about an error, as data: programs say it differently. A command line names its options, a window
// has buttons.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

namespace neuvv {

enum class Remedy : uint8_t {
    kNone,
    // Of the device.
    kChooseDevice,
    kInstallDevice,
    kLeaveDeviceOut,
    kAfterDeviceLosses,
    kFewerLeaves,  // or less to draw, or another device
    kFewerLeavesOrStorage,
    kSmallerImageOrOtherDevice,
    kLessDeviceMemory,
    kSmallerImage,
    kSmallerImageOrFewerRays,
    kCheaperBlend,
    kNoSlices,
    // Of what is written.
    kFewerFrames,
    kFewerSplats,
    kFewerCells,
    kRenderAnew,
    // Of what is read.
    kNameClip,
    kNamePaint,
    kNamePaintFolder,
    kNameStream,
    kMakeStage,
    kOpenTrained,
    kWriteSkeletonAgain,
    kLookAtOrigin,
    // Of stages.
    kAddCamera,
    kGiveName,
    kGiveSound,
    kChoosePerformer,
    // Of motions.
    kMakeSkeleton,
    kCountJoints,
    kUpIfLying,
    kUpIfTrue,  // with an axis
    kGiveUnit,
    kUnitIfWrong,
    // Of data sets.
    kMakeMattes,        // with the data set's folder
    kMakeMattesOrGive,  // with the data set's folder
    kMoreCameras,
    kMoreCamerasOrHoldNone,
    kMoreFilesOrHoldNone,
    // Of training.
    kTrainAnew,
    kGoOnTraining,  // with what to go on from
    kMoreLeaves,
    kLowerResolution,
    kHigherResolution,
    kBeginWithHull,
    kTrainLonger,
    kNotAligned,
    kKeepTimes,
    kCount,
};

// What to do about an error: words that hold in whatever program shows them, or a remedy.
struct Fix {
    std::string words;
    Remedy remedy = Remedy::kNone;
    std::string value;  // what the remedy is about

    Fix() = default;
    Fix(const char* said) : words(said) {}
    Fix(std::string said) : words(std::move(said)) {}
    Fix(Remedy chosen, std::string about = "") : remedy(chosen), value(std::move(about)) {}
    bool operator==(const Fix&) const = default;
};

// The fix in words that name no program's options; empty where there is none.
std::string plain_words(const Fix& fix);
// The words of a remedy, whose "{}" is the value.
std::string with_value(const char* words, const std::string& value);

}  // namespace neuvv
