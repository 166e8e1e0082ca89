// What surrounds every entry point: the lock, findings, refusals, and the checks that all functions share.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <initializer_list>

#include "rules.h"
#include "state.h"

namespace neuvv::xr_runtime {

// An exception that ends an entry point with a result. It never leaves the runtime.
struct Refusal {
    XrResult result;
};

// The entry point that this thread is in, and its lock of the runtime's mutex.
struct Call {
    const char* function;
    std::unique_lock<std::mutex> lock;
};
Call*& current_call();

// Report a finding of the current entry point.
void violate(Rule rule, const std::string& text);
void warn(Rule rule, const std::string& text);
// Reports a violation, and makes the call fail.
[[noreturn]] void refuse(XrResult result, Rule rule, const std::string& text);
// Makes the call fail without a finding: it is not the application's fault.
[[noreturn]] inline void decline(XrResult result) {
    throw Refusal{result};
}

inline void require(bool condition, XrResult result, Rule rule, const std::string& text) {
    if (!condition) refuse(result, rule, text);
}

// --- Handles ---

template <typename T>
uint64_t bits(T handle) {
    return reinterpret_cast<uint64_t>(handle);
}
constexpr int kKindShift = 48;  // a handle is a kind and a serial number that is never reused

template <typename T>
std::shared_ptr<T> make_object() {
    auto object = std::make_shared<T>();
    const uint64_t handle = (uint64_t{static_cast<uint8_t>(T::kKind)} << kKindShift) | runtime().next_serial++;
    object->handle = reinterpret_cast<typename T::Handle>(handle);
    runtime().objects[handle] = object;
    return object;
}

[[noreturn]] void refuse_handle(uint64_t handle, Kind kind, const char* name);

template <typename T>
std::shared_ptr<T> shared(typename T::Handle handle) {
    const auto found = runtime().objects.find(bits(handle));
    if (found == runtime().objects.end() || bits(handle) >> kKindShift != static_cast<uint8_t>(T::kKind))
        refuse_handle(bits(handle), T::kKind, T::kName);
    return std::static_pointer_cast<T>(found->second);
}

inline void refuse_if_lost(const Session& session) {
    if (session.is_lost) decline(XR_ERROR_SESSION_LOST);
}
// The object behind a handle. Refuses handles that are not valid, and declines where the session is lost.
template <typename T>
T& object(typename T::Handle handle) {
    T& found = *shared<T>(handle);
    if constexpr (std::is_same_v<T, Session>) refuse_if_lost(found);
    if constexpr (requires { found.session; }) refuse_if_lost(*found.session);
    return found;
}

inline void forget(uint64_t handle) {
    runtime().objects.erase(handle);
}
template <typename T>
std::vector<std::shared_ptr<T>> all_of() {
    std::vector<std::shared_ptr<T>> list;
    for (const auto& [handle, object] : runtime().objects)
        if (handle >> kKindShift == static_cast<uint8_t>(T::kKind)) list.push_back(std::static_pointer_cast<T>(object));
    return list;
}

// --- Structs ---

std::string name_of(XrStructureType type);
std::string name_of(XrResult result);

template <typename T>
struct StructType;
#define NEUVV_XR_STRUCT_TYPE(structure, structure_type)          \
    template <>                                                  \
    struct StructType<structure> {                               \
        static constexpr XrStructureType kType = structure_type; \
        static constexpr const char* kName = #structure;         \
    };
XR_LIST_STRUCTURE_TYPES_CORE(NEUVV_XR_STRUCT_TYPE)
XR_LIST_STRUCTURE_TYPES_XR_USE_GRAPHICS_API_VULKAN(NEUVV_XR_STRUCT_TYPE)
#undef NEUVV_XR_STRUCT_TYPE

// Checks the type of a struct, and its chain of extension structs.
void check_chain(XrStructureType expected, const char* name, const void* structure);

template <typename T>
const T& checked(const T* structure) {
    require(structure, XR_ERROR_VALIDATION_FAILURE, "null", fmt::format("{} must not be null", StructType<T>::kName));
    check_chain(StructType<T>::kType, StructType<T>::kName, structure);
    return *structure;
}
template <typename T>
T& checked(T* structure) {
    return const_cast<T&>(checked(static_cast<const T*>(structure)));
}
// For parameters that may be null.
template <typename T>
void check_optional(const T* structure) {
    if (structure) checked(structure);
}

// A chained struct by its type, or null; its extension was checked with the chain.
template <typename T>
const T* chained(const void* structure) {
    for (auto next = static_cast<const XrBaseInStructure*>(structure)->next; next; next = next->next)
        if (next->type == StructType<T>::kType) return reinterpret_cast<const T*>(next);
    return nullptr;
}

inline void check_pointer(const void* pointer, const char* name) {
    require(pointer, XR_ERROR_VALIDATION_FAILURE, "null", fmt::format("{} must not be null", name));
}

// --- The two-call idiom ---

// Writes the number of values to `count`. Returns whether the caller wants the values, too.
bool wants_values(uint32_t capacity, uint32_t* count, const void* values, size_t available);

template <typename T, typename Values>
XrResult give_values(uint32_t capacity, uint32_t* count, T* out, const Values& values) {
    if (wants_values(capacity, count, out, values.size())) std::copy(values.begin(), values.end(), out);
    return XR_SUCCESS;
}
XrResult give_text(uint32_t capacity, uint32_t* count, char* out, const std::string& text);
// The same for structs whose type and next the caller has set: `fill(structure, index)` must not change these two.
template <typename T, typename Fill>
XrResult give_structs(uint32_t capacity, uint32_t* count, T* out, size_t available, const Fill& fill) {
    if (!wants_values(capacity, count, out, available)) return XR_SUCCESS;
    for (size_t i = 0; i < available; ++i) fill(checked(&out[i]), i);
    return XR_SUCCESS;
}

// --- Checks that many functions need ---

Instance& instance_of(XrInstance handle);
void check_system(const Instance& instance, XrSystemId system);
void check_view_configuration(XrViewConfigurationType type);
// Those that xrEnumerateViewConfigurations names, the preferred one first; and the number of views of each.
std::vector<XrViewConfigurationType> offered_view_configurations();
uint32_t view_count(XrViewConfigurationType type);
void check_time(XrTime time);
void check_pose(const XrPosef& pose, const char* name);
const std::string& text_of(XrPath path);  // refuses XR_ERROR_PATH_INVALID
XrPath path_of(const std::string& text);  // `text` must be well-formed
// The path must be null or one that the action was created with.
void check_subaction(const Action& action, XrPath path);
inline constexpr XrSystemId kSystem = 0x4e56;

// That of libvulkan, for applications that create their Vulkan objects themselves (XR_KHR_vulkan_enable).
PFN_vkGetInstanceProcAddr vulkan_loader();

// Says in the chained structs which bodies the system tracks.
void fill_body_properties(const XrSystemProperties& properties);

// --- Entry points ---

template <size_t kSize>
struct FixedText {
    char text[kSize] = {};
    // NOLINTNEXTLINE(google-explicit-constructor): literals are to become template arguments
    constexpr FixedText(const char (&from)[kSize]) { std::copy_n(from, kSize, text); }
};

// Reads script and folder from the environment. Where both are the same as before, a new instance continues with the
// script, as it must after a loss; otherwise the script begins anew.
void load_configuration();
// The result that the script demands instead of the call: a forced one, or the loss of the instance.
std::optional<XrResult> scripted_result(const char* function);
void report_own_failure(const std::string& text);

template <auto kFunction, FixedText kName>
struct Entry;
template <typename... Parameters, XrResult (*kFunction)(Parameters...), FixedText kName>
struct Entry<kFunction, kName> {
    static XRAPI_ATTR XrResult XRAPI_CALL call(Parameters... parameters) {
        Call call = {kName.text, std::unique_lock(runtime().mutex)};
        current_call() = &call;
        XrResult result;
        try {
            const auto scripted = scripted_result(kName.text);
            result = scripted ? *scripted : kFunction(parameters...);
        } catch (const Refusal& refusal) {
            result = refusal.result;
        } catch (const std::exception& error) {
            report_own_failure(error.what());
            result = XR_ERROR_RUNTIME_FAILURE;
        }
        current_call() = nullptr;
        return result;
    }
};

struct EntryPoint {
    const char* name;
    const char* extension;  // null for core functions
    const char* other_extension;
    PFN_xrVoidFunction function;
};

// One row of a table of entry points; the cast to the API's own type checks the signature.
// NOLINTBEGIN(bugprone-macro-parentheses): a template argument has none
// clang-format off
#define NEUVV_XR_ENTRY_OF(extension, other, name, function) \
    {#name, extension, other, \
     reinterpret_cast<PFN_xrVoidFunction>(static_cast<PFN_##name>(&Entry<&function, #name>::call))}
// clang-format on
// NOLINTEND(bugprone-macro-parentheses)
#define NEUVV_XR_ENTRY(name, function) NEUVV_XR_ENTRY_OF(nullptr, nullptr, name, function)

// The tables, one per file of functions.
std::vector<EntryPoint> instance_entries();
std::vector<EntryPoint> system_entries();
std::vector<EntryPoint> graphics_entries();
std::vector<EntryPoint> session_entries();
std::vector<EntryPoint> frame_entries();
std::vector<EntryPoint> swapchain_entries();
std::vector<EntryPoint> space_entries();
std::vector<EntryPoint> view_entries();
std::vector<EntryPoint> action_entries();
std::vector<EntryPoint> binding_entries();
std::vector<EntryPoint> input_entries();
std::vector<EntryPoint> hand_entries();
std::vector<EntryPoint> body_entries();
std::vector<EntryPoint> passthrough_entries();
std::vector<EntryPoint> debug_entries();

}  // namespace neuvv::xr_runtime
