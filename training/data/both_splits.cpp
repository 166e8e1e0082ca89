#include "training/data/both_splits.h"

#include <fmt/format.h>

#include <map>
#include <optional>

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
