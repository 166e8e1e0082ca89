// What the verbs print alike: JSON for scripts, sizes for people, pass times for the curious.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "gpu/commands.h"

namespace neuvv::tools {

// Names from file systems need not be UTF-8; JSON is.
std::string json_text(const nlohmann::ordered_json& json);

// "12.3 MB".
std::string size_text(uint64_t bytes);

// NEUVV_TRACE=1 asks for times.
bool trace_wanted();
// "slice 1.2 ms, trace 20.1 ms; 21.3 ms".
std::string pass_times_text(const std::vector<gpu::PassTime>& times);

// The part of a --help that verbs on the GPU share.
constexpr const char* kDeviceHelp =
    "--device NAME or NEUVV_DEVICE=NAME chooses the Vulkan device; `neuvv devices` lists them.";

// Before the examples of verbs that need a trained scene.
constexpr const char* kExamplesHead =
    "\n\nExamples, after `neuvv capture tools/performer/performer.glb -o build/performer` and\n"
    "`neuvv train build/performer -o build/performer.nvv`:\n";

}  // namespace neuvv::tools
