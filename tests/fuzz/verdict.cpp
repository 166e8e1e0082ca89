#include "fuzz/verdict.h"

#include <cmath>
#include <exception>

#include "base/error.h"

namespace neuvv::fuzz {

namespace {

constexpr size_t kLongestMessage = 2000;

bool sound(const Camera& camera) {
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (!std::isfinite(camera.world_from_camera[column][row])) return false;
    return camera.fx > 0 && camera.fy > 0 && std::isfinite(camera.fx) && std::isfinite(camera.fy) &&
           std::isfinite(camera.cx) && std::isfinite(camera.cy) && camera.width > 0 && camera.height > 0;
}

}  // namespace

std::string complaint_about(const std::function<Dataset()>& load) {
    try {
        const Dataset dataset = load();
        for (const Camera& camera : dataset.cameras)
            if (!sound(camera)) return "gave a camera that cannot be";
        for (const View& view : dataset.views)
            if (!(view.time >= 0 && view.time <= 1)) return "gave a time outside [0,1]";
        return {};
    } catch (const InputError& error) {
        const std::string text = error.what();
        if (text.find('\n') != std::string::npos) return "an InputError of several lines: " + text;
        if (text.size() > kLongestMessage) return "an InputError too long to read: " + text;
        return {};
    } catch (const std::exception& error) {
        return std::string("threw something else than InputError: ") + error.what();
    } catch (...) {
        return "threw something that is no exception";
    }
}

}  // namespace neuvv::fuzz
