#include <fmt/format.h>
#include <spirv_cross_c.h>

#include <algorithm>
#include <array>

#include "base/error.h"
#include "gpu/pass_layout.h"

namespace neuvv::gpu {

namespace {

void expect(spvc_result result, const std::string& shader) {
    if (result != SPVC_SUCCESS) throw RuntimeFailure(fmt::format("shader \"{}\": SPIR-V cannot be reflected", shader));
}

struct Context {
    spvc_context handle = nullptr;
    Context() { spvc_context_create(&handle); }
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    ~Context() { spvc_context_destroy(handle); }
};

// Texel buffers are images of dimension Buffer: sampled ones are read by texelFetch, storage ones by imageLoad/Store.
constexpr std::array<std::pair<spvc_resource_type, VkDescriptorType>, 5> kResources = {{
    {SPVC_RESOURCE_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER},
    {SPVC_RESOURCE_TYPE_STORAGE_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER},
    {SPVC_RESOURCE_TYPE_STORAGE_IMAGE, VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER},
    {SPVC_RESOURCE_TYPE_SEPARATE_IMAGE, VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER},
    {SPVC_RESOURCE_TYPE_SAMPLED_IMAGE, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER},  // images: sampler2D
}};

}  // namespace

ShaderInterface reflect(std::span<const uint32_t> spirv, const std::string& name) {
    const Context context;
    spvc_parsed_ir ir = nullptr;
    spvc_compiler compiler = nullptr;
    spvc_resources resources = nullptr;
    expect(spvc_context_parse_spirv(context.handle, spirv.data(), spirv.size(), &ir), name);
    expect(spvc_context_create_compiler(context.handle, SPVC_BACKEND_NONE, ir, SPVC_CAPTURE_MODE_TAKE_OWNERSHIP,
                                        &compiler),
           name);
    expect(spvc_compiler_create_shader_resources(compiler, &resources), name);

    ShaderInterface interface;
    for (const auto& [resource, descriptor] : kResources) {
        const spvc_reflected_resource* list = nullptr;
        size_t count = 0;
        expect(spvc_resources_get_resource_list_for_type(resources, resource, &list, &count), name);
        for (size_t i = 0; i < count; ++i)
            interface.bindings.push_back(
                {spvc_compiler_get_decoration(compiler, list[i].id, SpvDecorationBinding), descriptor});
    }
    std::sort(interface.bindings.begin(), interface.bindings.end(),
              [](const BindingSlot& a, const BindingSlot& b) { return a.binding < b.binding; });
    // Two blocks of one binding are two views of one buffer.
    const auto end = std::unique(interface.bindings.begin(), interface.bindings.end(),
                                 [](const BindingSlot& a, const BindingSlot& b) { return a.binding == b.binding; });
    interface.bindings.erase(end, interface.bindings.end());

    const auto group_size = [&](unsigned axis) {
        return spvc_compiler_get_execution_mode_argument_by_index(compiler, SpvExecutionModeLocalSize, axis);
    };
    interface.group_threads = group_size(0);
    if (group_size(1) > 1 || group_size(2) > 1)
        throw RuntimeFailure(fmt::format("shader \"{}\": its workgroups are not of one dimension", name));

    const spvc_reflected_resource* push = nullptr;
    size_t count = 0;
    expect(spvc_resources_get_resource_list_for_type(resources, SPVC_RESOURCE_TYPE_PUSH_CONSTANT, &push, &count), name);
    if (count > 0) {
        size_t bytes = 0;
        expect(spvc_compiler_get_declared_struct_size(
                   compiler, spvc_compiler_get_type_handle(compiler, push[0].base_type_id), &bytes),
               name);
        interface.push_bytes = static_cast<uint32_t>(bytes);
    }
    return interface;
}

}  // namespace neuvv::gpu
