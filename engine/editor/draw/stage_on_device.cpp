#include "editor/draw/stage_on_device.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "edit/read.h"

namespace neuvv::editor {

namespace {

// The capacity for this many pixels, with room for blocks that are a few rays larger than their share of the image, and
// for windows that grow a little.
uint32_t roomy(uint32_t pixels) {
    constexpr uint32_t kStep = 128;
    return (pixels + 8 + kStep - 1) / kStep * kStep;
}

}  // namespace

void StageOnDevice::release() {
    waiting_.reset();
    preload_.reset();
    renderer_.reset();
    loader_.reset();
    stage_.reset();
}

bool StageOnDevice::show(const ShownDocument& document, VkExtent2D size) {
    waiting_.reset();
    if (begin_reading(document)) return false;
    load(document, size);
    return true;
}

// Nobody may want what was read any more.
bool StageOnDevice::show_waiting(VkExtent2D size) {
    const std::optional<ShownDocument> waiting = std::exchange(waiting_, std::nullopt);
    if (!waiting) {
        if (preload_ && !preload_->is_done()) return false;  // it began after the one that was read had ended
        preload_.reset();
        state_.change([](RenderThreadState& state) { state.loading.clear(); });
        return false;
    }
    if (begin_reading(*waiting)) return false;  // for other clips than those that were read
    const std::unique_ptr<render::ClipPreload> read = std::move(preload_);
    try {
        if (read) read->expect_read();
        load(*waiting, size);
    } catch (const InputError& error) {
        state_.report_problem(error.what(), is_sound(*waiting->document) ? 0 : waiting->id);
        return false;
    }
    return true;
}

// Whether the document has clips that the stage before has not, and that are not read yet: then they are, by a thread,
// and the document waits. One thread reads at a time; what another document wants meanwhile is read when it is done.
bool StageOnDevice::begin_reading(const ShownDocument& document) {
    if (!stage_) return false;
    std::vector<std::filesystem::path> unknown;
    try {
        unknown = edit::clips_of(document.document->file);
    } catch (const InputError&) {
        return false;  // load() tells what is wrong
    }
    std::erase_if(unknown, [this](const std::filesystem::path& clip) {
        return std::ranges::find(stage_->clips, clip, &stage::StageClip::path) != stage_->clips.end();
    });
    if (unknown.empty() || (preload_ && preload_->is_done() && preload_->clips() == unknown)) return false;
    state_.report_progress(unknown[0].filename().string(), 0, unknown.size());
    waiting_ = document;
    if (preload_ && !preload_->is_done()) return true;
    const auto each = [this, unknown](size_t read) { report_read(unknown, read); };
    preload_ = std::make_unique<render::ClipPreload>(loader_->files(), unknown, each, clips_read_);
    return true;
}

// On the thread that reads. Says nothing where another document waits by now, or none, whose clips are others.
void StageOnDevice::report_read(const std::vector<std::filesystem::path>& clips, size_t read) {
    bool is_current = false;
    state_.change([&](RenderThreadState& state) {
        is_current = state.loading == clips[read - 1].filename() && state.files == clips.size();
        if (!is_current) return;
        state.loading = clips[read].filename().string();
        state.files_read = read;
    });
    if (is_current) state_.wake();
}

// Keeps the old stage where the new one cannot be drawn.
void StageOnDevice::load(const ShownDocument& document, VkExtent2D size) {
    const auto before = std::exchange(document_, document.document);
    try {
        bring_to_device(*document.document, size);
    } catch (const InputError& error) {
        document_ = before;
        return state_.report_problem(error.what(), is_sound(*document.document) ? 0 : document.id);
    } catch (...) {
        document_ = before;
        throw;
    }
    id_ = document.id;
    state_.change([&](RenderThreadState& state) {
        state.loading.clear();
        state.problem.clear();
        state.stage = stage_;
        state.stage_id = id_;
        state.leaf_boxes.clear();
        for (uint32_t clip = 0; clip < stage_->clips.size(); ++clip)
            state.leaf_boxes.push_back(renderer_->leaf_box(clip));
        state.displayed.finished = false;
    });
    report_unreadable_segments();
    state_.wake();
}

void StageOnDevice::bring_to_device(const edit::Document& document, VkExtent2D size) {
    const auto progress = [this, file = document.file.path.filename().string()](size_t done, size_t of) {
        state_.report_progress(file, done, of);
    };
    auto stage = std::make_shared<const stage::Stage>(stage::make_stage(document.file, stage_.get()));
    if (renderer_) {
        renderer_->change(*stage, render::with_memory_of_slices(renderer_->frames(),
                                                                [&] { return loader_->load(*stage, progress); }));
    } else {
        progress(0, stage->clips.size());
        make_renderer(*stage, progress, size);
    }
    stage_ = std::move(stage);
}

void StageOnDevice::make_renderer(const stage::Stage& stage, const render::StageLoader::Loaded& progress,
                                  VkExtent2D size) {
    const VkExtent2D capacity{roomy(size.width), roomy(size.height)};
    const render::PaintSource paint = [this](const std::filesystem::path& layer) {
        return voctree::files_of_layer(document_->paint, stage::absolute_path(layer));
    };
    if (!loader_) loader_ = std::make_unique<render::StageLoader>(device_, paint);
    renderer_ = std::make_unique<render::StageRenderer>(device_, stage, loader_->load(stage, progress),
                                                        render::FrameCapacity{capacity.width, capacity.height});
    capacity_ = capacity;
}

// Whether the document could be drawn if all its clips were there.
bool StageOnDevice::is_sound(const edit::Document& document) const {
    try {
        stage::expect_sound_document(document.file, stage_.get());
    } catch (const InputError&) {
        return false;
    }
    return true;
}

void StageOnDevice::fit(VkExtent2D size) {
    if (size.width + 8 <= capacity_.width && size.height + 8 <= capacity_.height) return;
    capacity_ = {std::max(capacity_.width, roomy(size.width)), std::max(capacity_.height, roomy(size.height))};
    renderer_->resize(capacity_.width, capacity_.height);
}

void StageOnDevice::report_unreadable_segments() {
    const std::vector<Note> problems = renderer_->take_problems();
    if (problems.empty()) return;
    state_.change([&](RenderThreadState& state) { state.problem = problems[0].words(); });
}

std::string StageOnDevice::replace_shaders(const gpu::ShaderReplacements& shaders, VkExtent2D size,
                                           const std::function<void()>& draw) {
    const gpu::ShaderReplacements before = device_.shaders().replacements();
    device_.shaders().set(shaders);
    const VkExtent2D capacity = capacity_;
    std::unique_ptr<render::StageRenderer> last = std::move(renderer_);
    const auto progress = [this](size_t done, size_t of) { state_.report_progress("shaders", done, of); };
    std::string problem;
    try {
        if (stage_) make_renderer(*stage_, progress, size);
        draw();
    } catch (const std::runtime_error& error) {
        device_.shaders().set(before);
        renderer_ = std::move(last);
        capacity_ = capacity;
        problem = error.what();
    }
    state_.change([](RenderThreadState& state) { state.loading.clear(); });
    return problem;
}

}  // namespace neuvv::editor
