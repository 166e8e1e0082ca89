// Programs that a test starts while the object exists run with the layer of lose_device.cpp, NEUVV_LOSE_DEVICE_LAYER,
// and lose their Vulkan device when they are told to.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace neuvv::test {

class LosableDevice {
  public:
    explicit LosableDevice(const std::filesystem::path& folder) : file_(folder / "lose_device") {
        setenv("VK_INSTANCE_LAYERS", "VK_LAYER_NEUVV_lose_device", 1);
        setenv("VK_LAYER_PATH", NEUVV_LOSE_DEVICE_LAYER ":/usr/share/vulkan/explicit_layer.d", 1);
        setenv("NEUVV_LOSE_DEVICE", file_.c_str(), 1);
    }
    ~LosableDevice() {
        for (const char* name : {"VK_INSTANCE_LAYERS", "VK_LAYER_PATH", "NEUVV_LOSE_DEVICE"}) unsetenv(name);
    }
    LosableDevice(const LosableDevice&) = delete;
    LosableDevice& operator=(const LosableDevice&) = delete;

    // The next submissions lose the device, one each.
    void lose(int times = 1) const {
        const std::filesystem::path next = file_.string() + ".next";
        std::ofstream(next) << times;
        std::filesystem::rename(next, file_);
    }

  private:
    std::filesystem::path file_;
};

}  // namespace neuvv::test
