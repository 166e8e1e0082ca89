#include "gpu/device.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <mutex>
#include <utility>

#include "base/platform.h"
#include "gpu/buffer_speed.h"
#include "gpu/compute_program.h"
#include "gpu/debug_buffer.h"
#include "gpu/features.h"
#include "gpu/result_name.h"

namespace neuvv::gpu {

VulkanError::VulkanError(VkResult failed, const char* call, const std::string& object)
    : RuntimeFailure(fmt::format("{} failed for \"{}\": {}", call, object, result_name(failed))), result(failed) {}

bool VulkanError::out_of_memory() const {
    return is_out_of_memory(result);
}

void check(VkResult result, const char* call, const std::string& object) {
    if (result != VK_SUCCESS) throw VulkanError(result, call, object);
}

struct Device::Messages {
    std::mutex mutex;
    std::vector<std::string> texts;
};

namespace {

bool instance_has(const std::vector<VkExtensionProperties>& extensions, const char* name) {
    return std::any_of(extensions.begin(), extensions.end(),
                       [&](const auto& e) { return std::strcmp(e.extensionName, name) == 0; });
}

constexpr const char* kNoDriver =
    "this machine has no Vulkan driver: install that of your GPU's maker, or the package mesa-vulkan-drivers, which "
    "has "
    "those of AMD and Intel and one for the CPU alone";

VkInstance make_instance(bool validate, bool* debug_utils, const std::vector<const char*>& wanted = {},
                         const DeviceMaker& maker = {}) {
    check(volkInitialize(), "volkInitialize",
          "Vulkan loader (install libvulkan1 and a driver such as mesa-vulkan-drivers)");
    uint32_t count = 0;
    vkEnumerateInstanceExtensionProperties(nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> available(count);
    vkEnumerateInstanceExtensionProperties(nullptr, &count, available.data());

    std::vector<const char*> extensions = wanted;  // without duplicates: a wanted one may be added below again
    const auto add = [&](const char* name) {
        if (std::none_of(extensions.begin(), extensions.end(), [&](auto* e) { return std::strcmp(e, name) == 0; }))
            extensions.push_back(name);
    };
    for (const char* name : wanted)
        if (!instance_has(available, name))
            throw RuntimeFailure(
                fmt::format("this machine's Vulkan has no {}, which the window or the headset needs", name));
    *debug_utils = instance_has(available, VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    if (*debug_utils) add(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    const bool portability = instance_has(available, VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME);
    if (portability) add(VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME);

    const char* layer = "VK_LAYER_KHRONOS_validation";
    // Core checks come by default; synchronization validation finds missing barriers between passes.
    const VkValidationFeatureEnableEXT enabled[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    const VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT, nullptr, 1, enabled, 0, nullptr};
    const VkApplicationInfo app{
        VK_STRUCTURE_TYPE_APPLICATION_INFO, nullptr, "neuvv", 1, "neuvv", 1, VK_API_VERSION_1_3};
    VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
    info.pNext = validate ? &features : nullptr;
    info.flags = portability ? VkInstanceCreateFlags{VK_INSTANCE_CREATE_ENUMERATE_PORTABILITY_BIT_KHR} : 0;
    info.pApplicationInfo = &app;
    info.enabledLayerCount = validate ? 1 : 0;
    info.ppEnabledLayerNames = &layer;
    info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    VkInstance instance = VK_NULL_HANDLE;
    const VkResult made =
        maker.create_instance ? maker.create_instance(info, &instance) : vkCreateInstance(&info, nullptr, &instance);
    if (made == VK_ERROR_INCOMPATIBLE_DRIVER) throw RuntimeFailure(kNoDriver);
    check(made, "vkCreateInstance",
          validate ? "instance with validation (package vulkan-validationlayers)" : "instance");
    volkLoadInstanceOnly(instance);
    return instance;
}

std::vector<VkPhysicalDevice> physical_devices(VkInstance instance) {
    uint32_t count = 0;
    check(vkEnumeratePhysicalDevices(instance, &count, nullptr), "vkEnumeratePhysicalDevices", "instance");
    std::vector<VkPhysicalDevice> devices(count);
    check(vkEnumeratePhysicalDevices(instance, &count, devices.data()), "vkEnumeratePhysicalDevices", "instance");
    return devices;
}

const char* kind_of(VkPhysicalDeviceType type) {
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
            return "discrete";
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
            return "integrated";
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
            return "virtual";
        case VK_PHYSICAL_DEVICE_TYPE_CPU:
            return "cpu";
        default:
            return "other";
    }
}

DeviceSummary summarise(VkPhysicalDevice physical, uint32_t index) {
    VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &driver, {}};
    vkGetPhysicalDeviceProperties2(physical, &properties);

    DeviceSummary summary;
    summary.index = index;
    summary.name = properties.properties.deviceName;
    summary.kind = kind_of(properties.properties.deviceType);
    summary.driver = fmt::format("{} {}", driver.driverName, driver.driverInfo);
    summary.api_version = properties.properties.apiVersion;
    summary.memory = heap_memory(physical);
    summary.buffers = buffer_limits(properties.properties.limits, has_buffer_addresses(physical));
    summary.transfer_queue = TransferQueue::family_of(physical).has_value();
    find_lacking_features(physical, summary.missing, summary.missing_optional);
    return summary;
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

int rank(const DeviceSummary& summary) {
    constexpr std::array kOrder = {"discrete", "integrated", "virtual", "other", "cpu"};
    return static_cast<int>(std::find(kOrder.begin(), kOrder.end(), summary.kind) - kOrder.begin());
}

std::string joined(const std::vector<std::string>& parts) {
    return fmt::format("{}", fmt::join(parts, ", "));
}

// The index of the device that `choice` names, or of the best usable one where it is empty.
size_t pick(const std::vector<DeviceSummary>& devices, const std::string& choice) {
    size_t best = devices.size();
    if (!choice.empty()) {
        const bool number = std::all_of(choice.begin(), choice.end(), [](unsigned char c) { return std::isdigit(c); });
        for (size_t i = 0; i < devices.size() && best == devices.size(); ++i)
            if (number ? std::to_string(i) == choice : lower(devices[i].name).find(lower(choice)) != std::string::npos)
                best = i;
        if (best == devices.size())
            throw InputError("device", choice, "no Vulkan device has this index or name", Remedy::kChooseDevice);
    } else {
        for (size_t i = 0; i < devices.size(); ++i)
            if (devices[i].missing.empty() && (best == devices.size() || rank(devices[i]) < rank(devices[best])))
                best = i;
    }
    if (best == devices.size()) throw RuntimeFailure("no usable Vulkan device", Remedy::kInstallDevice);
    if (!devices[best].missing.empty())
        throw RuntimeFailure(fmt::format("device \"{}\" lacks: {}", devices[best].name, joined(devices[best].missing)));
    return best;
}

}  // namespace

std::vector<DeviceSummary> list_devices() {
    bool debug_utils = false;
    VkInstance instance = make_instance(false, &debug_utils);
    std::vector<DeviceSummary> summaries;
    for (VkPhysicalDevice physical : physical_devices(instance))
        summaries.push_back(summarise(physical, static_cast<uint32_t>(summaries.size())));
    vkDestroyInstance(instance, nullptr);
    for (DeviceSummary& summary : summaries) choose_by_kept_times(summary);
    return summaries;
}

std::vector<uint32_t> best_devices() {
    std::vector<DeviceSummary> usable = list_devices();
    std::erase_if(usable, [](const DeviceSummary& one) { return !one.missing.empty(); });
    std::vector<uint32_t> best;
    const auto by_rank = [](const DeviceSummary& a, const DeviceSummary& b) { return rank(a) < rank(b); };
    const auto first = std::min_element(usable.begin(), usable.end(), by_rank);
    for (const DeviceSummary& one : usable)
        if (one.kind == first->kind) best.push_back(one.index);
    return best;
}

Device::Device(std::unique_ptr<Messages> messages)
    : programs_(std::make_unique<ComputePrograms>()), messages_(std::move(messages)) {}

// Of a device whose memory is the system's, a control group may allow a part: beyond it, the process would be killed
// without a word. A share is left to what is no buffer.
static std::optional<uint64_t> memory_limit(const DeviceSummary& summary) {
    constexpr uint64_t kShare = 5;
    std::optional<uint64_t> limit = memory_limit_of_environment();
    if (limit || summary.kind != "cpu") return limit;
    if (const auto left = memory_left_by_groups()) limit = *left - *left / kShare;
    return limit;
}

// Delegates, so that the destructor frees the instance when no device fits.
Device::Device(const std::string& choice, Validation validation, const DeviceExtensions& extensions,
               const DeviceMaker& maker)
    : Device(std::make_unique<Messages>()) {
    create_instance(validation, extensions, maker);
    choose_physical(choice, maker);
    create_device(extensions, maker);
    limit_memory(memory_limit(summary_));
    open_pipeline_cache();
    choose_by_speed(*this, summary_);
}

Device::~Device() {
    if (device_) {
        vkDeviceWaitIdle(device_);
        debug_buffer_.reset();
        programs_.reset();
        transfer_queue_.reset();
        if (pipeline_cache_) save_pipeline_cache();
        vkDestroyPipelineCache(device_, pipeline_cache_, nullptr);
        memory_pool_.clear(device_);
        vkDestroyDevice(device_, nullptr);
    }
    if (messenger_) vkDestroyDebugUtilsMessengerEXT(instance_, messenger_, nullptr);
    if (instance_) vkDestroyInstance(instance_, nullptr);
}

void Device::create_instance(Validation validation, const DeviceExtensions& extensions, const DeviceMaker& maker) {
    const bool validate = validation == Validation::kOn;
    instance_ = make_instance(validate, &debug_utils_, extensions.instance, maker);
    if (!validate || !debug_utils_) return;
    VkDebugUtilsMessengerCreateInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
    info.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
    info.pfnUserCallback = [](auto, auto, const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) -> VkBool32 {
        auto* messages = static_cast<Messages*>(user);
        const std::lock_guard lock(messages->mutex);
        messages->texts.emplace_back(data->pMessage ? data->pMessage : "");
        return VK_FALSE;
    };
    info.pUserData = messages_.get();
    check(vkCreateDebugUtilsMessengerEXT(instance_, &info, nullptr, &messenger_), "vkCreateDebugUtilsMessengerEXT",
          "validation");
}

void Device::choose_physical(const std::string& choice, const DeviceMaker& maker) {
    const char* environment = std::getenv("NEUVV_DEVICE");
    const std::vector<VkPhysicalDevice> all = physical_devices(instance_);
    std::vector<DeviceSummary> summaries;
    for (VkPhysicalDevice physical : all)
        summaries.push_back(summarise(physical, static_cast<uint32_t>(summaries.size())));
    const std::string wanted = choice.empty() && environment ? environment : choice;
    size_t index = 0;
    if (maker.choose_physical) {
        const auto its = std::find(all.begin(), all.end(), maker.choose_physical(instance_));
        if (its == all.end()) throw RuntimeFailure("the headset is driven by a device that Vulkan does not list");
        index = static_cast<size_t>(its - all.begin());
        if (!wanted.empty() && pick(summaries, wanted) != index)
            throw InputError("device", wanted, fmt::format("the headset is driven by \"{}\"", summaries[index].name),
                             Remedy::kLeaveDeviceOut);
        pick({summaries[index]}, "0");  // throws where it is not usable
    } else {
        index = pick(summaries, wanted);
    }
    physical_ = all[index];
    summary_ = summaries[index];

    VkPhysicalDeviceVulkan13Properties properties13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES};
    VkPhysicalDeviceVulkan11Properties properties11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES,
                                                    &properties13};
    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &properties11, {}};
    vkGetPhysicalDeviceProperties2(physical_, &properties);
    limits_ = properties.properties.limits;
    max_allocation_bytes_ = std::min(properties11.maxMemoryAllocationSize, properties13.maxBufferSize);
}

void Device::create_device(const DeviceExtensions& extensions, const DeviceMaker& maker) {
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical_, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physical_, &count, families.data());
    constexpr VkQueueFlags kNeeded = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    for (queue_family_ = 0; queue_family_ < count; ++queue_family_)
        if ((families[queue_family_].queueFlags & kNeeded) == kNeeded) break;
    if (queue_family_ == count)
        throw RuntimeFailure(fmt::format("device \"{}\" has no queue for graphics and compute", summary_.name));

    const float priority = 1.0f;
    const auto queue_of = [&](uint32_t family) {
        return VkDeviceQueueCreateInfo{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, nullptr, 0, family, 1, &priority};
    };
    const std::optional<uint32_t> transfers = TransferQueue::family_of(physical_);
    std::vector<VkDeviceQueueCreateInfo> queues = {queue_of(queue_family_)};
    if (transfers) queues.push_back(queue_of(*transfers));

    FeatureChain features = features_to_enable(physical_);
    float_atomics_ = features.float_atomics;
    output_layer_ = features.v12.shaderOutputLayer;
    memory_pool_.set_addresses(buffer_addresses());
    for (const char* name : extensions.device) {
        if (!has_extension(physical_, name))
            throw RuntimeFailure(fmt::format("device \"{}\" lacks {}", summary_.name, name));
        const auto same = [&](const char* known) { return std::strcmp(known, name) == 0; };
        if (std::none_of(features.extensions.begin(), features.extensions.end(), same))
            features.extensions.push_back(name);
    }
    VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
    info.pNext = &features.core;
    info.queueCreateInfoCount = static_cast<uint32_t>(queues.size());
    info.pQueueCreateInfos = queues.data();
    info.enabledExtensionCount = static_cast<uint32_t>(features.extensions.size());
    info.ppEnabledExtensionNames = features.extensions.data();
    features.link();
    check(maker.create_device ? maker.create_device(physical_, info, &device_)
                              : vkCreateDevice(physical_, &info, nullptr, &device_),
          "vkCreateDevice", summary_.name);
    volkLoadDevice(device_);
    vkGetDeviceQueue(device_, queue_family_, 0, &queue_);
    name_object(VK_OBJECT_TYPE_QUEUE, reinterpret_cast<uint64_t>(queue_), "queue");
    if (!transfers) return;
    transfer_queue_ = std::make_unique<TransferQueue>(device_, *transfers);
    name_object(VK_OBJECT_TYPE_QUEUE, reinterpret_cast<uint64_t>(transfer_queue_->handle()), "transfer queue");
    name_object(VK_OBJECT_TYPE_SEMAPHORE, reinterpret_cast<uint64_t>(transfer_queue_->semaphore()), "finished uploads");
}

namespace {
std::filesystem::path pipeline_cache_file(VkPhysicalDevice physical) {
    const std::filesystem::path folder = cache_folder();
    if (folder.empty()) return {};
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(physical, &properties);
    std::string uuid;
    for (uint8_t byte : properties.pipelineCacheUUID) uuid += fmt::format("{:02x}", byte);
    return folder / fmt::format("pipelines-{}.bin", uuid);  // the UUID names device and driver version
}
}  // namespace

void Device::open_pipeline_cache() {
    std::vector<char> bytes;
    if (const auto file = pipeline_cache_file(physical_); !file.empty()) {
        std::ifstream stream(file, std::ios::binary);
        bytes.assign(std::istreambuf_iterator<char>(stream), {});
    }
    VkPipelineCacheCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
    info.initialDataSize = bytes.size();
    info.pInitialData = bytes.data();
    check(vkCreatePipelineCache(device_, &info, nullptr, &pipeline_cache_), "vkCreatePipelineCache", "pipeline cache");
}

void Device::save_pipeline_cache() const {
    const auto file = pipeline_cache_file(physical_);
    size_t size = 0;
    if (file.empty() || vkGetPipelineCacheData(device_, pipeline_cache_, &size, nullptr) != VK_SUCCESS) return;
    std::vector<char> bytes(size);
    if (vkGetPipelineCacheData(device_, pipeline_cache_, &size, bytes.data()) != VK_SUCCESS) return;
    try {
        write_file_atomically(file, [&](const ByteSink& sink) { sink(bytes.data(), size); });
    } catch (const RuntimeFailure&) {
        // Without the file the next start compiles the pipelines again; nothing else is lost.
    }
}

uint32_t Device::memory_type(uint32_t type_bits, VkMemoryPropertyFlags preferred,
                             VkMemoryPropertyFlags required) const {
    VkPhysicalDeviceMemoryProperties memory{};
    vkGetPhysicalDeviceMemoryProperties(physical_, &memory);
    for (const VkMemoryPropertyFlags flags : {preferred, required})
        for (uint32_t i = 0; i < memory.memoryTypeCount; ++i)
            if ((type_bits >> i & 1) && (memory.memoryTypes[i].propertyFlags & flags) == flags) return i;
    throw RuntimeFailure(fmt::format("device \"{}\" has no memory type with flags {:#x}", summary_.name, required));
}

VkMemoryPropertyFlags Device::memory_flags(uint32_t type) const {
    VkPhysicalDeviceMemoryProperties memory{};
    vkGetPhysicalDeviceMemoryProperties(physical_, &memory);
    return memory.memoryTypes[type].propertyFlags;
}

void Device::limit_memory(std::optional<uint64_t> bytes) const {
    memory_pool_.set_limit(summary_.memory.types, bytes);
}

HeapMemory Device::memory() const {
    HeapMemory now = heap_memory(physical_);
    const std::optional<uint64_t> limit = memory_pool_.limit();
    if (limit || !now.budget) now.used = memory_pool_.allocated();
    if (!limit) return now;
    now.size = std::min(now.size, *limit);
    now.budget = std::min(now.budget.value_or(*limit), *limit);
    return now;
}

void Device::check_memory(VkResult result, const std::string& object, uint64_t bytes) const {
    if (!is_out_of_memory(result)) return check(result, "vkAllocateMemory", object);
    const HeapMemory now = memory();
    throw VulkanError(
        result,
        fmt::format("device \"{}\" has no memory left for \"{}\", which needs {:.1f} MiB: of {} MiB, this program "
                    "takes {} ({})",
                    summary_.name, object, static_cast<double>(bytes) / 1048576, now.budget.value_or(now.size) >> 20,
                    now.used >> 20, result_name(result)),
        Remedy::kLessDeviceMemory);
}

void Device::name_object(VkObjectType type, uint64_t object, const std::string& name) const {
    if (!debug_utils_ || !vkSetDebugUtilsObjectNameEXT) return;
    const VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT, nullptr, type, object,
                                             name.c_str()};
    vkSetDebugUtilsObjectNameEXT(device_, &info);
}

std::vector<std::string> Device::drain_validation_messages() const {
    const std::lock_guard lock(messages_->mutex);
    return std::exchange(messages_->texts, {});
}

DebugBuffer& Device::debug_buffer() const {
    std::call_once(debug_buffer_made_, [this] { debug_buffer_ = std::make_unique<DebugBuffer>(*this); });
    return *debug_buffer_;
}

VkResult Device::wait_for_all_queues() const {
    const std::lock_guard lock(queue_mutex_);
    std::unique_lock<std::mutex> lock_of_transfers;
    if (transfer_queue_) lock_of_transfers = std::unique_lock(transfer_queue_->mutex());
    return vkDeviceWaitIdle(device_);
}

void Device::wait_idle_or_lost() const {
    wait_for_all_queues();
}

void Device::wait_idle() const {
    check(wait_for_all_queues(), "vkDeviceWaitIdle", summary_.name);
}

}  // namespace neuvv::gpu
