#include "training/data/both_splits.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "training/data/layouts/formats.h"

namespace neuvv::training {

BothSplits read_both_splits(const std::filesystem::path& folder, const std::string& format,
                            const std::string& holdout) {
    BothSplits both;
    std::optional<InputError> first;
    for (const Split split : {Split::kTrain, Split::kTest}) try {
            both.rigs.push_back(read_rig(folder, split, format, holdout));
            both.splits.push_back(split);
        } catch (const InputError& error) {
            if (!first) first = error;
            both.missing = Note(error);
        }
    if (both.rigs.empty()) throw *first;
    return both;
}

void add_validation(BothSplits& both, const std::filesystem::path& folder, const std::string& format) {
    if (!has_validation(folder, format)) return;
    try {
        both.rigs.push_back(read_rig(folder, Split::kVal, format));
        both.splits.push_back(Split::kVal);
    } catch (const InputError& error) {
        both.rigs.front().remarks.push_back(fmt::format("the validation cannot be read: {}", error.what()));
    }
}

namespace {

std::vector<double> times_of(const BothSplits& both) {
    std::set<double> times;
    for (const Rig& rig : both.rigs)
        for (const Shot& shot : rig.shots) times.insert(shot.time);
    return {times.begin(), times.end()};
}

}  // namespace

size_t frame_count(const BothSplits& both) {
    return times_of(both).size();
}

void keep_frames(BothSplits& both, size_t first, size_t last) {
    const std::vector<double> times = times_of(both);
    const double begin = times.at(first), end = times.at(last);
    for (Rig& rig : both.rigs)
        std::erase_if(rig.shots, [&](const Shot& shot) { return shot.time < begin || shot.time > end; });
    if (both.splits.back() == Split::kVal && both.rigs.back().shots.empty()) {
        both.rigs.pop_back();
        both.splits.pop_back();
    }
    for (Rig& rig : both.rigs) {
        if (rig.shots.empty())
            throw InputError(rig.file, "", fmt::format("has no image of the frames {} to {} in one split", first, last),
                             "choose others");
        for (Shot& shot : rig.shots) shot.time = end > begin ? (shot.time - begin) / (end - begin) : 0;
        drop_cameras_without_shots(rig);
    }
}

void expect_distinct_names(const std::vector<Rig>& rigs, const std::string& folder, const std::string& taken) {
    std::map<std::string, const ImageSource*> names;
    for (const Rig& rig : rigs)
        for (const Shot& shot : rig.shots) {
            const auto [other, fresh] = names.try_emplace(shot.name, &shot.image);
            const bool same =
                other->second->path == shot.image.path && other->second->video_frame == shot.image.video_frame;
            if ((!fresh && !same) || shot.name == taken)
                throw InputError(rig.file, shot.place,
                                 fmt::format("two files would be called {}.png in {}", shot.name, folder),
                                 "give the images distinct names");
        }
}

}  // namespace neuvv::training
