#include "gpu/graphics_pass.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/error.h"

namespace neuvv::gpu {

namespace {

// The union of what the two shader stages declare.
ShaderInterface merge(ShaderInterface a, const ShaderInterface& b) {
    for (const BindingSlot& slot : b.bindings)
        if (std::none_of(a.bindings.begin(), a.bindings.end(), [&](auto& s) { return s.binding == slot.binding; }))
            a.bindings.push_back(slot);
    std::sort(a.bindings.begin(), a.bindings.end(), [](auto& l, auto& r) { return l.binding < r.binding; });
    a.push_bytes = std::max(a.push_bytes, b.push_bytes);
    return a;
}

// The states of a pipeline that do not depend on its shaders.
struct FixedState {
    VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
    VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
    VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
    VkPipelineMultisampleStateCreateInfo multisample{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
    VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
    std::vector<VkPipelineColorBlendAttachmentState> attachments;
    VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
    VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};

    explicit FixedState(const GraphicsShape& shape) {
        assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
        viewport.viewportCount = viewport.scissorCount = 1;
        raster.polygonMode = VK_POLYGON_MODE_FILL;
        raster.lineWidth = 1;
        multisample.rasterizationSamples = shape.samples;
        depth.depthTestEnable = VK_TRUE;
        depth.depthCompareOp = shape.depth_compare;
        VkPipelineColorBlendAttachmentState attachment{};
        attachment.blendEnable = shape.blend;
        attachment.srcColorBlendFactor = attachment.srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
        attachment.dstColorBlendFactor = attachment.dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
        attachment.colorWriteMask = 0xf;
        attachments.assign(shape.colours.size(), attachment);
        blend.attachmentCount = static_cast<uint32_t>(attachments.size());
        blend.pAttachments = attachments.data();
        static constexpr VkDynamicState kDynamic[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR,
                                                      VK_DYNAMIC_STATE_CULL_MODE, VK_DYNAMIC_STATE_FRONT_FACE,
                                                      VK_DYNAMIC_STATE_DEPTH_WRITE_ENABLE};
        dynamic.dynamicStateCount = static_cast<uint32_t>(std::size(kDynamic));
        dynamic.pDynamicStates = kDynamic;
    }
    FixedState(const FixedState&) = delete;
    FixedState& operator=(const FixedState&) = delete;
};

VkPipeline make_pipeline(const Device& device, VkPipelineLayout layout, const GraphicsShape& shape,
                         const std::string& name) {
    const ShaderModule vertex(device, shape.vertex_spirv, name), fragment(device, shape.fragment_spirv, name);
    VkPipelineShaderStageCreateInfo stages[2]{};
    for (auto& stage : stages) stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    stages[0].stage = VK_SHADER_STAGE_VERTEX_BIT;
    stages[0].module = vertex.handle();
    stages[1].stage = VK_SHADER_STAGE_FRAGMENT_BIT;
    stages[1].module = fragment.handle();
    stages[0].pName = stages[1].pName = "main";
    VkPipelineVertexInputStateCreateInfo input{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    input.vertexBindingDescriptionCount = static_cast<uint32_t>(shape.streams.size());
    input.pVertexBindingDescriptions = shape.streams.data();
    input.vertexAttributeDescriptionCount = static_cast<uint32_t>(shape.attributes.size());
    input.pVertexAttributeDescriptions = shape.attributes.data();
    const FixedState fixed(shape);
    VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
    rendering.colorAttachmentCount = static_cast<uint32_t>(shape.colours.size());
    rendering.pColorAttachmentFormats = shape.colours.data();
    rendering.depthAttachmentFormat = shape.depth;
    VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
    info.pNext = &rendering;
    info.stageCount = 2;
    info.pStages = stages;
    info.pVertexInputState = &input;
    info.pInputAssemblyState = &fixed.assembly;
    info.pViewportState = &fixed.viewport;
    info.pRasterizationState = &fixed.raster;
    info.pMultisampleState = &fixed.multisample;
    info.pDepthStencilState = &fixed.depth;
    info.pColorBlendState = &fixed.blend;
    info.pDynamicState = &fixed.dynamic;
    info.layout = layout;
    VkPipeline pipeline = VK_NULL_HANDLE;
    check(vkCreateGraphicsPipelines(device.handle(), device.pipeline_cache(), 1, &info, nullptr, &pipeline),
          "vkCreateGraphicsPipelines", name);
    device.name_object(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<uint64_t>(pipeline), name);
    return pipeline;
}

}  // namespace

// Delegates, so that the destructor frees what was created when a later step throws.
GraphicsPass::GraphicsPass(const Device& device, std::string name, const GraphicsShape& shape)
    : GraphicsPass(device, std::move(name)) {
    const std::vector<uint32_t> vertex = device.shaders().newest(shape.vertex_spirv),
                                fragment = device.shaders().newest(shape.fragment_spirv);
    interface_ = merge(reflect(vertex, name_), reflect(fragment, name_));
    layout_ = PassLayout(device, interface_, kDrawStages, name_);
    GraphicsShape newest = shape;
    newest.vertex_spirv = vertex;
    newest.fragment_spirv = fragment;
    pipeline_ = make_pipeline(device, layout_.pipeline(), newest, name_);
}

GraphicsPass::~GraphicsPass() {
    vkDestroyPipeline(device_.handle(), pipeline_, nullptr);
}

TextureSet::TextureSet(const GraphicsPass& pass,
                       std::span<const std::pair<const DeviceImage*, const Sampler*>> textures,
                       std::initializer_list<std::pair<uint32_t, const Buffer*>> buffers)
    : set_(pass.device(), pass.interface(), pass.set_layout(), pass.name()) {
    const std::vector<BindingSlot>& slots = pass.interface().bindings;
    size_t used = 0;
    for (const BindingSlot& slot : slots) {
        VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
        write.dstSet = set_.handle();
        write.dstBinding = slot.binding;
        write.descriptorCount = 1;
        write.descriptorType = slot.type;
        VkDescriptorImageInfo image{VK_NULL_HANDLE, VK_NULL_HANDLE, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
        VkDescriptorBufferInfo range{VK_NULL_HANDLE, 0, VK_WHOLE_SIZE};
        if (slot.type == VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER && used < textures.size()) {
            image.sampler = textures[used].second->sampler;
            image.imageView = textures[used++].first->view;
            write.pImageInfo = &image;
        } else {
            const auto found =
                std::find_if(buffers.begin(), buffers.end(), [&](auto& b) { return b.first == slot.binding; });
            if (found == buffers.end())
                throw RuntimeFailure(fmt::format("pass \"{}\": nothing for binding {}", pass.name(), slot.binding));
            require_fits(pass.name(), slot, *found->second);
            range.buffer = found->second->buffer;
            write.pBufferInfo = &range;
            write.pTexelBufferView = &found->second->view;
        }
        vkUpdateDescriptorSets(pass.device().handle(), 1, &write, 0, nullptr);
    }
    if (used != textures.size())
        throw RuntimeFailure(fmt::format("pass \"{}\" has {} textures, not {}", pass.name(), used, textures.size()));
}

}  // namespace neuvv::gpu
