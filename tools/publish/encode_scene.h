// A clip, or a performer of a stage with its paint, as a stream: small enough for a rate, or good enough for a quality.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "tools/commands.h"
#include "tools/publish/published_scene.h"

namespace neuvv::tools {

struct EncodingOptions {
    std::optional<double> rate_mbps;  // where it is not given, `quality` counts
    double quality = 47, group_s = 0.5;
    uint32_t views = 6;
    std::string size = "480x270";  // of the views
};

// --rate, --quality and --group.
void add_encoding_options(Command verb, EncodingOptions& options);

struct EncodedStream {
    uint64_t bytes = 0;
    std::optional<double> psnr{};  // of the worst compared image, where a quality was asked for
    double most_mbps = 0;          // of a group
};

// Writes the .nvs, and its progress to stderr. Throws InputError where the quality cannot be reached or there are too
// many leaves, and RuntimeFailure where a signal stops it.
EncodedStream encode_scene(const EncodingOptions& options, const PublishedScene& scene, const CommonOptions& common,
                           const std::filesystem::path& output);

}  // namespace neuvv::tools
