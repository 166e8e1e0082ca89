#include "training/capture/capture_files.h"

#include <fmt/format.h>

#include "training/data/transforms_file.h"

namespace neuvv::training {

std::string camera_name(size_t camera) {
    return fmt::format("c{:02}", camera);
}
std::string image_name(size_t camera, size_t frame) {
    return fmt::format("c{:02}_f{:03}", camera, frame);
}
std::string video_file(size_t camera) {
    return fmt::format("videos/{}.mp4", camera_name(camera));
}

void write_transforms(const std::filesystem::path& file, const CapturedClip& clip) {
    WrittenTransforms transforms{clip.cameras, {}, clip.box, clip.fps, ""};
    for (size_t c = 0; c < clip.cameras.size(); ++c) {
        if (!clip.written[c]) continue;
        const std::string plate =
            !clip.plates.empty() && clip.plates[c] ? fmt::format("plates/{}{}", camera_name(c), clip.ending) : "";
        if (clip.videos) {
            transforms.frames.push_back({c, {}, video_file(c), plate, ""});
            continue;
        }
        for (uint32_t f = 0; f < clip.frames; ++f)
            transforms.frames.push_back({c, clip.frames > 1 ? f / (clip.frames - 1.0) : 0.0,
                                         fmt::format("images/{}{}", image_name(c, f), clip.ending), plate, ""});
    }
    write_transforms_file(file, transforms);
}

}  // namespace neuvv::training
