#include "training/data/layouts/rig/plates.h"

#include <fmt/format.h>

#include "training/data/layouts/rig/camera_folders.h"

namespace neuvv::training {

void find_plates(Rig& rig) {
    const std::filesystem::path folder = rig.folder / "plates";
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder, ignored)) return;
    std::string lacking;
    size_t overruled = 0;
    for (RigCamera& camera : rig.cameras) {
        const ImageSource plate = image_or_video(folder, camera.name);
        if (!camera.plate.path.empty())
            overruled += !plate.path.empty() && plate.path != camera.plate.path.lexically_normal();
        else if (!plate.path.empty())
            camera.plate = plate;
        else
            lacking += " " + camera.name;
    }
    if (!lacking.empty()) rig.remarks.push_back(fmt::format("plates/ has no CAMERA.png of{:.500}", lacking));
    if (overruled > 0)
        rig.remarks.push_back(fmt::format("{} cameras have the plate that {} names, not that of plates/", overruled,
                                          std::filesystem::path(rig.file).filename().string()));
}

}  // namespace neuvv::training
