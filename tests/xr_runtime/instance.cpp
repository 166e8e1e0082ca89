// Instances, their extensions, paths and events.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "call.h"
#include "session.h"

namespace neuvv::xr_runtime {

namespace {

std::string environment(const char* name) {
    const char* value = std::getenv(name);
    return value ? value : "";
}

// Of this process; 0 where the system does not tell.
int64_t resident_bytes() {
    std::ifstream stream("/proc/self/statm");
    int64_t pages = 0, resident = 0;
    stream >> pages >> resident;
    return resident * sysconf(_SC_PAGESIZE);
}

std::string script_text() {
    const std::string file = environment("NEUVV_XR_SCRIPT");
    if (file.empty()) return "";
    std::ifstream stream(file);
    if (!stream) throw std::runtime_error("NEUVV_XR_SCRIPT cannot be read");
    return {std::istreambuf_iterator<char>(stream), {}};
}

// With a wrong script all extensions are offered, so that the loader continues to xrCreateInstance, which reports what
// is wrong.
Script script_for_loader() {
    try {
        return parse_script(script_text());
    } catch (const std::exception&) {
        return parse_script("");
    }
}

void replace_configuration(const std::string& text) {
    const std::string folder = environment("NEUVV_XR_OUT");
    const std::string configuration = environment("NEUVV_XR_SCRIPT") + '\n' + folder + '\n' + text;
    Runtime& state = runtime();
    if (state.configuration == configuration) return;
    state.script = parse_script(text);
    if (!folder.empty()) std::filesystem::create_directories(folder);
    state.configuration = configuration;
    state.report = {};
    state.report.folder = folder;
    state.progress = {};
    state.progress.refresh_hz = state.script.refresh_hz;
    state.progress.profile = state.script.profile;
    timespec clock;
    clock_gettime(CLOCK_MONOTONIC, &clock);
    if (!state.script.is_real_time)
        state.progress.clock_base = now() - (static_cast<XrTime>(clock.tv_sec) * 1'000'000'000 + clock.tv_nsec);
}

}  // namespace

void load_configuration() {
    try {
        replace_configuration(script_text());
    } catch (const std::exception& error) {
        fmt::print(stderr, "xr-runtime: {}: {}\n", environment("NEUVV_XR_SCRIPT"), error.what());
        throw Refusal{XR_ERROR_RUNTIME_FAILURE};
    }
}

namespace {

XrResult enumerate_extensions(const char* layer, uint32_t capacity, uint32_t* count, XrExtensionProperties* out) {
    if (layer) decline(XR_ERROR_API_LAYER_NOT_PRESENT);
    const Script script = script_for_loader();
    const auto& all = implemented_extensions();
    return give_structs(capacity, count, out, script.extensions.size(), [&](XrExtensionProperties& row, size_t i) {
        const auto known = std::find_if(all.begin(), all.end(), [&](const XrExtensionProperties& extension) {
            return script.extensions[i] == extension.extensionName;
        });
        std::memcpy(row.extensionName, known->extensionName, sizeof row.extensionName);
        row.extensionVersion = known->extensionVersion;
    });
}

XrResult enumerate_layers(uint32_t capacity, uint32_t* count, XrApiLayerProperties* out) {
    return give_structs(capacity, count, out, 0, [](XrApiLayerProperties&, size_t) {});
}

XrResult create_instance(const XrInstanceCreateInfo* create_info, XrInstance* handle) {
    const XrInstanceCreateInfo& info = checked(create_info);
    check_pointer(handle, "instance");
    Runtime& state = runtime();
    if (state.instance) decline(XR_ERROR_LIMIT_REACHED);
    require(info.createFlags == 0, XR_ERROR_VALIDATION_FAILURE, "flags", "XrInstanceCreateInfo.createFlags must be 0");
    const XrVersion version = info.applicationInfo.apiVersion;
    if (XR_VERSION_MAJOR(version) != 1 || XR_VERSION_MINOR(version) != 0) decline(XR_ERROR_API_VERSION_UNSUPPORTED);
    require(info.applicationInfo.applicationName[0], XR_ERROR_NAME_INVALID, "name",
            "applicationName must not be empty");
    std::set<std::string> extensions;
    for (uint32_t i = 0; i < info.enabledExtensionCount; ++i) {
        const std::string name = info.enabledExtensionNames[i];
        const auto& offered = state.script.extensions;
        require(std::find(offered.begin(), offered.end(), name) != offered.end(), XR_ERROR_EXTENSION_NOT_PRESENT,
                "extension", name + " is enabled without having been enumerated");
        extensions.insert(name);
    }
    state.report.resident_bytes.push_back(resident_bytes());
    state.instance = make_object<Instance>();
    state.instance->extensions = extensions;
    state.report.is_destroyed_cleanly = false;
    state.instance->last_poll_frame = state.progress.frame();
    state.instance->first_path = (state.next_serial << 20) + 1;
    *handle = state.instance->handle;
    check_chain(info.type, "XrInstanceCreateInfo", create_info);  // after the enabled extensions are known
    state.report.write();
    return XR_SUCCESS;
}

XrResult destroy_instance(XrInstance handle) {
    const auto instance = shared<Instance>(handle);
    Runtime& state = runtime();
    for (const auto& swapchain : all_of<Swapchain>())
        if (!swapchain->acquired.empty() && !instance->is_lost)
            warn("swapchain", "the instance is destroyed while a swapchain image is acquired");
    if (state.session) destroy_session_now(*state.session);
    state.objects.clear();
    state.instance.reset();
    state.report.is_destroyed_cleanly = true;
    state.report.write();
    return XR_SUCCESS;
}

XrResult get_instance_properties(XrInstance handle, XrInstanceProperties* out) {
    instance_of(handle);
    XrInstanceProperties& properties = checked(out);
    properties.runtimeVersion = XR_MAKE_VERSION(0, 1, 0);
    std::snprintf(properties.runtimeName, sizeof properties.runtimeName, "NeuVV test runtime");
    return XR_SUCCESS;
}

XrResult poll_event(XrInstance handle, XrEventDataBuffer* buffer) {
    Instance& instance = instance_of(handle);
    check_pointer(buffer, "eventData");
    require(buffer->type == XR_TYPE_EVENT_DATA_BUFFER, XR_ERROR_VALIDATION_FAILURE, "type",
            "XrEventDataBuffer.type must be set to XR_TYPE_EVENT_DATA_BUFFER before every xrPollEvent");
    instance.last_poll_frame = runtime().progress.frame();
    if (instance.events.empty()) {
        if (runtime().session) pass_idle_poll(*runtime().session);
        return XR_EVENT_UNAVAILABLE;
    }
    *buffer = instance.events.front();
    instance.events.pop_front();
    return XR_SUCCESS;
}

template <size_t kSize>
void put_name(char (&buffer)[kSize], const std::string& name) {
    std::snprintf(buffer, kSize, "%s", name.c_str());
}

XrResult result_to_string(XrInstance handle, XrResult value, char buffer[XR_MAX_RESULT_STRING_SIZE]) {
    instance_of(handle);
    check_pointer(buffer, "buffer");
    std::snprintf(buffer, XR_MAX_RESULT_STRING_SIZE, "%s", name_of(value).c_str());
    return XR_SUCCESS;
}

XrResult structure_type_to_string(XrInstance handle, XrStructureType value, char buffer[XR_MAX_STRUCTURE_NAME_SIZE]) {
    instance_of(handle);
    check_pointer(buffer, "buffer");
    std::snprintf(buffer, XR_MAX_STRUCTURE_NAME_SIZE, "%s", name_of(value).c_str());
    return XR_SUCCESS;
}

// The rules of the specification's section "Well-Formed Path Strings".
bool is_well_formed(const std::string& path) {
    if (path.empty() || path.front() != '/' || path.size() < 2 || path.size() >= XR_MAX_PATH_LENGTH) return false;
    bool only_dots = true, is_empty = true;
    for (const char c : path.substr(1) + '/') {
        if (c == '/') {
            if (only_dots || is_empty) return false;
            only_dots = is_empty = true;
            continue;
        }
        const bool is_allowed = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.';
        if (!is_allowed) return false;
        is_empty = false;
        only_dots = only_dots && c == '.';
    }
    return true;
}

XrResult string_to_path(XrInstance handle, const char* text, XrPath* path) {
    instance_of(handle);
    check_pointer(text, "pathString");
    check_pointer(path, "path");
    require(is_well_formed(text), XR_ERROR_PATH_FORMAT_INVALID, "path",
            fmt::format("'{}' is no well-formed path", text));
    *path = path_of(text);
    return XR_SUCCESS;
}

XrResult path_to_string(XrInstance handle, XrPath path, uint32_t capacity, uint32_t* count, char* out) {
    instance_of(handle);
    return give_text(capacity, count, out, text_of(path));
}

XrResult timespec_to_time(XrInstance handle, const timespec* from, XrTime* time) {
    instance_of(handle);
    check_pointer(from, "timespecTime");
    check_pointer(time, "time");
    const XrTime clock = static_cast<XrTime>(from->tv_sec) * 1'000'000'000 + from->tv_nsec;
    *time = clock + runtime().progress.clock_base;
    return *time > 0 ? XR_SUCCESS : XR_ERROR_TIME_INVALID;
}

XrResult time_to_timespec(XrInstance handle, XrTime time, timespec* to) {
    instance_of(handle);
    check_pointer(to, "timespecTime");
    check_time(time);
    const XrTime clock = time - runtime().progress.clock_base;
    *to = {static_cast<time_t>(clock / 1'000'000'000), static_cast<long>(clock % 1'000'000'000)};
    return XR_SUCCESS;
}

}  // namespace

// Writes the report of a process that ends without xrDestroyInstance, unless another thread is still in an entry point.
__attribute__((destructor)) void write_last_report() {
    const std::unique_lock lock(runtime().mutex, std::try_to_lock);
    if (lock && runtime().instance) runtime().report.write();
}

Runtime& runtime() {
    // Never destroyed, as other threads may call the runtime until the process ends.
    static Runtime& state = *new Runtime;
    return state;
}

std::vector<EntryPoint> instance_entries() {
    constexpr const char* kTimespec = XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME;
    return {NEUVV_XR_ENTRY(xrEnumerateInstanceExtensionProperties, enumerate_extensions),
            NEUVV_XR_ENTRY(xrEnumerateApiLayerProperties, enumerate_layers),
            NEUVV_XR_ENTRY(xrCreateInstance, create_instance),
            NEUVV_XR_ENTRY(xrDestroyInstance, destroy_instance),
            NEUVV_XR_ENTRY(xrGetInstanceProperties, get_instance_properties),
            NEUVV_XR_ENTRY(xrPollEvent, poll_event),
            NEUVV_XR_ENTRY(xrResultToString, result_to_string),
            NEUVV_XR_ENTRY(xrStructureTypeToString, structure_type_to_string),
            NEUVV_XR_ENTRY(xrStringToPath, string_to_path),
            NEUVV_XR_ENTRY(xrPathToString, path_to_string),
            NEUVV_XR_ENTRY_OF(kTimespec, nullptr, xrConvertTimespecTimeToTimeKHR, timespec_to_time),
            NEUVV_XR_ENTRY_OF(kTimespec, nullptr, xrConvertTimeToTimespecTimeKHR, time_to_timespec)};
}

}  // namespace neuvv::xr_runtime
