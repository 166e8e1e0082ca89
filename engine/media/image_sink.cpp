#include "media/image_sink.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <cassert>
#include <fstream>
#include <memory>
#include <vector>

#include "base/error.h"
#include "base/json.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "base/text.h"

namespace neuvv::media {

namespace {

constexpr int kMaxDigits = 9;  // of a numbered file name

// The number in a printf pattern: its first character, the one after its last, and its minimum number of digits.
struct NumberField {
    size_t begin = 0, end = 0;
    int digits = 1;
};

// %d or %0Nd at `begin`; nothing where anything else follows the %, for instance in "%%".
std::optional<NumberField> number_field(const std::string& text, size_t begin) {
    NumberField field{begin, begin + 1, 1};
    if (field.end < text.size() && text[field.end] == '0') {
        ++field.end;
        if (field.end >= text.size() || !std::isdigit(static_cast<unsigned char>(text[field.end]))) return {};
        field.digits = text[field.end++] - '0';
    }
    if (field.end >= text.size() || text[field.end] != 'd' || field.digits < 1 || field.digits > kMaxDigits) return {};
    ++field.end;
    return field;
}

constexpr char kRecordName[] = "render";  // the record of out_%04d.png is out_render.json

bool is_file(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored);
}

constexpr size_t kBlockBytes = size_t{1} << 20;
constexpr double kMaxFinished = 1e9;
constexpr char kAnew[] = "render anew without --resume, or choose another --output";

struct RenderRecord {
    RenderFacts facts;
    uint32_t finished = 0;  // the image behind the last one that is finished
};

RenderRecord read_record(const std::filesystem::path& path) {
    const JsonFile file = read_json(path, "the record of a render");
    const JsonNode root = file.root();
    RenderRecord record;
    if (!root.has("render") || !root["render"].value.is_object() || !root.has("finished"))
        root.fail("is not the record of a render", kAnew);
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
        kAnew);
}

}  // namespace

std::string content_fact(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), XXH3_freeState);
    XXH3_64bits_reset(state.get());
    std::vector<char> block(kBlockBytes);
    while (file.read(block.data(), static_cast<std::streamsize>(block.size())) || file.gcount() > 0)
        XXH3_64bits_update(state.get(), block.data(), static_cast<size_t>(file.gcount()));
    if (!file.eof() || file.bad()) throw InputError(path.string(), "", "cannot be read");
    return fmt::format("{}{:016x}", kContent, XXH3_64bits_digest(state.get()));
}

ImageSink::ImageSink(ImageOutput output, ImageSize size, double fps, RenderFacts facts, bool resume, ImageRange range)
    : output_(std::move(output)),
      size_(size),
      fps_(fps),
      facts_(std::move(facts)),
      first_(range.first),
      finished_(range.first) {
    const bool is_part = range.end != UINT32_MAX;
    if (is_part) facts_["--part"] = fmt::format("images {} to {}", range.first, range.end);
    using Kind = ImageOutput::Kind;
    if (output_.kind == Kind::kVideo && resume) {
        video_path_ = output_.path;
        const std::filesystem::path folder = link_target(video_path_).string() + ".frames";
        prepare_output_folder("--output", folder);
        output_ = {Kind::kNumberedImages, folder / "%06d.png"};
    }
    if (output_.kind == Kind::kVideo) video_.emplace(output_.path, size.width, size.height, fps);
    if (output_.kind != Kind::kNumberedImages) return;
    const std::string name = is_part ? fmt::format("{}_from_{}", kRecordName, range.first) : kRecordName;
    record_path_ = output_.file(name).replace_extension(".json");
    if (resume) finished_ = std::max(finished_images(record_path_, facts_), first_);
    write_record(record_path_, facts_, finished_);
}

bool ImageSink::has(uint32_t i) const {
    return i >= first_ && i < finished_ && is_file(output_.file(i));
}

void ImageSink::record_finished(uint32_t i) {
    if (record_path_.empty() || i < finished_) return;
    finished_ = i + 1;
    write_record(record_path_, facts_, finished_);
}

void ImageSink::add(uint32_t i, const Image& image) {
    assert(!output_.exr && "this output takes linear images");
    if (video_)
        video_->add(image);
    else
        write_png(output_.file(i), image);
    record_finished(i);
}

void ImageSink::add(uint32_t i, const LinearImage& image) {
    assert(output_.exr && "this output takes sRGB images");
    write_exr(output_.file(i), image);
    record_finished(i);
}

void ImageSink::finish(uint32_t end) {
    if (!video_path_.empty()) {
        video_.emplace(video_path_, size_.width, size_.height, fps_);
        for (uint32_t i = first_; i < end; ++i) video_->add(read_png(output_.file(i)));
    }
    if (video_) video_->finish();
    if (video_path_.empty()) return;
    std::error_code ignored;  // the kept images are not needed any more; a folder with other files in it stays
    for (uint32_t i = first_; i < end; ++i) std::filesystem::remove(output_.file(i), ignored);
    std::filesystem::remove(record_path_, ignored);
    std::filesystem::remove(record_path_.parent_path(), ignored);
}

ImageOutput parse_output(const std::string& text) {
    const std::string ending = lower_case(std::filesystem::path(text).extension().string());
    if (ending == ".mp4") return {ImageOutput::Kind::kVideo, text};
    const bool exr = ending == ".exr";
    if (ending != ".png" && !exr)
        throw InputError("--output", text, "is neither an .mp4 nor a .png nor an .exr",
                         "write out.mp4, out_%04d.png, out.png, out_%04d.exr or out.exr");
    const size_t percent = text.find('%');
    if (percent == std::string::npos) return {ImageOutput::Kind::kImage, text, exr};
    const auto field = number_field(text, percent);
    if (!field || text.find('%', field->end) != std::string::npos)
        throw InputError("--output", text, "needs one place for the image's number", "write it as in out_%04d.png");
    return {ImageOutput::Kind::kNumberedImages, text, exr};
}

std::filesystem::path ImageOutput::file(const std::string& in_place_of_number) const {
    if (kind != Kind::kNumberedImages) return path;
    const std::string text = path.string();
    const NumberField field = number_field(text, text.rfind('%')).value();
    return text.substr(0, field.begin) + in_place_of_number + text.substr(field.end);
}

std::filesystem::path ImageOutput::file(uint32_t i) const {
    if (kind != Kind::kNumberedImages) return path;
    const std::string text = path.string();
    return file(fmt::format("{:0{}}", i, number_field(text, text.rfind('%')).value().digits));
}

}  // namespace neuvv::media
