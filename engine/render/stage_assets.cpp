#include "render/stage_assets.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/error.h"
#include "media/image.h"
#include "voctree/clip.h"

namespace neuvv::render {

const std::shared_ptr<const LoadedClip>& ClipOnDevice::first_readable() const {
    const auto found = std::find_if(segments.begin(), segments.end(), [](const auto& one) { return one != nullptr; });
    return found != segments.end() ? *found : segments[0];
}

StageLoader::StageLoader(const gpu::Device& device, PaintSource paint)
    : device_(device), paint_source_(std::move(paint)) {}

StageAssets StageLoader::load(const stage::Stage& stage, const Loaded& loaded) {
    paint_files_.drop_unused();
    StageAssets assets;
    assets.clips = load_clips(stage, loaded, assets.problems);
    assets.environment = load_environment(stage);
    for (const stage::StagePerformer& performer : stage.performers)
        assets.paint.push_back(load_layers(stage, performer, assets.clips[performer.clip]));
    return assets;
}

// A clip that is still on the device and whose file has not changed, or null.
std::shared_ptr<const LoadedClip> StageLoader::find_clip(const std::filesystem::path& path,
                                                         const FileStamp& stamp) const {
    for (const auto& one : clips_)
        if (const auto clip = one.lock(); clip && clip->path == path && clip->stamp == stamp) return clip;
    return nullptr;
}

// A file that is on the device already, also as a part of another clip, is not read again.
std::shared_ptr<const LoadedClip> StageLoader::load_segment(const voctree::ClipSegment& segment) {
    const FileStamp stamp = stamp_of(segment.file);
    if (auto known = find_clip(segment.file, stamp)) return known;
    const voctree::VOctree tree = voctree::read_segment(segment);
    auto read = std::make_shared<const LoadedClip>(
        LoadedClip{segment.file, stamp, upload_far_levels(device_, tree), voctree::painted_field(tree)});
    clips_.push_back(read);
    return read;
}

std::vector<ClipOnDevice> StageLoader::load_clips(const stage::Stage& stage, const Loaded& loaded,
                                                  std::vector<std::string>& problems) {
    std::erase_if(clips_, [](const auto& clip) { return clip.expired(); });
    std::vector<ClipOnDevice> clips;
    size_t read = 0, missing = 0;
    for (const stage::StageClip& wanted : stage.clips) {
        clips.push_back({voctree::read_clip_index(wanted.path), {}});
        for (const voctree::ClipSegment& segment : clips.back().index.segments) {
            clips.back().segments.push_back(find_clip(segment.file, stamp_of(segment.file)));
            missing += clips.back().segments.back() ? 0 : 1;
        }
    }
    for (ClipOnDevice& clip : clips) {
        for (size_t i = 0; i < clip.segments.size(); i++) {
            if (clip.segments[i]) continue;
            try {
                clip.segments[i] = load_segment(clip.index.segments[i]);
            } catch (const InputError& problem) {
                if (clip.segments.size() == 1) throw;
                problems.emplace_back(problem.what());
            }
            if (loaded) loaded(++read, missing);
        }
        if (!clip.first_readable()) voctree::read_segment(clip.index.segments[0]);  // throws again what is wrong
    }
    return clips;
}

std::shared_ptr<const SetEnvironment> StageLoader::load_environment(const stage::Stage& stage) {
    KnownEnvironment wanted;
    if (stage.settings.environment) {
        wanted.path = stage::file_of_uri(stage.file, stage.settings.environment->uri, "/environment/uri");
        wanted.stamp = stamp_of(wanted.path);
    }
    std::erase_if(environments_, [](const KnownEnvironment& one) { return one.map.expired(); });
    for (const KnownEnvironment& one : environments_)
        if (auto map = one.map.lock(); map && one.path == wanted.path && one.stamp == wanted.stamp) return map;
    std::optional<media::Image> image;
    if (stage.settings.environment) image = media::read_png(wanted.path);
    auto map = std::make_shared<const SetEnvironment>(device_, image ? &*image : nullptr);
    wanted.map = map;
    environments_.push_back(std::move(wanted));
    return map;
}

std::vector<LoadedLayer> StageLoader::load_layers(const stage::Stage& stage, const stage::StagePerformer& performer,
                                                  const ClipOnDevice& clip) {
    std::vector<LoadedLayer> layers;
    const voctree::PaintedField& painted = clip.first_readable()->painted;
    for (size_t i = 0; i < performer.settings.paint.size(); i++) {
        const stage::PaintLayer& layer = performer.settings.paint[i];
        if (!layer.visible || layer.opacity <= 0) continue;
        const std::string place = fmt::format("\"{}\": paint layer {}", performer.name, i);
        try {
            if (clip.segments.size() > 1)
                throw InputError(stage.clips[performer.clip].path.string(), "",
                                 "is a clip in segments, which cannot be painted", "remove the layer");
            const std::filesystem::path path = stage::file_of_uri(stage.file, layer.uri, place);
            std::shared_ptr<const voctree::EditLayer> edits = paint_source_ ? paint_source_(path, painted) : nullptr;
            if (!edits) edits = paint_files_.read(path, painted);
            if (edits->field != painted)
                throw InputError(path.string(), "", "is paint for another clip", "paint on this one anew");
            layers.push_back({std::move(edits), layer.blend, static_cast<float>(layer.opacity)});
        } catch (const InputError& problem) {
            throw InputError(stage.file.path.string(), place, problem.what());
        }
    }
    return layers;
}

}  // namespace neuvv::render
