#include "tools/picture_sink.h"

#include <cassert>

#include "base/platform.h"

namespace neuvv::tools {

namespace {

constexpr char kRecordWord[] = "render";  // out_%04d.png has out_render.json beside it

bool is_file(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored);
}

}  // namespace

PictureSink::PictureSink(PictureOutput output, PictureSize size, double fps, RenderFacts facts, bool resume)
    : output_(std::move(output)), size_(size), fps_(fps), record_{std::move(facts)} {
    using Kind = PictureOutput::Kind;
    if (output_.kind == Kind::kVideo && resume) {
        video_path_ = output_.path;
        const std::filesystem::path folder = link_target(video_path_).string() + ".frames";
        prepare_output_folder("--output", folder);
        output_ = {Kind::kNumberedPictures, folder / "%06d.png"};
    }
    if (output_.kind == Kind::kVideo) video_.emplace(output_.path, size.width, size.height, fps);
    if (output_.kind != Kind::kNumberedPictures) return;
    record_path_ = output_.file(kRecordWord).replace_extension(".json");
    if (resume) record_.finished = finished_pictures(record_path_, record_.facts);
    write_render_record(record_path_, record_);
}

bool PictureSink::has(uint32_t i) const {
    return i < record_.finished && is_file(output_.file(i));
}

void PictureSink::record_finished(uint32_t i) {
    if (record_path_.empty() || i < record_.finished) return;
    record_.finished = i + 1;
    write_render_record(record_path_, record_);
}

void PictureSink::add(uint32_t i, const media::Image& picture) {
    assert(!output_.exr && "this output wants linear pictures");
    if (video_)
        video_->add(picture);
    else
        media::write_png(output_.file(i), picture);
    record_finished(i);
}

void PictureSink::add(uint32_t i, const media::LinearImage& picture) {
    assert(output_.exr && "this output wants sRGB pictures");
    media::write_exr(output_.file(i), picture);
    record_finished(i);
}

void PictureSink::finish(uint32_t pictures) {
    if (!video_path_.empty()) {
        video_.emplace(video_path_, size_.width, size_.height, fps_);
        for (uint32_t i = 0; i < pictures; ++i) video_->add(media::read_png(output_.file(i)));
    }
    if (video_) video_->finish();
    if (video_path_.empty()) return;
    std::error_code ignored;  // what was kept is not needed any more; a folder with other files in it stays
    for (uint32_t i = 0; i < pictures; ++i) std::filesystem::remove(output_.file(i), ignored);
    std::filesystem::remove(record_path_, ignored);
    std::filesystem::remove(record_path_.parent_path(), ignored);
}

}  // namespace neuvv::tools
