#include "tools/viewer/screenshot.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cstdlib>
#include <memory>

#include "media/image.h"
#include "tools/viewer/context.h"

namespace neuvv::viewer {

namespace {

// A file name from the time, with a number where another screenshot was taken in the same second.
std::filesystem::path free_name(const std::filesystem::path& folder) {
    const std::string time = fmt::format("{:%Y-%m-%d_%H-%M-%S}", fmt::localtime(std::time(nullptr)));
    std::filesystem::path path = folder / fmt::format("neuvv_{}.png", time);
    for (int i = 2; std::filesystem::exists(path); ++i) path = folder / fmt::format("neuvv_{}_{}.png", time, i);
    return path;
}

// May be called from any thread.
void write(Context& context, const std::filesystem::path& folder, const std::shared_ptr<const media::Image>& image) {
    context.jobs.start("Saving a screenshot", [&context, folder, image] {
        std::filesystem::create_directories(folder);
        const std::filesystem::path path = free_name(folder);
        media::write_png(path, *image);
        return [&context, path] { context.editor.notify(fmt::format("saved {}", path.string())); };
    });
}

// Reads the upper left part of an image (RGBA8, layout TRANSFER_SRC); the result is opaque.
media::Image read_back(const gpu::Device& device, const gpu::DeviceImage& image, VkExtent2D size) {
    const gpu::Buffer pixels(device, "screenshot", uint64_t{4} * size.width * size.height, gpu::MemoryKind::kReadback);
    gpu::run_once(device, "screenshot", [&](gpu::Commands& commands) {
        gpu::copy(commands, image, {{0, 0}, size}, pixels);
        gpu::host_barrier(commands);
    });
    media::Image read(size.width, size.height);
    std::copy_n(pixels.as<uint8_t>(), read.rgba.size(), read.rgba.begin());
    for (size_t i = 3; i < read.rgba.size(); i += 4) read.rgba[i] = 255;
    return read;
}

}  // namespace

std::filesystem::path images_folder() {
    if (const char* folder = std::getenv("XDG_PICTURES_DIR"); folder && *folder) return folder;
    std::error_code none;
    if (const char* home = std::getenv("HOME"); home && *home)
        if (const auto images = std::filesystem::path(home) / "Pictures"; std::filesystem::is_directory(images, none))
            return images;
    return std::filesystem::current_path();
}

void Screenshots::take(Context& context, Screen& screen, bool is_sharp) {
    if (!image_ && !window_ && !window_capture_pending_) return;
    if (folder_.empty()) folder_ = images_folder();
    if (window_capture_pending_)
        if (std::optional<media::Image> image = screen.take_capture()) {
            window_capture_pending_ = false;
            write(context, folder_, std::make_shared<const media::Image>(std::move(*image)));
        }
    if (window_ && !window_capture_pending_) {
        window_ = false;
        window_capture_pending_ = true;
        screen.capture_next();
    }
    if (image_ && is_sharp) {
        image_ = false;
        context.render_thread.post([&context, folder = folder_](editor::OnDevice& on_device) {
            // Not an image of the frame: tasks that wait may not keep anything on the device (RenderThread::release).
            const editor::DisplayedImage displayed = context.render_thread.state().displayed;
            if (!displayed.image) return;
            write(context, folder,
                  std::make_shared<const media::Image>(read_back(on_device.device, *displayed.image, displayed.size)));
        });
    }
    context.redraw(1);
}

}  // namespace neuvv::viewer
