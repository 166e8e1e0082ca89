#include "editor/open_file.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "edit/operations.h"
#include "stage/stage.h"
#include "stream/transport/byte_source.h"
#include "voctree/files/clip.h"
#include "voctree/files/clip_box.h"
#include "voctree/files/clip_index.h"

namespace neuvv::editor {

namespace {

// Hidden clips are left out: those that a training makes to replace finished ones.
std::filesystem::path newest_clip(const std::filesystem::path& folder) {
    std::filesystem::path newest;
    std::filesystem::file_time_type when;
    std::error_code error;
    for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
        const std::filesystem::path& path = at->path();
        if (path.extension() != ".nvv" || path.filename().string().starts_with('.')) continue;
        std::error_code gone;
        if (!at->is_regular_file(gone) && !voctree::is_segmented(path)) continue;
        const auto written = at->last_write_time(gone);
        if (gone || (!newest.empty() && written <= when)) continue;
        newest = path;
        when = written;
    }
    if (error) throw InputError(folder.string(), "", fmt::format("cannot be read: {}", error.message()));
    if (newest.empty()) throw InputError(folder.string(), "", "there is no .nvv in this folder", Remedy::kOpenTrained);
    return newest;
}

std::filesystem::path opened_file(const std::filesystem::path& given) {
    if (stream::is_address(given)) return given;
    const std::filesystem::path path = voctree::clip_path(given);
    std::error_code error;
    const auto kind = std::filesystem::status(path, error).type();
    if (kind == std::filesystem::file_type::not_found)
        throw InputError(path.string(), "", "there is no such file", "check the path");
    return kind == std::filesystem::file_type::directory && !voctree::is_segmented(path) ? newest_clip(path) : path;
}

// What a file would be named that is downloaded from an address.
std::filesystem::path name_of_address(const std::filesystem::path& address) {
    const std::string text = address.string();
    const std::filesystem::path name = std::filesystem::path(text.substr(0, text.find_first_of("?#"))).filename();
    return name.empty() ? "stream" : name;
}

// A stage for a clip, without the clip. Where the clip has no box that can be read, whoever draws it says why.
stage::StageFile new_stage_of_clip(const std::filesystem::path& clip, AroundClip around) {
    const std::filesystem::path stage = stage_of_file(clip);
    if (around == AroundClip::kLitFloor) {
        try {
            const auto [low, high] = voctree::occupied_box(voctree::read_clip_index(clip));
            return edit::stage_for_clip(stage, low, high);
        } catch (const InputError&) {
        }
    }
    return stage::make_stage_file(stage, R"({"asset":{"version":"2.0","generator":"NeuVV"},"scene":0,"scenes":[{}]})");
}

}  // namespace

bool has_stage_ending(const std::filesystem::path& path) {
    const std::string ending = lower_case(path.extension().string());
    return ending == ".gltf" || ending == ".glb";
}

std::filesystem::path stage_of_file(const std::filesystem::path& path) {
    const std::filesystem::path file = opened_file(path);
    std::filesystem::path stage = stage::absolute_path(stream::is_address(file) ? name_of_address(file) : file);
    if (!has_stage_ending(stage)) stage.replace_extension(".gltf");
    return stage;
}

edit::Document open_document(const std::filesystem::path& path, AroundClip around) {
    const std::filesystem::path file = opened_file(path);
    edit::Document document;
    if (has_stage_ending(file)) {
        document.file = stage::read_stage_file(file);
        stage::expect_sound_document(document.file);
        return document;
    }
    if (!stream::is_address(file) && !voctree::has_clip_ending(file))
        throw InputError(file.string(), "", "is neither a stage nor a clip",
                         "open one of .gltf, .glb, " + voctree::clip_endings_text());
    document.file = new_stage_of_clip(file, around);
    edit::PerformerEdit performer;
    performer.clip = file;
    edit::add_performer(document.file, document.file.path.stem().string(), performer, {});
    return document;
}

}  // namespace neuvv::editor
