#include "tools/render_share.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <charconv>

#include "base/error.h"
#include "base/file_lock.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "media/video.h"

namespace neuvv::tools {

namespace {

std::string hash_of(const media::RenderFacts& facts) {
    std::string text;
    for (const auto& [name, value] : facts) text += name + '\n' + value + '\n';
    return fmt::format("{:08x}", static_cast<uint32_t>(XXH3_64bits(text.data(), text.size())));
}

// A number from `begin` to `end`; 0 where there is none.
uint32_t number(const char* begin, const char* end) {
    uint32_t value = 0;
    const auto [last, problem] = std::from_chars(begin, end, value);
    return problem == std::errc() && last == end ? value : 0;
}

}  // namespace

RenderPart part_of(const std::string& text, const Ranks& ranks) {
    if (text.empty()) return {ranks.rank + 1, ranks.count};
    const size_t slash = std::min(text.find('/'), text.size());
    const char* const end = text.data() + text.size();
    const uint32_t part = number(text.data(), text.data() + slash);
    const uint32_t parts = slash < text.size() ? number(text.data() + slash + 1, end) : 0;
    if (part == 0 || part > parts)
        throw InputError("--part", text, "is no part of a render", "write for instance 2/8, the second of eight");
    return {part, parts};
}

RenderShare::RenderShare(RenderPart part, media::ImageOutput whole, const media::RenderFacts& facts, uint32_t images)
    : part_(part), whole_(std::move(whole)), content_(hash_of(facts)), images_(images) {
    if (part_.parts == 1) return;
    if (part_.parts > images)
        throw InputError("--part", fmt::format("{}/{}", part_.part, part_.parts),
                         fmt::format("are more parts than the {} images that there are", images), "choose fewer parts");
    if (is_video()) prepare_output_folder("--output", folder());
}

std::filesystem::path folder_of_parts(const std::filesystem::path& video) {
    return link_target(video).string() + ".parts";
}

std::filesystem::path RenderShare::video_of(uint32_t part) const {
    return folder() / fmt::format("{}-of-{}-{}.mp4", part, part_.parts, content_);
}

media::ImageOutput RenderShare::output() const {
    media::ImageOutput output = whole_;
    if (part_.parts > 1 && is_video()) output.path = video_of(part_.part);
    return output;
}

media::ImageRange RenderShare::range() const {
    if (part_.parts == 1) return {};
    return {first(), end()};
}

bool RenderShare::is_there() const {
    return part_.parts > 1 && is_video() && std::filesystem::exists(video_of(part_.part));
}

uint32_t RenderShare::missing() const {
    uint32_t count = 0;
    for (uint32_t part = 1; part <= part_.parts; part++) count += !std::filesystem::exists(video_of(part));
    return count;
}

void RenderShare::join() const {
    std::vector<std::filesystem::path> parts;
    for (uint32_t part = 1; part <= part_.parts; part++) parts.push_back(video_of(part));
    media::join_videos(parts, whole_.path);
    std::error_code ignored;
    for (const std::filesystem::path& part : parts) std::filesystem::remove(part, ignored);
}

std::string RenderShare::conclude() const {
    if (part_.parts == 1) return {};
    const std::string done =
        fmt::format("part {} of {}, images {} to {}, is there", part_.part, part_.parts, first(), end() - 1);
    if (!is_video()) return done;
    const std::filesystem::path lock = link_target(whole_.path).string() + ".lock";
    const FileLock only(lock);  // several processes may find all parts at the same time
    std::error_code ignored;
    if (!is_there()) {
        std::filesystem::remove(lock, ignored);
        return fmt::format("{}; another process joined all {} parts", done, part_.parts);
    }
    if (const uint32_t left = missing(); left > 0) return fmt::format("{}; {} more are missing", done, left);
    join();
    std::filesystem::remove(folder(), ignored);  // stays where other files are in it
    std::filesystem::remove(lock, ignored);
    return fmt::format("{}; joined all {} parts: {} images", done, part_.parts, images_);
}

}  // namespace neuvv::tools
