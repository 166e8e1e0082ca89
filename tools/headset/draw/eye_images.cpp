#include "tools/headset/draw/eye_images.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace neuvv::headset {

namespace {

constexpr double kBeside = 0.5;  // rays per pixel along each side outside the inset

xr::SwapchainShape colour_shape(const xr::Runtime& runtime, bool keep) {
    xr::SwapchainShape shape{runtime.image_size(), runtime.view_count()};
    shape.formats = xr::eye_colour_formats();
    if (keep) shape.usage |= XR_SWAPCHAIN_USAGE_TRANSFER_SRC_BIT;
    return shape;
}

xr::SwapchainShape depth_shape(const xr::Runtime& runtime) {
    xr::SwapchainShape shape{runtime.image_size(), runtime.view_count(),
                             XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_IMAGE_ASPECT_DEPTH_BIT};
    shape.formats = xr::eye_depth_formats();
    return shape;
}

// The swapchain of depth; null where the runtime does not take depth, or has none of the formats that EyePass draws.
std::unique_ptr<xr::SwapchainImages> depth_images(const gpu::Device& device, const xr::Session& session) {
    if (!session.runtime().has(XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME)) return nullptr;
    try {
        return std::make_unique<xr::SwapchainImages>(session, device, "depth of eyes", depth_shape(session.runtime()));
    } catch (const xr::XrFailure&) {
        throw;
    } catch (const RuntimeFailure&) {
        return nullptr;
    }
}

bool same_fov(const XrFovf& a, const XrFovf& b) {
    return a.angleLeft == b.angleLeft && a.angleRight == b.angleRight && a.angleUp == b.angleUp &&
           a.angleDown == b.angleDown;
}

// A ray grid of one density in all of an image but its first pixel, which is the inset.
render::Fovea even_rays(double share) {
    return {glm::dvec2(0), glm::dvec2(0), share};
}

}  // namespace

bool images_overlap(const gpu::Device& device) {
    return device.summary().kind != "cpu";
}

EyeImages::EyeImages(const gpu::Device& device, const xr::Session& session, const EyeQuality& quality)
    : device_(device),
      session_(session),
      quality_(quality),
      colour_(std::make_unique<xr::SwapchainImages>(session, device, "eyes",
                                                    colour_shape(session.runtime(), quality.keep_images))),
      depth_(quality.depth ? depth_images(device, session) : nullptr),
      pass_(device, colour_->format(), depth_ ? depth_->format() : VK_FORMAT_D32_SFLOAT),
      cameras_(session.runtime().view_count(), stage::Camera{.fx = 1000}),
      mask_outdated_(cameras_.size(), true),
      mask_fov_(cameras_.size()),
      hidden_(cameras_.size()),
      dynamic_scale_(8),
      overlaps_(images_overlap(device)),
      views_(cameras_.size()),
      depths_(cameras_.size()) {
    if (session.runtime().has_narrow_views()) quality_.inset.reset();
    const VkExtent2D size = colour_->size();
    if (!depth_)
        fallback_depth_ = gpu::DeviceImage(
            device, "depth of eyes",
            {size.width, size.height, VK_FORMAT_D32_SFLOAT, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
             VK_SAMPLE_COUNT_1_BIT, 1, session.runtime().view_count()});
    if (!quality.keep_images) return;
    left_.emplace(device, "left eye",
                  gpu::ImageShape{
                      size.width, size.height, VK_FORMAT_R8G8B8A8_SRGB,
                      VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_SAMPLED_BIT});
}

EyeImages::~EyeImages() {
    device_.wait_idle_or_lost();
}

render::FrameCapacity EyeImages::capacity() const {
    render::FrameCapacity capacity{size().width, size().height};
    capacity.views = session_.runtime().view_count();
    return capacity;
}

const char* EyeImages::format_name() const {
    return colour_->format() == VK_FORMAT_R8G8B8A8_SRGB ? "R8G8B8A8 sRGB" : "B8G8R8A8 sRGB";
}

// Chooses the part of the image that is drawn, and its rays. `last_ms` is the time of the last image; 0: there is none.
void EyeImages::choose_size(double budget_ms, double last_ms) {
    constexpr double kNearlyWhole = 0.97;
    dynamic_scale_.set_target(budget_ms);
    // The time may be that of any of the last images, so it counts once all of them had the same scale.
    if (same_scale_ > render::kImagesUnderWay || device_.summary().kind == "cpu")
        dynamic_scale_.drawn(drawn_scale_, last_ms);
    const double scale = quality_.scale > 0 ? quality_.scale : dynamic_scale_.scale();
    const double share = quality_.scale > 0 ? 1 : share_.update(scale > kNearlyWhole ? 1 : scale);
    const auto part = [&](uint32_t side) {  // whole tiles of rays
        const double tiles = std::ceil(share * side / kTile);
        return std::min(side, static_cast<uint32_t>(tiles) * kTile);
    };
    drawn_size_ = {part(size().width), part(size().height)};
    ray_scale_ = std::min(scale / share, 1.0);
    if (ray_scale_ > kNearlyWhole) ray_scale_ = 1;
    const double before = std::exchange(drawn_scale_, share * ray_scale_);
    same_scale_ = drawn_scale_ == before ? same_scale_ + 1 : 1;
}

double EyeImages::ray_share(uint32_t view, bool follows_gaze) const {
    const VkExtent2D wanted = session_.runtime().recommended_size(view, follows_gaze);
    return std::max(static_cast<double>(wanted.width) / size().width,
                    static_cast<double>(wanted.height) / size().height);
}

// The mesh is given on a plane before the eye, so its position in the image changes with the field of view, too. Narrow
// views that follow the gaze have none: it would be another one in each frame, and lenses hide little there.
void EyeImages::update_hidden_triangles(render::StageRenderer& renderer, const xr::EyeViews& eyes) {
    if (!quality_.mask) return;
    for (uint32_t view = 0; view < hidden_.size(); ++view) {
        const XrFovf& fov = eyes.views[view].fov;
        const bool moves = eyes.follows_gaze && view >= xr::kEyes;
        if (!moves && !mask_outdated_[view] && same_fov(mask_fov_[view], fov)) continue;
        auto hidden = moves ? std::vector<glm::vec2>() : xr::hidden_triangles(session_, view, fov);
        hides_ &= hidden == hidden_[view];
        hidden_[view] = std::move(hidden);
        mask_fov_[view] = fov;
        mask_outdated_[view] = moves;
    }
    if (!std::exchange(hides_, true)) renderer.hide(hidden_);
}

render::FrameSettings EyeImages::settings_of(const render::StageRenderer& renderer,
                                             const stage::EvaluatedStage& evaluated,
                                             const render::PerformerHighlight& highlight,
                                             std::span<const render::Instance> next, bool follows_gaze) const {
    render::FrameSettings settings = renderer.settings_at(evaluated, highlight);
    settings.width = drawn_size_.width;
    settings.height = drawn_size_.height;
    settings.mode = render::TraceMode::kPlay;
    settings.scale = ray_scale_;
    settings.far_levels = quality_.far_levels;
    settings.next_instances.assign(next.begin(), next.end());
    if (quality_.inset)
        for (const stage::Camera& camera : cameras_)
            settings.foveae.push_back(xr::fovea_of(camera, *quality_.inset, kBeside, looks_at_));
    std::vector<render::Fovea> shares;
    bool fewer = false;
    for (uint32_t view = 0; view < cameras_.size(); ++view) {
        shares.push_back(even_rays(ray_share(view, follows_gaze)));
        fewer |= shares.back().beside < 1;
    }
    if (fewer && !quality_.inset) settings.foveae = std::move(shares);
    if (shows_room_) settings.resolve.background = glm::vec4(0);
    return settings;
}

void EyeImages::draw(render::StageRenderer& renderer, const stage::EvaluatedStage& evaluated,
                     const render::PerformerHighlight& highlight, const xr::EyeViews& eyes,
                     const xr::Pose& world_from_tracking, std::span<const render::Instance> next,
                     const xr::EyeShapes& shapes, const xr::EyeShade& shade, double budget_ms) {
    update_hidden_triangles(renderer, eyes);
    choose_size(budget_ms, has_drawn_ ? renderer.frames().device_milliseconds() : 0);
    for (uint32_t view = 0; view < cameras_.size(); ++view)
        cameras_[view] = xr::eye_camera(eyes.views[view], world_from_tracking, drawn_size_);
    const render::FrameSettings settings = settings_of(renderer, evaluated, highlight, next, eyes.follows_gaze);

    const uint32_t index = colour_->acquire(), depth = depth_ ? depth_->acquire() : 0;
    const xr::EyeTarget target{colour_->image(index), depth_ ? depth_->image(depth) : fallback_depth_.image,
                               colour_->view(index), depth_ ? depth_->view(depth) : fallback_depth_.view, drawn_size_};
    const auto record = [&](gpu::Commands& commands, const gpu::Buffer& images) {
        pass_.record(commands, renderer, images, cameras_, shapes, shade, target);
        if (left_) record_left(commands, target.colour);
    };
    if (overlaps_)
        renderer.frames().submit(cameras_, settings, record);
    else
        renderer.frames().draw(cameras_, settings, record);
    colour_->release();
    if (depth_) depth_->release();
    drawn_eyes_ = eyes;
    has_drawn_ = true;
}

void EyeImages::record_left(gpu::Commands& commands, VkImage image) {
    has_left_ = true;
    const VkImageSubresourceRange layers{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, session_.runtime().view_count()};
    gpu::move_layout(commands, image, layers, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                     VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    gpu::move_layout(commands, *left_, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    VkImageBlit part{};  // a blit converts between formats and sizes, a copy does not
    part.srcSubresource = part.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    part.srcOffsets[1] = {static_cast<int32_t>(drawn_size_.width), static_cast<int32_t>(drawn_size_.height), 1};
    part.dstOffsets[1] = {static_cast<int32_t>(size().width), static_cast<int32_t>(size().height), 1};
    vkCmdBlitImage(commands.handle(), image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, left_->image,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &part, VK_FILTER_LINEAR);
    gpu::move_layout(commands, *left_, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    gpu::move_layout(commands, image, layers, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                     VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
}

const XrCompositionLayerBaseHeader* EyeImages::layer(const xr::Session& session, bool over_layers) {
    for (uint32_t view = 0; view < views_.size(); ++view) {
        views_[view] = {XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW};
        views_[view].pose = xr::xr_pose(drawn_eyes_.views[view].pose);
        views_[view].fov = drawn_eyes_.views[view].fov;
        views_[view].subImage = colour_->sub_image(view, drawn_size_);
        if (!depth_) continue;
        depths_[view] = {XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR};
        depths_[view].subImage = depth_->sub_image(view, drawn_size_);
        depths_[view].minDepth = 0;
        depths_[view].maxDepth = 1;
        depths_[view].nearZ = INFINITY;  // reversed: depth 0 is infinitely far
        depths_[view].farZ = static_cast<float>(render::kSetNear_m);
        views_[view].next = &depths_[view];
    }
    projection_.layerFlags = over_layers ? XR_COMPOSITION_LAYER_BLEND_TEXTURE_SOURCE_ALPHA_BIT : 0;
    projection_.space = session.tracking_space();
    projection_.viewCount = static_cast<uint32_t>(views_.size());
    projection_.views = views_.data();
    return reinterpret_cast<const XrCompositionLayerBaseHeader*>(&projection_);
}

}  // namespace neuvv::headset
