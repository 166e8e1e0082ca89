#include "media/image_sink.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cassert>
#include <fstream>
#include <memory>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/formats/json.h"
#include "base/numbered_path.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "base/text.h"
#include "base/trace_file.h"

namespace neuvv::media {

namespace {

constexpr char kRecordName[] = "render";  // the record of out_%04d.png is out_render.json

bool is_file(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored);
}

constexpr uint64_t kMaxImages_bytes = uint64_t{1} << 30;      // of images that are not written yet
constexpr uint64_t kPixelBytes = 8, kLinearPixelBytes = 128;  // with its file, and of an .exr with depth and names
constexpr size_t kWaitingImages = 1;                          // while all threads write

constexpr size_t kBlockBytes = size_t{1} << 20;
constexpr double kMaxFinished = 1e9;

struct RenderRecord {
    RenderFacts facts;
    uint32_t finished = 0;  // the number after that of the last finished image
};

RenderRecord read_record(const std::filesystem::path& path) {
    const JsonFile file = read_json(path, "the record of a render");
    const JsonNode root = file.root();
    RenderRecord record;
    if (!root.has("render") || !root["render"].value.is_object() || !root.has("finished"))
        root.fail("is not the record of a render", Remedy::kRenderAnew);
    for (const auto& [name, value] : root["render"].value.items())
        record.facts[name] = json_string(JsonNode{value, file.name, "render." + name});
    record.finished =
        static_cast<uint32_t>(json_number(root["finished"], 0, kMaxFinished, "a number of finished images"));
    return record;
}

constexpr char kContent[] = "xxh3:";

bool is_content(const std::string& fact) {
    return fact.starts_with(kContent);
}

// A fact as an error message shows it.
std::string shown_fact(const std::string& fact) {
    return is_content(fact) ? "a file" : fact;
}

std::string fact(const RenderFacts& facts, const std::string& name) {
    const auto found = facts.find(name);
    return found == facts.end() ? "none" : found->second;
}

void write_record(const std::filesystem::path& file, const RenderFacts& facts, uint32_t finished) {
    write_text_file(file, json_text({{"render", facts}, {"finished", finished}}));
}

// How many images are finished of a render with these facts; 0 where there is no record. Throws InputError for a
// record of another render, naming what differs, and for a damaged one.
uint32_t finished_images(const std::filesystem::path& file, const RenderFacts& facts) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return 0;
    const RenderRecord record = read_record(file);
    RenderFacts names = facts;
    names.insert(record.facts.begin(), record.facts.end());
    std::string differing;  // a file that differs, rather than another fact that follows from it
    for (const auto& [name, value] : names)
        if (fact(facts, name) != fact(record.facts, name) &&
            (differing.empty() || (is_content(value) && !is_content(names[differing]))))
            differing = name;
    if (differing.empty()) return record.finished;
    const std::string now = fact(facts, differing), then = fact(record.facts, differing);
    throw InputError(
        file.string(), differing,
        is_content(now) && is_content(then)
            ? "was changed since the images that are there were rendered"
            : fmt::format("was {} for the images that are there, and is {} now", shown_fact(then), shown_fact(now)),
        Remedy::kRenderAnew);
}

std::filesystem::path record_file(const ImageOutput& output, const std::string& name) {
    return output.file(name).replace_extension(".json");
}

bool is_number(std::string_view text) {
    return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

// The records that there are of renders into these images, of all and of parts.
std::vector<std::filesystem::path> records_of(const ImageOutput& output) {
    const std::string marked = record_file(output, "\n").filename().string();
    const std::string begin = marked.substr(0, marked.find('\n')) + kRecordName;
    const std::string end = marked.substr(marked.find('\n') + 1);
    std::vector<std::filesystem::path> found;
    std::error_code ignored;
    const std::filesystem::path folder = output.file("x").parent_path();
    for (const auto& entry : std::filesystem::directory_iterator(folder.empty() ? "." : folder, ignored)) {
        const std::string file = entry.path().filename().string();
        if (file.size() < begin.size() + end.size() || !file.starts_with(begin) || !file.ends_with(end)) continue;
        const std::string range = file.substr(begin.size(), file.size() - begin.size() - end.size());
        const size_t dash = std::min(range.find('-'), range.size());
        const bool is_part = range.starts_with("_") && dash < range.size() && is_number(range.substr(1, dash - 1)) &&
                             is_number(range.substr(dash + 1));
        if (range.empty() || is_part) found.push_back(folder / file);
    }
    return found;
}

// The threads that write a sink's images. One writes a video, whose images are encoded in their order, and deep images,
// which may be of any size. Beside those that are written, one image waits and one is being drawn.
uint32_t writers_of(const ImageOutput& output, ImageSize size) {
    if (output.kind != ImageOutput::Kind::kNumberedImages || output.has_deep) return 1;
    const uint64_t pixels = std::max<uint64_t>(uint64_t{size.width} * size.height, 1);
    const uint64_t room = kMaxImages_bytes / (pixels * (output.exr ? kLinearPixelBytes : kPixelBytes));
    const uint64_t cores = std::max(1u, std::thread::hardware_concurrency());
    return static_cast<uint32_t>(std::clamp<uint64_t>(room, kWaitingImages + 2, kWaitingImages + 1 + cores) -
                                 kWaitingImages - 1);
}

bool is_record_of(const std::filesystem::path& file, const RenderFacts& facts) {
    try {
        return read_record(file).facts == facts;
    } catch (const InputError&) {
        return false;
    }
}

// How many images a record says are finished; 0 where it is damaged.
uint32_t recorded_images(const std::filesystem::path& file) {
    try {
        return read_record(file).finished;
    } catch (const InputError&) {
        return 0;
    }
}

}  // namespace

void forget_renders(const ImageOutput& output) {
    if (output.kind != ImageOutput::Kind::kNumberedImages) return;
    for (const std::filesystem::path& record : records_of(output)) std::filesystem::remove(record);
}

std::string content_fact(const std::filesystem::path& path) {
    expect_regular_file(path);
    std::ifstream file(path, std::ios::binary);
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), XXH3_freeState);
    XXH3_64bits_reset(state.get());
    std::vector<char> block(kBlockBytes);
    while (file.read(block.data(), static_cast<std::streamsize>(block.size())) || file.gcount() > 0)
        XXH3_64bits_update(state.get(), block.data(), static_cast<size_t>(file.gcount()));
    if (!file.eof() || file.bad()) throw InputError(path.string(), "", "cannot be read");
    return fmt::format("{}{:016x}", kContent, XXH3_64bits_digest(state.get()));
}

ImageSink::ImageSink(ImageOutput output, ImageSize size, double fps, RenderFacts facts, bool resume,
                     std::optional<ImageRange> range)
    : output_(std::move(output)),
      size_(size),
      fps_(fps),
      facts_(std::move(facts)),
      first_(range ? range->first : 0),
      had_(first_),
      finished_(first_) {
    using Kind = ImageOutput::Kind;
    if (output_.kind == Kind::kVideo && resume) {
        video_path_ = output_.path;
        const std::filesystem::path folder = link_target(video_path_).string() + ".frames";
        prepare_output_folder(Setting{"output"}, folder);
        output_ = {Kind::kNumberedImages, folder / "%06d.png"};
    }
    if (output_.kind == Kind::kVideo) video_.emplace(output_.path, size.width, size.height, fps);
    if (output_.kind == Kind::kNumberedImages) open_record(resume, range);
    workers_.emplace(writers_of(output_, size), kWaitingImages);
}

ImageSink::~ImageSink() {
    if (video_) return;  // it is whole, or removed
    try {
        wait();
    } catch (const std::exception&) {
        return;  // whoever wants to know calls wait()
    }
}

// Renders of a part of the images and of all have records of their own, but the same images.
void ImageSink::open_record(bool resume, const std::optional<ImageRange>& range) {
    const std::string name = range ? fmt::format("{}_{}-{}", kRecordName, range->first, range->end) : kRecordName;
    record_path_ = record_file(output_, name);
    for (const std::filesystem::path& other : records_of(output_)) {
        if (!resume && !range) before_ = std::max(before_, recorded_images(other));
        if (other == record_path_) continue;
        if (resume)
            finished_images(other, facts_);
        else if (!is_record_of(other, facts_))
            std::filesystem::remove(other);
    }
    if (resume) finished_ = had_ = std::max(finished_images(record_path_, facts_), first_);
    write_record(record_path_, facts_, finished_);
}

bool ImageSink::has(uint32_t i) const {
    return i >= first_ && i < had_ && is_file(output_.file(i)) && (!output_.has_deep || is_file(output_.deep_file(i)));
}

// The record tells a number before which all images are there. Images after it may be there, too, where several were
// written when the run was interrupted: they are drawn again.
void ImageSink::record_finished(uint32_t i) {
    const std::lock_guard lock(mutex_);
    if (record_path_.empty() || i < finished_) return;
    written_ahead_.insert(i);
    if (i != finished_) return;
    while (written_ahead_.erase(finished_) > 0) ++finished_;
    write_record(record_path_, facts_, finished_);
}

void ImageSink::write(uint32_t i, std::function<void()> image) {
    workers_->add([this, i, image = std::move(image)] {
        const TraceSpan span("write image", i);
        image();
        record_finished(i);
    });
}

void ImageSink::add(uint32_t i, Image image) {
    assert(!output_.exr && "this output takes linear images");
    write(i, [this, i, image = std::move(image)] {
        if (video_)
            video_->add(image);
        else
            write_png(output_.file(i), image);
    });
}

void ImageSink::add(uint32_t i, LinearImage image, std::optional<DeepImage> deep) {
    assert(output_.exr && "this output takes sRGB images");
    assert(deep.has_value() == output_.has_deep && "deep images go to deep files");
    write(i, [this, i, image = std::move(image), deep = std::move(deep)] {
        if (deep) write_deep_exr(output_.deep_file(i), *deep);
        write_exr(output_.file(i), image);
    });
}

void ImageSink::wait() {
    workers_->finish();
}

void ImageSink::finish(uint32_t end, const std::function<void()>& complete) {
    wait();
    if (!video_path_.empty()) {
        video_.emplace(video_path_, size_.width, size_.height, fps_);
        for (uint32_t i = first_; i < end; ++i) video_->add(read_png(output_.file(i)));
    }
    if (video_) video_->finish();
    if (complete) complete();
    std::error_code no_file;
    for (uint32_t i = end; i < before_; ++i) {
        removed_ += std::filesystem::remove(output_.file(i), no_file) ? 1 : 0;
        if (output_.has_deep) std::filesystem::remove(output_.deep_file(i), no_file);
    }
    if (video_path_.empty()) return;
    std::error_code ignored;  // the kept images are not needed any more; a folder with other files in it stays
    for (uint32_t i = first_; i < end; ++i) std::filesystem::remove(output_.file(i), ignored);
    std::filesystem::remove(record_path_, ignored);
    std::filesystem::remove(record_path_.parent_path(), ignored);
}

ImageOutput parse_output(const std::string& text) {
    const std::string ending = lower_case(std::filesystem::path(text).extension().string());
    if (ending == ".mp4" || ending == ".mov") return {ImageOutput::Kind::kVideo, text};
    const bool exr = ending == ".exr";
    if (ending != ".png" && !exr)
        throw InputError(Setting{"output"}, text, "is no .mp4, .mov, .png or .exr",
                         "write out.mp4, out.mov, out_%04d.png, out.png, out_%04d.exr or out.exr");
    const bool numbered = NumberedPath::parse_output(Setting{"output"}, text).has_value();
    return {numbered ? ImageOutput::Kind::kNumberedImages : ImageOutput::Kind::kImage, text, exr};
}

bool ImageOutput::holds_alpha() const {
    return kind != Kind::kVideo || lower_case(path.extension().string()) == ".mov";
}

std::filesystem::path ImageOutput::file(const std::string& in_place_of_number) const {
    if (kind != Kind::kNumberedImages) return path;
    return NumberedPath::parse(path.string()).value().file(in_place_of_number);
}

std::filesystem::path ImageOutput::deep_file(uint32_t i) const {
    if (kind != Kind::kNumberedImages) return path.parent_path() / (path.stem().string() + "_deep.exr");
    const NumberedPath numbered = NumberedPath::parse(path.string()).value();
    return numbered.file("deep_" + numbered.digits(i));
}

std::filesystem::path ImageOutput::file(uint32_t i) const {
    if (kind != Kind::kNumberedImages) return path;
    return NumberedPath::parse(path.string()).value().file(uint64_t{i});
}

}  // namespace neuvv::media
