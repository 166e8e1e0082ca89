// Negotiation with the loader, which finds all functions by it.
#include <cstddef>
#include <cstring>

#include "call.h"

namespace neuvv::xr_runtime {

namespace {

// Two structs of the loader; Debian does not package their header.
constexpr int kLoaderInfo = 1, kRuntimeRequest = 3;
constexpr uint32_t kStructVersion = 1, kInterfaceVersion = 1;

struct NegotiateLoaderInfo {
    int struct_type;
    uint32_t struct_version;
    size_t struct_size;
    uint32_t min_interface_version, max_interface_version;
    XrVersion min_api_version, max_api_version;
};
struct NegotiateRuntimeRequest {
    int struct_type;
    uint32_t struct_version;
    size_t struct_size;
    uint32_t runtime_interface_version;
    XrVersion runtime_api_version;
    PFN_xrGetInstanceProcAddr get_instance_proc_addr;
};

XrResult get_instance_proc_addr(XrInstance handle, const char* name, PFN_xrVoidFunction* function);
using GetProcAddr = Entry<&get_instance_proc_addr, "xrGetInstanceProcAddr">;

const std::vector<EntryPoint>& all_entries() {
    static const std::vector<EntryPoint> all = [] {
        std::vector<EntryPoint> list = {NEUVV_XR_ENTRY(xrGetInstanceProcAddr, get_instance_proc_addr)};
        for (const auto& table :
             {instance_entries(), system_entries(), graphics_entries(), session_entries(), frame_entries(),
              swapchain_entries(), space_entries(), view_entries(), action_entries(), binding_entries(),
              input_entries(), hand_entries(), body_entries(), passthrough_entries(), debug_entries()})
            list.insert(list.end(), table.begin(), table.end());
        return list;
    }();
    return all;
}

// The functions that xrGetInstanceProcAddr returns without an instance.
bool is_global(const char* name) {
    for (const char* global : {"xrEnumerateInstanceExtensionProperties", "xrEnumerateApiLayerProperties",
                               "xrCreateInstance", "xrGetInstanceProcAddr"})
        if (!std::strcmp(name, global)) return true;
    return false;
}

XrResult get_instance_proc_addr(XrInstance handle, const char* name, PFN_xrVoidFunction* function) {
    check_pointer(name, "name");
    check_pointer(function, "function");
    *function = nullptr;
    if (handle == XR_NULL_HANDLE && !is_global(name)) decline(XR_ERROR_HANDLE_INVALID);
    for (const EntryPoint& entry : all_entries()) {
        if (std::strcmp(name, entry.name) != 0) continue;
        // The loader and layers query all functions that they know: a query is no violation, only a call is.
        if (entry.extension) {
            const Instance& instance = *shared<Instance>(handle);
            const bool is_enabled =
                instance.has(entry.extension) || (entry.other_extension && instance.has(entry.other_extension));
            if (!is_enabled) decline(XR_ERROR_FUNCTION_UNSUPPORTED);
        }
        *function = entry.function;
        return XR_SUCCESS;
    }
    return XR_ERROR_FUNCTION_UNSUPPORTED;
}

}  // namespace

bool has_function(const std::string& name) {
    const auto& all = all_entries();
    return std::any_of(all.begin(), all.end(), [&](const EntryPoint& entry) { return name == entry.name; });
}

}  // namespace neuvv::xr_runtime

extern "C" __attribute__((visibility("default"))) XrResult XRAPI_CALL xrNegotiateLoaderRuntimeInterface(
    const neuvv::xr_runtime::NegotiateLoaderInfo* loader, neuvv::xr_runtime::NegotiateRuntimeRequest* request) {
    using namespace neuvv::xr_runtime;
    const XrVersion version = XR_MAKE_VERSION(1, 0, 20);
    if (!loader || !request || loader->struct_type != kLoaderInfo || request->struct_type != kRuntimeRequest ||
        loader->struct_size != sizeof *loader || request->struct_size != sizeof *request ||
        loader->min_interface_version > kInterfaceVersion || loader->max_interface_version < kInterfaceVersion ||
        loader->min_api_version > version)
        return XR_ERROR_INITIALIZATION_FAILED;
    request->runtime_interface_version = kInterfaceVersion;
    request->runtime_api_version = version;
    request->get_instance_proc_addr = &GetProcAddr::call;
    return XR_SUCCESS;
}
