// neuvv devices: lists the Vulkan devices of this machine, and what each lacks.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/formats/json.h"
#include "gpu/buffer_speed.h"
#include "gpu/device.h"
#include "tools/commands.h"
#include "tools/report.h"

namespace neuvv::tools {

namespace {

std::string version_text(uint32_t version) {
    return fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version),
                       VK_API_VERSION_PATCH(version));
}

const char* name_of(gpu::ProfileReason reason) {
    switch (reason) {
        case gpu::ProfileReason::kForced:
            return "forced";
        case gpu::ProfileReason::kLimits:
            return "limits";
        case gpu::ProfileReason::kSpeed:
            return "speed";
    }
    return "";
}

nlohmann::ordered_json json_of(const gpu::BufferLimits& limits) {
    auto profiles = nlohmann::ordered_json::array({"texel"});
    if (limits.allow_storage()) profiles.push_back("storage");
    using Json = nlohmann::ordered_json;
    return {{"profile", profile_name(limits.profile)},
            {"reason", name_of(limits.reason)},
            {"texel_ms", limits.times ? Json(limits.times->texel_ms) : Json()},
            {"storage_ms", limits.times ? Json(limits.times->storage_ms) : Json()},
            {"profiles", profiles},
            {"max_texels", limits.texels},
            {"max_storage_bytes", limits.storage_bytes},
            {"max_storage_buffers", limits.storage_buffers}};
}

nlohmann::ordered_json budget_of(const gpu::DeviceSummary& device) {
    if (!device.memory.budget) return nullptr;
    return *device.memory.budget;
}

std::string memory_text(const gpu::HeapMemory& memory) {
    if (!memory.budget) return fmt::format("{} (does not tell how much of it is free)", size_text(memory.size));
    return fmt::format("{}, of which a program may take {} now and this one takes {}", size_text(memory.size),
                       size_text(*memory.budget), size_text(memory.used));
}

nlohmann::ordered_json json_of(const std::vector<gpu::DeviceSummary>& devices) {
    auto list = nlohmann::ordered_json::array();
    for (const gpu::DeviceSummary& device : devices)
        list.push_back({{"index", device.index},
                        {"name", device.name},
                        {"kind", device.kind},
                        {"driver", device.driver},
                        {"vulkan", version_text(device.api_version)},
                        {"memory_bytes", device.memory.size},
                        {"memory_budget_bytes", budget_of(device)},
                        {"memory_used_bytes", device.memory.used},
                        {"buffers", json_of(device.buffers)},
                        {"transfer_queue", device.transfer_queue},
                        {"usable", device.missing.empty()},
                        {"missing", device.missing},
                        {"lacks", device.missing_optional}});
    return list;
}

void print(const gpu::DeviceSummary& device) {
    const gpu::BufferLimits& limits = device.buffers;
    const std::string texel = fmt::format("texel buffers of up to {} elements", limits.texels);
    const std::string storage = fmt::format("storage buffers of up to {}", size_text(limits.storage_bytes));
    if (limits.reason == gpu::ProfileReason::kSpeed && !limits.times)
        fmt::print("   arrays in {}, or in {} if the next start finds those faster\n", texel, storage);
    else if (limits.profile == gpu::BufferProfile::kStorage)
        fmt::print("   arrays in {} (NEUVV_BUFFERS=texel: in {})\n", storage, texel);
    else if (limits.allow_storage())
        fmt::print("   arrays in {} (NEUVV_BUFFERS=storage: in {})\n", texel, storage);
    else if (!limits.addresses)
        fmt::print("   arrays in {} (it has no addresses of buffers)\n", texel);
    else
        fmt::print("   arrays in {} (shaders bind at most {} storage buffers, {} would be needed)\n", texel,
                   limits.storage_buffers, gpu::kMostStorageBuffers);
    if (limits.times)
        fmt::print("   as timed at an earlier start: {} (delete {} to have them timed again)\n", profile_text(limits),
                   gpu::profile_times_file(device).string());
}

void print(const std::vector<gpu::DeviceSummary>& devices) {
    for (const gpu::DeviceSummary& device : devices) {
        fmt::print("{}  {}\n", device.index, device.name);
        fmt::print("   {}, Vulkan {}, {}\n", device.kind, version_text(device.api_version), device.driver);
        fmt::print("   memory: {}\n", memory_text(device.memory));
        fmt::print("   {}\n", device.missing.empty() ? "usable" : "not usable");
        print(device);
        fmt::print("   uploads run {}\n", device.transfer_queue ? "on a queue of their own, while images are drawn"
                                                                : "on the queue that draws");
        for (const std::string& feature : device.missing) fmt::print("   missing: {}\n", feature);
        for (const std::string& feature : device.missing_optional) fmt::print("   does without: {}\n", feature);
    }
}

void run(bool json) {
    const std::vector<gpu::DeviceSummary> devices = gpu::list_devices();
    if (json)
        fmt::print("{}", json_text(json_of(devices)));
    else
        print(devices);
    if (devices.empty())
        throw RuntimeFailure("no Vulkan device on this machine; the package mesa-vulkan-drivers brings a software one");
}

}  // namespace

void add_devices(Command app, CommonOptions&) {
    Command verb = app.add_verb("devices", "List the Vulkan devices of this machine and what each lacks");
    const auto json = std::make_shared<bool>(false);
    verb.add_flag("--json", *json,
                  "Print JSON: index, name, kind, driver, vulkan, memory_bytes, memory_budget_bytes (null: the device "
                  "does not tell), memory_used_bytes, buffers, transfer_queue, usable, missing, lacks");
    verb.footer(
        {"Other verbs take the best usable device: discrete, integrated, virtual, then CPU. --device or NEUVV_DEVICE\n"
         "chooses another by its index or a part of its name. Passes bind long arrays as texel buffers or as storage\n"
         "buffers, whichever may be longer there; where both hold 2 GiB or equally much, the first start times them,\n"
         "and keeps the times in the cache folder. NEUVV_BUFFERS=texel or storage decides, NEUVV_BUFFERS=fastest\n"
         "times them wherever the device allows both. Training takes storage buffers only where a shader can bind 14.\n"
         "NEUVV_DEVICE_MEMORY sets how many MiB of its memory a program takes at most.\n\n"
         "Examples:\n"
         "  neuvv devices\n"
         "  neuvv devices --json\n"
         "  NEUVV_DEVICE=llvmpipe neuvv devices"});
    verb.callback([json] { run(*json); });
}

}  // namespace neuvv::tools
