#include "render/clips/stage_assets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "media/image.h"
#include "voctree/files/clip.h"
#include "voctree/files/nvpaint.h"
#include "voctree/files/nvv.h"

namespace neuvv::render {

StageLoader::StageLoader(const gpu::Device& device, PaintSource paint, SolidParts solid)
    : device_(device), paint_source_(std::move(paint)), files_(std::make_shared<ClipFiles>(device, solid)) {}

StageAssets StageLoader::load(const stage::Stage& stage, const Loaded& loaded) {
    paint_files_.drop_unused();
    StageAssets assets;
    assets.files = files_;
    for (const stage::StageClip& clip : stage.clips) {
        assets.clips.push_back(load_clip(clip.path, assets.problems));
        if (loaded) loaded(assets.clips.size(), stage.clips.size());
    }
    assets.environment = load_environment(stage);
    load_paint(stage, assets);
    return assets;
}

const StageLoader::KnownHeader& StageLoader::header_of(const voctree::ClipSegment& segment) {
    const FileStamp stamp = segment.source->stamp(segment);
    if (const auto known = headers_.find(segment.file); known != headers_.end() && known->second.stamp == stamp)
        return known->second;
    KnownHeader header{stamp, {}, {}};
    try {
        const voctree::NvvHeader read = segment.source->header(segment);
        if (read.leaf_count > 0) header.box.emplace(read.box_min, read.box_min + read.box_size);
    } catch (const InputError& problem) {
        header.problem = Note(problem);
    }
    return headers_[segment.file] = header;
}

// What is on the device, for an earlier version of the stage, is found; where there is nothing, the first readable one
// is read.
void StageLoader::load_segments(ClipOnDevice& clip, std::vector<Note>& problems) {
    for (const voctree::ClipSegment& segment : clip.index.segments) {
        ClipOnDevice::Segment& one = clip.segments.emplace_back();
        const KnownHeader& header = header_of(segment);
        Note problem = header.problem;
        try {
            if (problem.empty()) one.loaded = files_->find(segment);
            if (problem.empty() && !one.loaded) one.coarse = files_->find_parts(segment);
        } catch (const InputError& error) {
            problem = Note(error);
        }
        if (!clip.first) clip.first = one.loaded ? one.loaded : one.coarse;
        one.readable = problem.empty();
        if (!one.readable) problems.push_back(problem);
        if (!one.readable || !header.box) continue;
        clip.leaf_box.first = glm::min(clip.leaf_box.first, header.box->first);
        clip.leaf_box.second = glm::max(clip.leaf_box.second, header.box->second);
    }
    for (size_t i = 0; i < clip.segments.size() && !clip.first; ++i) {
        ClipOnDevice::Segment& one = clip.segments[i];
        if (!one.readable) continue;
        try {
            clip.first = one.loaded = files_->read(clip.index.segments[i]);
        } catch (const InputError& error) {
            one.readable = false;
            problems.push_back(Note(error));
        }
    }
}

ClipOnDevice StageLoader::load_clip(const std::filesystem::path& path, std::vector<Note>& problems) {
    ClipOnDevice clip{voctree::read_clip_index(path), {}, nullptr, {glm::dvec3(INFINITY), glm::dvec3(-INFINITY)}};
    const size_t known_problems = problems.size();
    if (clip.index.segments.size() > 1) {
        load_segments(clip, problems);
        if (!clip.first)
            throw InputError(path.string(), "", "none of its segments can be read: " + problems[known_problems].text,
                             problems[known_problems].fix);
    } else {
        clip.first = files_->read(clip.index.segments[0]);
        clip.segments.push_back({clip.first, nullptr});
    }
    if (clip.leaf_box.first.x > clip.leaf_box.second.x)
        clip.leaf_box = {clip.first->field.leaves_min, clip.first->field.leaves_max};
    return clip;
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

namespace {

// Calls load(path, layer) for the performer's visible layers, the lowest first. An InputError gets the layer's place.
void for_visible_layers(const stage::Stage& stage, const stage::StagePerformer& performer, const auto& load) {
    for (size_t i = 0; i < performer.settings.paint.size(); ++i) {
        const stage::PaintLayer& layer = performer.settings.paint[i];
        if (!layer.visible || layer.opacity <= 0) continue;
        const std::string place = fmt::format("\"{}\": paint layer {}", performer.name, i);
        try {
            load(stage::file_of_uri(stage.file, layer.uri, place), layer);
        } catch (const InputError& problem) {
            throw InputError(stage.file.path.string(), place, problem.cause(), problem.fix());
        }
    }
}

// A folder of which any file is edited need not be on the disk yet.
LayerFolders folders_of(const stage::Stage& stage, const stage::StagePerformer& performer, const PaintSource& source) {
    LayerFolders folders;
    for_visible_layers(stage, performer, [&](const std::filesystem::path& path, const stage::PaintLayer& layer) {
        voctree::expect_no_stream(stage.clips[performer.clip].path);
        voctree::PaintLayers edited = source ? source(path) : voctree::PaintLayers();
        if (edited.empty()) voctree::expect_paint_folder(path);
        folders.push_back(
            {stage::absolute_path(path), layer.blend, static_cast<float>(layer.opacity), std::move(edited)});
        if (folders.size() > kPaintLayerLimit)
            throw InputError(path.string(), "", fmt::format("is one of more than {} visible layers", kPaintLayerLimit),
                             "hide some");
    });
    return folders;
}

}  // namespace

std::vector<LoadedLayer> StageLoader::load_layers(const stage::Stage& stage, const stage::StagePerformer& performer,
                                                  const voctree::PaintedField& painted) {
    std::vector<LoadedLayer> layers;
    for_visible_layers(stage, performer, [&](const std::filesystem::path& path, const stage::PaintLayer& layer) {
        std::shared_ptr<const voctree::EditLayer> edits;
        if (paint_source_)
            for (const auto& [file, edited] : paint_source_(path)) edits = edited;
        if (!edits) edits = paint_files_.read(path, painted);
        if (edits->field != painted)
            throw InputError(path.string(), "", "is paint for another clip", "paint on this one anew");
        layers.push_back({std::move(edits), layer.blend, static_cast<float>(layer.opacity)});
    });
    return layers;
}

// Of segmented clips, the paint of those segments that are on the device.
void StageLoader::load_paint(const stage::Stage& stage, StageAssets& assets) {
    for (const stage::StagePerformer& performer : stage.performers) {
        ClipOnDevice& clip = assets.clips[performer.clip];
        const bool segmented = clip.segments.size() > 1;
        assets.paint.push_back(segmented ? std::vector<LoadedLayer>()
                                         : load_layers(stage, performer, clip.first->painted));
        assets.layers.push_back(kNoLayers);
        if (!segmented) continue;
        LayerFolders folders = folders_of(stage, performer, paint_source_);
        if (folders.empty()) continue;
        const auto known = std::ranges::find(clip.layers, folders);
        assets.layers.back() = static_cast<uint32_t>(known - clip.layers.begin());
        if (known == clip.layers.end()) clip.layers.push_back(std::move(folders));
    }
    for (ClipOnDevice& clip : assets.clips)
        for (size_t i = 0; i < clip.segments.size(); ++i) {
            ClipOnDevice::Segment& segment = clip.segments[i];
            if (!segment.loaded) continue;
            segment.paints = files_->read_paints(clip.index.segments[i], *segment.loaded, clip.layers);
            for (const auto& paint : segment.paints)
                if (!paint->problem.empty()) assets.problems.push_back(paint->problem);
        }
}

}  // namespace neuvv::render
