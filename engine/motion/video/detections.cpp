// Which of a detector's files belongs to which image.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <compare>
#include <map>
#include <optional>
#include <set>

#include "base/error.h"
#include "motion/video/key_points.h"

namespace neuvv::motion {

namespace {

// What a folder contains, by name. Hidden files are the system's. Throws InputError where it cannot be read.
std::vector<std::filesystem::directory_entry> entries_of(const std::filesystem::path& folder) {
    std::vector<std::filesystem::directory_entry> entries;
    std::error_code error;
    for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
        if (!at->path().filename().string().starts_with('.')) entries.push_back(*at);
    if (error) throw InputError(folder.string(), "", "cannot be read: " + error.message());
    std::ranges::sort(entries);
    return entries;
}

std::vector<std::filesystem::path> json_files(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    std::error_code ignored;
    for (const auto& entry : entries_of(folder))
        if (entry.path().extension() == ".json" && entry.is_regular_file(ignored)) files.push_back(entry.path());
    return files;
}

// A name as its last number and what stands around that: "c03_f012_rgb" → "c03_f#_rgb", 12.
struct Key {
    std::string rest;
    int64_t number = -1;  // −1: it has none
    auto operator<=>(const Key&) const = default;
};

Key key_of(const std::string& name) {
    constexpr const char* kDigits = "0123456789";
    const size_t last = name.find_last_of(kDigits);
    if (last == std::string::npos) return {name, -1};
    const size_t begin = name.find_last_not_of(kDigits, last) + 1;  // npos + 1 is 0
    int64_t number = 0;
    const auto [end, error] = std::from_chars(name.data() + begin, name.data() + last + 1, number);
    if (error != std::errc()) return {name, -1};
    return {name.substr(0, begin) + "#" + name.substr(last + 1), number};
}

// What a detector saw in an image of a camera, or of any camera.
struct Seen {
    std::filesystem::path file;
    Key key;
    ImagePeople people;
};

// Files and images of which the former belong to the latter: of one camera, or all.
struct Group {
    std::filesystem::path place;  // the folder or the file, for errors
    std::vector<Seen> seen;
    std::vector<size_t> wanted;  // images
    bool by_number = false;      // the rest of a name does not count
};

std::string without_ending(std::string name, std::string_view ending) {
    if (name.ends_with(ending)) name.resize(name.size() - ending.size());
    return name;
}

void add_file(const std::filesystem::path& file, const KeyPointFile& read, std::vector<Seen>& seen) {
    for (const ImagePeople& image : read.images) seen.push_back({file, key_of(image.image), image});
}

std::map<std::string, std::vector<size_t>> images_by_camera(std::span<const WantedImage> images) {
    std::map<std::string, std::vector<size_t>> cameras;
    for (size_t i = 0; i < images.size(); ++i) cameras[images[i].camera].push_back(i);
    for (auto& [camera, list] : cameras) std::ranges::sort(list, {}, [&](size_t i) { return images[i].frame; });
    return cameras;
}

void expect_own_name(const std::filesystem::path& folder, const WantedImage& image, std::set<std::string>& names) {
    if (!names.insert(image.image).second)
        throw InputError(folder.string(), "", fmt::format("images of several cameras are called \"{}\"", image.image),
                         "give a folder for each camera: CAMERA_json");
}

// The files of a folder of them all.
std::vector<Group> flat_groups(const std::filesystem::path& folder, std::span<const WantedImage> images) {
    const auto cameras = images_by_camera(images);
    std::vector<Group> groups;
    Group all{folder, {}, {}, false};
    for (const std::filesystem::path& file : json_files(folder)) {
        const KeyPointFile read = read_key_points(file);
        const std::string name = image_of_key_points(file);
        const auto camera = cameras.find(name.starts_with("results_") ? name.substr(8) : name);
        if (read.of_many && camera != cameras.end())
            add_file(file, read, groups.emplace_back(Group{file, {}, camera->second, true}).seen);
        else
            add_file(file, read, all.seen);
    }
    if (all.seen.empty()) return groups;
    std::set<std::string> names;
    for (size_t i = 0; i < images.size(); ++i) {
        expect_own_name(folder, images[i], names);
        all.wanted.push_back(i);
    }
    groups.push_back(std::move(all));
    return groups;
}

// The files of a folder for each camera.
std::vector<Group> camera_groups(const std::filesystem::path& folder, std::span<const WantedImage> images,
                                 std::vector<std::string>& notes) {
    const auto cameras = images_by_camera(images);
    std::map<std::string, std::filesystem::path> folders;
    std::error_code ignored;
    for (const auto& entry : entries_of(folder)) {
        if (!entry.is_directory(ignored)) continue;
        const std::string name = without_ending(entry.path().filename().string(), "_json");
        if (const auto [other, added] = folders.emplace(name, entry.path()); !added)
            throw InputError(entry.path().string(), "", "is of the same camera as " + other->second.string(),
                             "remove one of them");
    }
    const bool by_order = !folders.empty() && folders.size() == cameras.size() &&
                          std::ranges::none_of(folders, [&](const auto& one) { return cameras.contains(one.first); });
    if (by_order)
        notes.push_back(fmt::format("{}: no folder bears a camera's name, so they are taken in order, {} for {}",
                                    folder.string(), folders.begin()->first, cameras.begin()->first));
    std::vector<Group> groups;
    for (const auto& [name, path] : folders) {
        const auto camera =
            by_order ? std::next(cameras.begin(), static_cast<std::ptrdiff_t>(groups.size())) : cameras.find(name);
        if (camera == cameras.end())
            throw InputError(path.string(), "", "belongs to none of these cameras",
                             fmt::format("remove it, or name it like its camera: {}_json", cameras.begin()->first));
        groups.push_back({path, {}, camera->second, true});
        for (const std::filesystem::path& file : json_files(path))
            add_file(file, read_key_points(file), groups.back().seen);
    }
    return groups;
}

class Matcher {
  public:
    Matcher(std::span<const WantedImage> images, std::vector<Group> groups, std::vector<std::string>& notes)
        : images_(images), groups_(std::move(groups)), notes_(notes) {
        for (Group& group : groups_)
            std::ranges::stable_sort(group.seen, {}, [](const Seen& seen) { return seen.key.number; });
    }

    // By image, what was seen in it; null: it has no file.
    std::vector<const Seen*> match() {
        std::vector<const Seen*> found(images_.size(), nullptr);
        const int64_t shift = fits(0) ? 0 : likely_shift();
        if (shift != 0)
            notes_.push_back(
                fmt::format("key points are numbered from {}, images from {}: the first of each belong together",
                            first_seen(), first_wanted()));
        else if (first_wanted() >= 0 && first_seen() > first_wanted())
            notes_.push_back(fmt::format("no camera has key points of the images {} to {}: files are numbered from {}",
                                         first_wanted(), first_seen() - 1, first_seen()));
        for (const Group& group : groups_) {
            if (const auto images = by_number(group, shift))
                for (size_t i = 0; i < group.seen.size(); ++i) found[(*images)[i]] = &group.seen[i];
            else
                by_order(group, shift, found);
        }
        return found;
    }

  private:
    Key wanted_key(const Group& group, size_t image) const {
        Key key = key_of(images_[image].image);
        if (group.by_number) key.rest.clear();
        return key;
    }

    // The image of each file; nothing where one has none, or not one of its own.
    std::optional<std::vector<size_t>> by_number(const Group& group, int64_t shift) const {
        std::map<Key, size_t> wanted;
        for (const size_t image : group.wanted)
            if (!wanted.emplace(wanted_key(group, image), image).second) return std::nullopt;
        std::vector<size_t> found;
        std::set<size_t> taken;
        for (const Seen& seen : group.seen) {
            Key key = seen.key;
            if (group.by_number) key.rest.clear();
            if (key.number >= 0) key.number += shift;
            const auto image = wanted.find(key);
            if (image == wanted.end() || !taken.insert(image->second).second) return std::nullopt;
            found.push_back(image->second);
        }
        return found;
    }

    bool fits(int64_t shift) const {
        return std::ranges::all_of(groups_, [&](const Group& group) { return by_number(group, shift).has_value(); });
    }

    int64_t first_seen() const {
        int64_t first = INT64_MAX;
        for (const Group& group : groups_)
            for (const Seen& seen : group.seen) first = std::min(first, seen.key.number);
        return first == INT64_MAX ? 0 : first;
    }
    int64_t first_wanted() const {
        int64_t first = INT64_MAX;
        for (const WantedImage& image : images_) first = std::min(first, key_of(image.image).number);
        return first == INT64_MAX ? 0 : first;
    }

    // A detector that counts from 1, or in the video from which the images were cut.
    int64_t likely_shift() const {
        const int64_t shift = first_wanted() - first_seen();
        return first_seen() >= 0 && first_wanted() >= 0 && fits(shift) ? shift : 0;
    }

    // Numbers that count otherwise, where no file is missing.
    void by_order(const Group& group, int64_t shift, std::vector<const Seen*>& found) {
        if (!group.by_number || group.seen.size() != group.wanted.size()) refuse(group, shift);
        notes_.push_back(
            fmt::format("{}: the numbers of its files are not those of the images, so they go by their order",
                        group.place.string()));
        for (size_t i = 0; i < group.seen.size(); ++i) found[group.wanted[i]] = &group.seen[i];
    }

    [[noreturn]] void refuse(const Group& group, int64_t shift) const {
        if (group.by_number && group.seen.size() > group.wanted.size())
            throw InputError(
                group.place.string(), "",
                fmt::format("has {} frames, but the camera has {}", group.seen.size(), group.wanted.size()),
                "detect key points in the images of these cameras alone");
        std::map<Key, std::filesystem::path> files;
        std::set<Key> wanted;
        for (const size_t image : group.wanted) wanted.insert(wanted_key(group, image));
        for (const Seen& seen : group.seen) {
            Key key = seen.key;
            if (group.by_number) key.rest.clear();
            if (const auto [other, added] = files.emplace(key, seen.file); !added)
                throw InputError(seen.file.string(), "", "has the number of " + other->second.filename().string(),
                                 "remove one of them");
            if (key.number >= 0) key.number += shift;
            if (!wanted.contains(key))
                throw InputError(seen.file.string(), seen.people.image, "belongs to no image of these cameras",
                                 fmt::format("remove it, or name it like its image: {}{}.json",
                                             images_[group.wanted[0]].image, kKeyPointEnding));
        }
        throw InputError(group.place.string(), "", "has images whose names do not differ by number",
                         "number the images of each camera");
    }

    std::span<const WantedImage> images_;
    std::vector<Group> groups_;
    std::vector<std::string>& notes_;
};

// The layout of what was seen, which is of one detector.
const KeyPointLayout& expect_one_layout(const std::filesystem::path& folder, std::span<const Seen* const> found,
                                        const KeyPointLayout* named) {
    std::vector<ImagePeople> people;
    for (const Seen* seen : found) {
        if (!seen || seen->people.people.empty()) continue;
        people.push_back(seen->people);
        const size_t points = seen->people.people[0].size(), others = people[0].people[0].size();
        if (points != others)
            throw InputError(seen->file.string(), "",
                             fmt::format("is of the set {}, others are of {}", find_key_point_layout(points)->name,
                                         find_key_point_layout(others)->name),
                             "use one detector for all images");
        if (named && points != named->points)
            throw InputError(seen->file.string(), "",
                             fmt::format("has {} key points, not the {} of {}", points, named->points, named->name),
                             "name the set that the detector has");
    }
    if (people.empty())
        throw InputError(folder.string(), "", "has no key points of these images",
                         "name files like the images: c00_f000_keypoints.json");
    const KeyPointLayout* layout = named ? named : layout_of(people);
    if (!layout)
        throw InputError(folder.string(), "", "has 25 key points a person, which may be BODY_25 or BODY_25B",
                         "name the set of the detector");
    return *layout;
}

}  // namespace

void read_detections(const std::filesystem::path& folder, std::span<const WantedImage> images, Detections& detections,
                     const KeyPointLayout* layout) {
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder, ignored))
        throw InputError(folder.string(), "", "is no folder of key points",
                         "run a detector on the images and write its JSON there");
    const bool flat = !json_files(folder).empty();
    Matcher matcher(images, flat ? flat_groups(folder, images) : camera_groups(folder, images, detections.notes),
                    detections.notes);
    const std::vector<const Seen*> found = matcher.match();
    layout = &expect_one_layout(folder, found, layout);
    detections.points.assign(detections.frames * detections.cameras.size(), {});
    detections.people.assign(detections.points.size(), {});
    for (size_t i = 0; i < images.size(); ++i) {
        if (!found[i]) continue;
        const size_t at = images[i].frame * detections.cameras.size() + images[i].camera_index;
        for (const std::vector<KeyPoint>& person : found[i]->people.people)
            detections.people[at].push_back(joints_of(person, *layout));
        if (!detections.people[at].empty()) detections.points[at] = detections.people[at][0];
    }
    for (size_t j = 0; j < kJoints; ++j) detections.lacking[j] = layout->sources[j][0] < 0;
    if (const auto without = std::ranges::count(found, nullptr); without > 0)
        detections.notes.push_back(
            fmt::format("{} of {} images have no key points' file: they count as images in which nobody was seen",
                        without, images.size()));
}

std::vector<std::filesystem::path> key_point_files(const std::filesystem::path& folder,
                                                   std::span<const WantedImage> images) {
    std::set<std::string> names;
    std::vector<std::filesystem::path> files;
    for (const WantedImage& image : images) {
        expect_own_name(folder, image, names);
        files.push_back(folder / (image.image + kKeyPointEnding + ".json"));
    }
    return files;
}

}  // namespace neuvv::motion
