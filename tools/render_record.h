// What lies beside the images of a render: all that they depend on, and how many are finished. A render that was
// interrupted goes on by it, and two different ones are not mixed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace neuvv::tools {

// By the name that a user knows it by: an option, or the scene.
using RenderFacts = std::map<std::string, std::string>;

// "xxh3:…" of a file's content: the same wherever the file lies and whenever it was written. Throws InputError.
std::string content_fact(const std::filesystem::path& file);

struct RenderRecord {
    RenderFacts facts;
    uint32_t finished = 0;  // images, from the first
};

// Atomically.
void write_render_record(const std::filesystem::path& file, const RenderRecord& record);

// How many images are finished of a render with these facts; 0 where there is no record. Throws InputError for a
// record of another render, naming what differs, and for a damaged one.
uint32_t finished_images(const std::filesystem::path& file, const RenderFacts& facts);

}  // namespace neuvv::tools
