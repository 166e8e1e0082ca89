#include "tools/publish/stream_info.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/formats/json.h"
#include "stream/transport/nvs_reader.h"
#include "tools/report.h"
#include "tools/say.h"

namespace neuvv::tools {

namespace {

constexpr std::array<const char*, stream::kParts> kPartNames = {"shape", "coarse", "sh_coarse", "fine", "sh_fine"};

// Bytes of each part in all frames.
std::array<uint64_t, stream::kParts> bytes_of_parts(const stream::Index& index) {
    std::array<uint64_t, stream::kParts> bytes{};
    for (const stream::FrameEntry& frame : index.frames)
        for (size_t part = 0; part < stream::kParts; ++part) bytes[part] += frame.bytes[part];
    return bytes;
}

}  // namespace

void print_stream_info(const std::filesystem::path& path, bool json, bool check) {
    stream::Reader reader(path);
    const stream::Index& index = reader.index();
    const auto frames = static_cast<uint32_t>(index.frames.size());
    if (check) {
        Progress progress("check", frames);
        for (uint32_t i = 0; i < frames; ++i) {
            reader.frame(i);
            progress.update(i + 1);
        }
    }
    uint32_t most_leaves = 0;
    uint64_t largest = 0;
    for (const stream::Group& group : index.groups) most_leaves = std::max(most_leaves, group.format.most_leaves);
    for (const stream::FrameEntry& frame : index.frames) largest = std::max(largest, frame.all_bytes());
    const std::array<uint64_t, stream::kParts> bytes = bytes_of_parts(index);
    const uint64_t all = reader.stamp().bytes;
    const double seconds = frames / double{index.fps}, mbps = 8e-6 * static_cast<double>(all) / seconds;
    if (json) {
        nlohmann::ordered_json parts;
        for (size_t part = 0; part < stream::kParts; ++part) parts[kPartNames[part]] = bytes[part];
        tell("{}", json_text({{"file", path.string()},
                              {"format", "nvs"},
                              {"bytes", all},
                              {"frames", frames},
                              {"fps", index.fps},
                              {"seconds", seconds},
                              {"mbps", mbps},
                              {"capture", capture_json(path)},
                              {"groups", index.groups.size()},
                              {"most_leaves", most_leaves},
                              {"largest_frame", largest},
                              {"parts", parts},
                              {"checked", check}}));
        return;
    }
    tell("{}: stream, {}\nclip    {} frames at {} fps, {:.2f} s, in {} groups\n", path.string(), size_text(all), frames,
         index.fps, seconds, index.groups.size());
    tell("{}", capture_line(path));
    tell("leaves  {} at most, in cells of {} a side\n", most_leaves, 1u << index.groups[0].format.depth);
    const uint64_t of_frames = std::accumulate(bytes.begin(), bytes.end(), uint64_t{0});
    tell("rate    {:.1f} Mbit/s, {:.1f} KB a frame with the tables of its group and the index\n", mbps,
         1e-3 * static_cast<double>(all) / frames);
    tell("frames  {:.1f} KB without them, {:.1f} KB at most; of these\n",
         1e-3 * static_cast<double>(of_frames) / frames, 1e-3 * static_cast<double>(largest));
    for (size_t part = 0; part < stream::kParts; ++part)
        tell("{:<10} {:>8.1f} KB a frame\n", kPartNames[part], 1e-3 * static_cast<double>(bytes[part]) / frames);
    if (check) tell("checked: whole and sound\n");
}

}  // namespace neuvv::tools
