// Frames as closed meshes with textures: .obj, .glb and .ply.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "interchange/mesh/mesh_files.h"
#include "interchange/mesh/mesh_gltf.h"
#include "interchange/mesh/mesh_loss.h"
#include "tools/compared_views.h"
#include "tools/export/exported_clip.h"
#include "tools/export/frame_export.h"
#include "tools/options.h"

namespace neuvv::tools {

namespace {

using interchange::ColouredMesh;

// What files have taken: bytes of a triangle with its share of vertices.
struct MeshFormat {
    const char* ending;
    uint64_t bytes_of_triangle;
    bool has_texture;
};
constexpr MeshFormat kMeshFormats[] = {{".obj", 145, true}, {".glb", 50, true}, {".ply", 27, false}};
constexpr uint64_t kBytesOfFourTexels = 5, kTrianglesOfLeaf = 2;

class MeshExport : public FrameExport {
  public:
    MeshExport(const ExportOptions& options, const MeshFormat& format, ExportedClip& clip, const CommonOptions& common)
        : options_(options), settings_(options.mesh), format_(format), clip_(clip), device_(common.device) {
        if (!format.has_texture) settings_.texture_px = 0;
    }

    bool holds_many() const override { return is(".glb"); }
    Estimate estimate(uint32_t frame) override;
    void measure(uint32_t frame, const Working& working) override;
    void add(uint32_t frame, const Working& working) override;
    void write(const std::filesystem::path& file) override;
    std::vector<std::filesystem::path> files_of(const std::filesystem::path& file) const override;
    void report(nlohmann::ordered_json& json) const override;
    std::string summary() const override;

  private:
    bool is(std::string_view ending) const { return format_.ending == ending; }
    ColouredMesh mesh_of(uint32_t frame, const Working& working);

    const ExportOptions& options_;
    interchange::MeshSettings settings_;
    const MeshFormat& format_;
    ExportedClip& clip_;
    gpu::Device device_;
    std::optional<std::pair<uint32_t, ColouredMesh>> measured_;  // with its frame; until it is added
    std::optional<interchange::MeshLoss> loss_;                  // none where the measured frame is empty
    interchange::MeshGlb glb_;                                   // waits to be written, as does
    ColouredMesh waiting_;                                       // of other kinds of file
    uint64_t added_ = 0, written_ = 0;                           // triangles
};

ColouredMesh MeshExport::mesh_of(uint32_t frame, const Working& working) {
    if (measured_ && measured_->first == frame) return (*std::exchange(measured_, std::nullopt)).second;
    std::optional<ColouredMesh> mesh = interchange::clip_mesh(clip_.slice_of(frame), settings_, working);
    if (!mesh)
        throw InputError("--texture", fmt::format("{}", settings_.texture_px),
                         fmt::format("is too small for the mesh of frame {}", frame),
                         "choose a larger one, or fewer --most-triangles");
    return std::move(*mesh);
}

FrameExport::Estimate MeshExport::estimate(uint32_t frame) {
    uint64_t triangles = kTrianglesOfLeaf * clip_.slice_of(frame).leaves.size();
    if (settings_.most_triangles > 0) triangles = std::min(triangles, uint64_t{settings_.most_triangles});
    const uint64_t texels = uint64_t{settings_.texture_px} * settings_.texture_px;
    return {triangles * format_.bytes_of_triangle + texels * kBytesOfFourTexels / 4,
            fmt::format("about {} triangles", triangles)};
}

void MeshExport::measure(uint32_t frame, const Working& working) {
    ColouredMesh mesh = mesh_of(frame, working);
    if (!mesh.mesh.triangles.empty()) {
        const voctree::VOctree still = clip_.still(frame);
        const ComparedViews compared(device_, still, parse_size(options_.size), options_.views);
        std::vector<interchange::MeshView> views;
        for (size_t i = 0; i < compared.count(); ++i) {
            working("comparing the mesh with images of the middle frame");
            views.push_back({compared.camera_of(i), compared.light_of_still(still, i)});
        }
        loss_ = interchange::loss_of(mesh, views);
    }
    measured_.emplace(frame, std::move(mesh));
}

void MeshExport::add(uint32_t frame, const Working& working) {
    waiting_ = mesh_of(frame, working);
    const glm::dquat rotation = clip_.rotation(frame);
    for (glm::vec3& position : waiting_.mesh.positions) position = glm::vec3(rotation * glm::dvec3(position));
    for (glm::vec3& normal : waiting_.mesh.normals) normal = glm::vec3(rotation * glm::dvec3(normal));
    for (glm::vec3& position : waiting_.mesh.positions) position *= static_cast<float>(clip_.capture().unit);
    added_ += waiting_.mesh.triangles.size();
    if (is(".glb")) glb_.add(waiting_);
}

void MeshExport::write(const std::filesystem::path& file) {
    if (is(".glb")) {
        glb_.write(file, clip_.fps(), clip_.capture().origin);
        glb_ = {};
    } else if (is(".obj")) {
        interchange::write_mesh_obj(file, waiting_, clip_.capture().origin);
    } else {
        interchange::write_mesh_ply(file, waiting_, clip_.capture().origin);
    }
    written_ += std::exchange(added_, 0);
}

std::vector<std::filesystem::path> MeshExport::files_of(const std::filesystem::path& file) const {
    if (is(".obj")) return interchange::files_of_obj(file);
    return {file};
}

void MeshExport::report(nlohmann::ordered_json& json) const {
    json["triangles"] = written_;
    if (!loss_) return;
    json["iou"] = loss_->iou;
    json["depth_mean_mm"] = loss_->depth_mean_mm;
    json["depth_95_mm"] = loss_->depth_95_mm;
    json["psnr_db"] = loss_->psnr_db;
}

std::string MeshExport::summary() const {
    if (!loss_) return fmt::format("{} triangles", written_);
    return fmt::format(
        "{} triangles; of the middle frame, silhouettes agree by {:.1f} % (IoU), depth differs by {:.1f} mm (95 %: "
        "{:.1f} "
        "mm), images have {:.1f} dB",
        written_, 100 * loss_->iou, loss_->depth_mean_mm, loss_->depth_95_mm, loss_->psnr_db);
}

}  // namespace

std::unique_ptr<FrameExport> export_meshes(const ExportOptions& options, const std::string& ending, ExportedClip& clip,
                                           const CommonOptions& common) {
    for (const MeshFormat& format : kMeshFormats)
        if (ending == format.ending) return std::make_unique<MeshExport>(options, format, clip, common);
    return nullptr;
}

}  // namespace neuvv::tools
