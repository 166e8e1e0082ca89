#include "tools/render_record.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <cstring>
#include <fstream>
#include <memory>
#include <vector>

#include "base/error.h"
#include "base/json.h"
#include "base/platform.h"
#include "tools/report.h"

namespace neuvv::tools {

namespace {

constexpr size_t kBlockBytes = size_t{1} << 20;
constexpr double kMaxFinished = 1e9;
constexpr char kAnew[] = "render anew without --resume, or choose another --output";

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

// A fact as a person reads it.
std::string words_of(const std::string& fact) {
    return is_content(fact) ? "a file" : fact;
}

std::string fact(const RenderFacts& facts, const std::string& name) {
    const auto found = facts.find(name);
    return found == facts.end() ? "none" : found->second;
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

void write_render_record(const std::filesystem::path& file, const RenderRecord& record) {
    nlohmann::ordered_json json = {{"render", nlohmann::ordered_json::object()}, {"finished", record.finished}};
    for (const auto& [name, value] : record.facts) json["render"][name] = value;
    const std::string text = json_text(json);
    write_file_atomically(file, [&](const ByteSink& sink) { sink(text.data(), text.size()); });
}

uint32_t finished_images(const std::filesystem::path& file, const RenderFacts& facts) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return 0;
    const RenderRecord record = read_record(file);
    RenderFacts names = facts;
    names.insert(record.facts.begin(), record.facts.end());
    std::string differing;  // a file rather than what follows from it
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
            : fmt::format("was {} for the images that are there, and is {} now", words_of(then), words_of(now)),
        kAnew);
}

}  // namespace neuvv::tools
