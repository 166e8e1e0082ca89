#include "tools/unfinished_clip.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/output_path.h"
#include "voctree/clip_index.h"

namespace neuvv::tools {

UnfinishedClip::UnfinishedClip(const std::filesystem::path& output)
    : output_(voctree::clip_path(output)), folder_(output_.string() + ".unfinished") {
    if (output_.extension() != ".nvv")
        throw InputError("--output", output_.string(), "is no name of a clip", "write for instance show.nvv");
    if (std::filesystem::exists(output_))
        throw InputError("--output", output_.string(), "is there already", "name another, or remove it");
    prepare_output_file("--output", output_);
    std::error_code error;
    if (std::filesystem::create_directory(folder_, error)) return;
    if (error) throw InputError("--output", folder_.string(), "cannot be made: " + error.message());
    throw InputError("--output", folder_.string(),
                     "is there already: the clip is being written, or that was interrupted",
                     "wait for that, or remove it");
}

UnfinishedClip::~UnfinishedClip() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
}

void UnfinishedClip::finish(const std::filesystem::path& made) const {
    std::error_code error;
    std::filesystem::rename(made, output_, error);
    if (error) throw RuntimeFailure(fmt::format("{}: cannot be written: {}", output_.string(), error.message()));
}

}  // namespace neuvv::tools
