#include "tools/image_sink.h"

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

ImageSink::ImageSink(ImageOutput output, media::ImageSize size, double fps, RenderFacts facts, bool resume)
    : output_(std::move(output)), size_(size), fps_(fps), record_{std::move(facts)} {
    using Kind = ImageOutput::Kind;
    if (output_.kind == Kind::kVideo && resume) {
        video_path_ = output_.path;
        const std::filesystem::path folder = link_target(video_path_).string() + ".frames";
        prepare_output_folder("--output", folder);
        output_ = {Kind::kNumberedImages, folder / "%06d.png"};
    }
    if (output_.kind == Kind::kVideo) video_.emplace(output_.path, size.width, size.height, fps);
    if (output_.kind != Kind::kNumberedImages) return;
    record_path_ = output_.file(kRecordWord).replace_extension(".json");
    if (resume) record_.finished = finished_images(record_path_, record_.facts);
    write_render_record(record_path_, record_);
}

bool ImageSink::has(uint32_t i) const {
    return i < record_.finished && is_file(output_.file(i));
}

void ImageSink::record_finished(uint32_t i) {
    if (record_path_.empty() || i < record_.finished) return;
    record_.finished = i + 1;
    write_render_record(record_path_, record_);
}

void ImageSink::add(uint32_t i, const media::Image& image) {
    assert(!output_.exr && "this output wants linear images");
    if (video_)
        video_->add(image);
    else
        media::write_png(output_.file(i), image);
    record_finished(i);
}

void ImageSink::add(uint32_t i, const media::LinearImage& image) {
    assert(output_.exr && "this output wants sRGB images");
    media::write_exr(output_.file(i), image);
    record_finished(i);
}

void ImageSink::finish(uint32_t images) {
    if (!video_path_.empty()) {
        video_.emplace(video_path_, size_.width, size_.height, fps_);
        for (uint32_t i = 0; i < images; ++i) video_->add(media::read_png(output_.file(i)));
    }
    if (video_) video_->finish();
    if (video_path_.empty()) return;
    std::error_code ignored;  // what was kept is not needed any more; a folder with other files in it stays
    for (uint32_t i = 0; i < images; ++i) std::filesystem::remove(output_.file(i), ignored);
    std::filesystem::remove(record_path_, ignored);
    std::filesystem::remove(record_path_.parent_path(), ignored);
}

}  // namespace neuvv::tools
