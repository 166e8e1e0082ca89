#include "tools/render/render_part.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <charconv>
#include <fstream>

#include "base/error.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "media/video.h"

namespace neuvv::tools {

namespace {

std::string hash_of(const media::RenderFacts& facts) {
    std::string text;
    for (const auto& [name, value] : facts) text += fmt::format("{}\n{}\n", name, value);
    return fmt::format("{:08x}", static_cast<uint32_t>(XXH3_64bits(text.data(), text.size())));
}

// A number from `begin` to `end`; 0 where there is none.
uint32_t number(const char* begin, const char* end) {
    uint32_t value = 0;
    const auto [last, problem] = std::from_chars(begin, end, value);
    return problem == std::errc() && last == end ? value : 0;
}

// A client of a network's file system may remember for a while that a file is or is not there, but not whether it can
// be opened.
bool can_be_opened(const std::filesystem::path& file) {
    return std::ifstream(file, std::ios::binary).is_open();
}

std::filesystem::path lock_of(const std::filesystem::path& video) {
    return video.string() + ".lock";
}

void remove_if_there(const std::filesystem::path& file) {
    std::error_code ignored;
    std::filesystem::remove(file, ignored);
}

}  // namespace

PartNumber part_number(const std::string& text, const Ranks& ranks) {
    if (text.empty()) return {ranks.rank + 1, ranks.count};
    const size_t slash = std::min(text.find('/'), text.size());
    const char* const end = text.data() + text.size();
    const uint32_t part = number(text.data(), text.data() + slash);
    const uint32_t parts = slash < text.size() ? number(text.data() + slash + 1, end) : 0;
    if (part == 0 || part > parts)
        throw InputError("--part", text, "is no part of a render", "write for instance 2/8, the second of eight");
    return {part, parts};
}

media::ImageRange images_of(const PartNumber& number, uint32_t images) {
    const auto bound = [&](uint32_t parts) { return static_cast<uint32_t>(uint64_t{images} * parts / number.parts); };
    return {bound(number.part - 1), bound(number.part)};
}

void expect_enough_images(const PartNumber& number, uint32_t images) {
    if (number.parts > images)
        throw InputError("--part", "", fmt::format("{} parts are too many for {} images", number.parts, images),
                         "choose fewer parts, or start fewer processes");
}

std::filesystem::path folder_of_parts(const media::ImageOutput& whole) {
    if (whole.kind == media::ImageOutput::Kind::kVideo) return link_target(whole.path).string() + ".parts";
    return whole.file("render").replace_extension(".parts");
}

RenderPart::RenderPart(PartNumber number, media::ImageOutput whole, const media::RenderFacts& facts, uint32_t images,
                       bool resume)
    : number_(number), whole_(std::move(whole)), facts_hash_(hash_of(facts)), images_(images) {
    expect_enough_images(number_, images);
    if (!is_part_of_video() || (resume && is_joined())) return;
    prepare_output_folder("--output", folder_of_parts(whole_));
    const std::filesystem::path video = video_of(number_.part);
    lock_ = FileLock::try_lock(lock_of(video));
    if (!lock_)
        throw InputError("--part", fmt::format("{}/{}", number_.part, number_.parts),
                         "is being rendered by another process", "leave it to that one, or stop it first");
    if (!resume) remove_if_there(video);
}

std::filesystem::path RenderPart::video_of(uint32_t part) const {
    return folder_of_parts(whole_) / fmt::format("{}-of-{}-{}{}", part, number_.parts, facts_hash_, ending());
}

// Beside the folder of parts, which the process that joins them removes.
std::filesystem::path RenderPart::lock_of_join() const {
    return lock_of(link_target(whole_.path));
}

media::ImageOutput RenderPart::output() const {
    media::ImageOutput output = whole_;
    if (is_part_of_video()) output.path = video_of(number_.part);
    return output;
}

std::optional<media::ImageRange> RenderPart::range() const {
    if (number_.parts == 1) return std::nullopt;
    return media::ImageRange{first(), end()};
}

bool RenderPart::is_joined() const {
    return can_be_opened(whole_.path) && media::comment_of_video(whole_.path) == facts_hash_;
}

bool RenderPart::is_there() const {
    return is_part_of_video() && (can_be_opened(video_of(number_.part)) || is_joined());
}

uint32_t RenderPart::missing() const {
    uint32_t count = 0;
    for (uint32_t part = 1; part <= number_.parts; ++part) count += !can_be_opened(video_of(part));
    return count;
}

void RenderPart::finish_whole() const {
    if (number_.parts == 1 && finish_ && whole_.kind == media::ImageOutput::Kind::kVideo) finish_(whole_.path);
}

void RenderPart::join() const {
    std::vector<std::filesystem::path> parts;
    for (uint32_t part = 1; part <= number_.parts; ++part) parts.push_back(video_of(part));
    const std::filesystem::path joined = folder_of_parts(whole_) / fmt::format("whole-{}{}", facts_hash_, ending());
    media::join_videos(parts, joined, facts_hash_);
    if (finish_) finish_(joined);
    replace_file(link_target(whole_.path), joined);
    for (const std::filesystem::path& part : parts) remove_if_there(part);
}

std::string RenderPart::join_if_complete() const {
    if (number_.parts == 1) return {};
    const std::string done =
        fmt::format("part {} of {}, images {} to {}, is there", number_.part, number_.parts, first(), end() - 1);
    if (!is_part_of_video()) return done;
    remove_if_there(lock_of(video_of(number_.part)));
    const FileLock only(lock_of_join());  // several processes may find all parts at the same time
    std::string rest;
    if (!can_be_opened(video_of(number_.part))) {
        rest = "all parts are joined already";
        remove_if_there(folder_of_parts(whole_));
    } else if (const uint32_t left = missing(); left > 0) {
        rest = fmt::format("parts that are still missing in {}: {}", folder_of_parts(whole_).string(), left);
    } else {
        join();
        rest = fmt::format("joined all {} parts: {} images", number_.parts, images_);
        remove_if_there(folder_of_parts(whole_));  // it stays where other files are in it
    }
    remove_if_there(lock_of_join());
    return fmt::format("{}; {}", done, rest);
}

}  // namespace neuvv::tools
