#include "training/data/layouts/nerf_images.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "base/error.h"
#include "training/data/layouts/nerf_splits.h"
#include "training/data/layouts/rig/candidates.h"
#include "training/data/layouts/rig/image_reader.h"

namespace neuvv::training {

namespace {

// The image `path`, or `path` with the extension of an image, as D-NeRF gives none; empty where there is neither.
std::filesystem::path image_at(const std::filesystem::path& folder, const std::string& path) {
    std::error_code ignored;
    for (const char* ending : {"", ".png", ".jpg", ".jpeg"}) {
        std::filesystem::path candidate = folder / (path + ending);
        if (std::filesystem::is_regular_file(candidate, ignored)) return candidate;
    }
    return {};
}

// The images of a frame that names a folder or a video; empty where it names an image, or what does not exist.
std::vector<ImageFrame> images_of_sequence(const Rig& rig, const interchange::TransformsFrame& from,
                                           const Sequences& sequences) {
    const auto found = sequences.find(from.file_path);
    if (found == sequences.end()) return {};
    if (from.time)
        throw InputError(rig.file, from.place + ".time", "is given beside a file_path of many images",
                         "remove it: images of the same name, or moment of their videos, are of the same time");
    const auto& [frames, masks] = found->second;
    std::vector<ImageFrame> result;
    for (const auto& [name, source] : frames) {
        ImageFrame added{from, source, masks.empty() ? ImageSource() : masks.at(name)};
        const std::filesystem::path camera(from.file_path);
        added.frame.file_path =
            (camera.parent_path() / without_extension(camera.filename().string()) / (name + ".png")).generic_string();
        added.frame.place += fmt::format(", image {}", name);
        result.push_back(std::move(added));
    }
    return result;
}

}  // namespace

// Where a path has no ending, the .png counts, as in D-NeRF's own loader.
void note_endings(Rig& rig, const std::vector<interchange::TransformsFrame>& frames) {
    size_t count = 0;
    std::string first, other;
    for (const interchange::TransformsFrame& frame : frames) {
        const std::filesystem::path image = image_at(rig.folder, frame.file_path);
        if (image.empty() || image == rig.folder / frame.file_path) continue;
        for (const char* ending : {".png", ".jpg", ".jpeg"}) {
            const std::filesystem::path twin = rig.folder / (frame.file_path + ending);
            if (twin == image || !holds_file(twin) || count++ > 0) continue;
            first = image.lexically_relative(rig.folder).string();
            other = twin.lexically_relative(rig.folder).string();
        }
    }
    if (count > 0)
        rig.remarks.push_back(choice_remark(first, {other}) +
                              (count > 1 ? fmt::format(", and alike in {} cases", count) : ""));
}

std::filesystem::path find_image(const Rig& rig, const std::string& path, const std::string& place) {
    const std::filesystem::path image = image_at(rig.folder, path);
    if (!image.empty()) return image;
    throw InputError(rig.file, place, fmt::format("there is no image {0} nor {0}.png", (rig.folder / path).string()),
                     "put it there or correct the path");
}

Sequences find_sequences(Rig& rig, const std::vector<interchange::TransformsFrame>& first,
                         const std::vector<interchange::TransformsFrame>& others) {
    std::map<std::string, CameraFrames> found;
    for (const std::vector<interchange::TransformsFrame>* frames : {&first, &others})
        for (const interchange::TransformsFrame& from : *frames) {
            const std::filesystem::path path = rig.folder / from.file_path, mask = rig.folder / from.mask_path;
            const std::filesystem::path image = image_at(rig.folder, from.file_path);
            if (from.file_path.empty() || (!image.empty() && !is_video(image)) || found.contains(from.file_path))
                continue;
            CameraFrames camera;
            camera.camera.name = without_extension(path.filename().string());
            camera.frames = image.empty() ? images_in(path) : frames_of_video(path);
            if (camera.frames.empty()) continue;
            if (!from.mask_path.empty())
                camera.masks =
                    masks_of_camera(mask.parent_path(), without_extension(mask.filename().string()), camera.frames);
            found[from.file_path] = std::move(camera);
        }
    std::vector<CameraFrames> cameras;
    for (const auto& [path, camera] : found) cameras.push_back(camera);
    name_by_time(rig, cameras);
    Sequences sequences;
    for (size_t i = 0; const auto& [path, camera] : found) {
        sequences[path] = {std::move(cameras[i].frames), std::move(cameras[i].masks)};
        ++i;
    }
    return sequences;
}

std::vector<ImageFrame> image_frames(Rig& rig, const std::vector<interchange::TransformsFrame>& frames,
                                     const Sequences& sequences, std::vector<interchange::TransformsFrame>& others) {
    std::vector<ImageFrame> result;
    std::vector<MissingImage> missing;
    for (const interchange::TransformsFrame& frame : frames) {
        if (frame.file_path.empty()) throw InputError(rig.file, frame.place, "has no file_path", "name its image");
        std::vector<ImageFrame> sequence = images_of_sequence(rig, frame, sequences);
        if (sequence.empty()) {
            const std::filesystem::path image = image_at(rig.folder, frame.file_path);
            if (image.empty()) {
                missing.push_back({frame.place + ".file_path", rig.folder / frame.file_path});
                others.push_back(frame);
                continue;
            }
            sequence.push_back({frame, {image, -1}, {}});
            if (!frame.mask_path.empty())
                sequence[0].mask.path = find_image(rig, frame.mask_path, frame.place + ".mask_path");
        }
        std::ranges::move(sequence, std::back_inserter(result));
    }
    leave_out(rig, missing, frames.size());
    return result;
}

std::vector<interchange::TransformsFrame> spread_frames(const Rig& rig,
                                                        const std::vector<interchange::TransformsFrame>& frames,
                                                        const Sequences& sequences) {
    std::vector<interchange::TransformsFrame> result;
    for (const interchange::TransformsFrame& frame : frames) {
        const std::vector<ImageFrame> sequence = images_of_sequence(rig, frame, sequences);
        if (sequence.empty()) result.push_back(frame);
        for (const ImageFrame& image : sequence) result.push_back(image.frame);
    }
    return result;
}

}  // namespace neuvv::training
