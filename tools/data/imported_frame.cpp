#include "tools/data/imported_frame.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "base/platform.h"
#include "interchange/splats/splat_image.h"
#include "interchange/splats/splat_ply.h"
#include "interchange/splats/voxelise.h"
#include "interchange/volume/still_tree.h"
#include "interchange/volume/vdb_volume.h"
#include "tools/options.h"

namespace neuvv::tools {

namespace {

// From the file's axes to ours.
glm::dquat rotation_of(Up up) {
    switch (up) {
        case Up::kY:
            break;
        case Up::kMinusY:
            return interchange::kPlyRotation;
        case Up::kZ:
            return glm::dquat(std::sqrt(0.5), -std::sqrt(0.5), 0, 0);  // (x, y, z) becomes (x, z, −y)
    }
    return {1, 0, 0, 0};
}

class VolumeFrame : public ImportedFrame {
  public:
    VolumeFrame(const FrameImportOptions& options, interchange::VdbVolume volume)
        : options_(options), volume_(std::move(volume)) {}
    const interchange::VdbVolume& volume() const { return volume_; }
    void set_doublings(uint32_t doublings) { doublings_ = doublings; }

    voctree::VOctree tree() const override {
        return interchange::tree_of(volume_, doublings_, static_cast<float>(options_.fps));
    }
    media::Image image(const stage::Camera& camera, const glm::vec3& background) const override {
        return interchange::vdb_image(
            volume_, camera, [&] { expect_to_go_on(options_.output); }, background);
    }
    EmptyFrame why_empty() const override {
        const interchange::VdbGrid& density = volume_.density;
        float most = 0;
        for (const float value : density.values) most = std::max(most, value);
        if (most > 0)
            return {fmt::format("has a {} of at most {:.3g} per unit of length, which dims no voxel's light by 0.1 %",
                                density.name, most),
                    "write its voxels in smaller units and give --scale, or make it denser"};
        return {fmt::format("has no voxel of {} above 0 ({} are active)", density.name, density.voxel_count()),
                "name the grid density that is to be shown"};
    }
    std::vector<std::string> notes() const override { return volume_.notes; }

  private:
    const FrameImportOptions& options_;
    interchange::VdbVolume volume_;
    uint32_t doublings_ = 0;
};

class VolumeImport : public FrameImport {
  public:
    explicit VolumeImport(const FrameImportOptions& options) : options_(options) {
        if (!options.box.empty())
            throw InputError("--box", options.box, "is for splats",
                             "leave it out, or crop the volume where it is made");
    }
    std::unique_ptr<ImportedFrame> read(const std::filesystem::path& file) override {
        interchange::VdbFile read = interchange::read_vdb(file);
        const bool turned = !options_.up && read.creator.starts_with("Blender");
        const Up up = options_.up.value_or(turned ? Up::kZ : Up::kY);
        interchange::VdbVolume volume =
            interchange::volume_of(std::move(read.grids), file.string(),
                                   glm::mat4_cast(rotation_of(up)) * glm::dmat4(glm::dmat3(options_.scale)));
        if (turned) volume.notes.emplace_back("is by Blender, so its z axis is up; --up y keeps y");
        auto frame = std::make_unique<VolumeFrame>(options_, std::move(volume));
        if (!doublings_) doublings_ = interchange::doublings_for(frame->volume(), options_.resolution);
        frame->set_doublings(doublings_.value_or(0));
        return frame;
    }

  private:
    const FrameImportOptions& options_;
    std::optional<uint32_t> doublings_;
};

class SplatFrame : public ImportedFrame {
  public:
    SplatFrame(const FrameImportOptions& options, std::string file, interchange::PlySplats read,
               const std::optional<interchange::SplatBox>& box)
        : options_(options), file_(std::move(file)), splats_(std::move(read.splats)), read_(splats_.splats.size()) {
        if (read.left_out > 0)
            notes_.push_back(fmt::format("left out {} of {} splats: the first is {}", read.left_out,
                                         read_ + read.left_out, read.first_left_out));
        full_ = interchange::box_of(splats_);
        box_ = box ? *box : main_box();
        interchange::crop(splats_, box_);
    }
    const interchange::SplatBox& box() const { return box_; }
    void set_cell(double cell_m) { cell_m_ = cell_m; }

    voctree::VOctree tree() const override {
        return interchange::voxelised(splats_, box_, cell_m_, static_cast<float>(options_.fps), file_,
                                      [&] { expect_to_go_on(options_.output); });
    }
    media::Image image(const stage::Camera& camera, const glm::vec3& background) const override {
        return interchange::splat_image(splats_, camera, background);
    }
    EmptyFrame why_empty() const override {
        if (read_ == 0) return {notes_.empty() ? "has no splats" : notes_[0], "write it again"};
        if (full_.longest_m() == 0)
            return {fmt::format("has {} splats, each less opaque than 1/255", read_), "write it again"};
        if (splats_.splats.empty())
            return {fmt::format("has no splat in the box {}", interchange::text_of(box_)),
                    "its splats lie in --box=" + interchange::text_of(full_)};
        return {fmt::format("has no cell that dims light by 0.1 %: cells are {:.3g} m wide", cell_m_),
                "choose a larger --resolution, or --box"};
    }
    std::vector<std::string> notes() const override { return notes_; }

  private:
    interchange::SplatBox main_box() {
        const interchange::MainBox main = interchange::main_box_of(splats_);
        if (main.beyond > 0)
            notes_.push_back(
                fmt::format("{} of {} splats reach beyond the box of the others, which is the clip's; the "
                            "farthest is {}; --box={} keeps all",
                            main.beyond, read_, interchange::place_of(*main.farthest), interchange::text_of(full_)));
        if (main.dense)
            notes_.push_back(
                fmt::format("four of five splats lie in a small part of the clip's box; --box={} makes cells "
                            "{:.0f} times smaller",
                            interchange::text_of(*main.dense), main.box.longest_m() / main.dense->longest_m()));
        return main.box;
    }

    const FrameImportOptions& options_;
    std::string file_;
    interchange::Splats splats_;
    size_t read_;
    std::vector<std::string> notes_;
    interchange::SplatBox full_, box_;
    double cell_m_ = 1;
};

class SplatImport : public FrameImport {
  public:
    explicit SplatImport(const FrameImportOptions& options) : options_(options) {
        if (options.box.empty()) return;
        const std::vector<double> n = parse_numbers("--box", options.box, 6, "write x0,y0,z0,x1,y1,z1 in metres");
        box_ = {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
        if (glm::any(glm::greaterThanEqual(box_->low, box_->high)))
            throw InputError("--box", options.box, "is empty", "write the least corner first");
    }
    std::unique_ptr<ImportedFrame> read(const std::filesystem::path& file) override {
        interchange::PlySplats read = interchange::read_splat_ply(file, options_.scale);
        interchange::turn(read.splats, rotation_of(options_.up.value_or(Up::kMinusY)));
        auto frame = std::make_unique<SplatFrame>(options_, file.string(), std::move(read), box_);
        const double longest = frame->box().longest_m();
        if (!cell_m_ && longest > 0) cell_m_ = longest / options_.resolution;
        frame->set_cell(cell_m_.value_or(1));
        return frame;
    }

  private:
    const FrameImportOptions& options_;
    std::optional<interchange::SplatBox> box_;
    std::optional<double> cell_m_;
};

}  // namespace

std::unique_ptr<FrameImport> import_of(const FrameImportOptions& options) {
    const std::string ending = std::filesystem::path(options.input).extension().string();
    if (ending == ".vdb") return std::make_unique<VolumeImport>(options);
    if (ending == ".ply") return std::make_unique<SplatImport>(options);
    throw InputError(options.input, "", "does not end with .vdb or .ply",
                     "name the frames as in in_%04d.vdb or in_%04d.ply");
}

void expect_to_go_on(const std::string& output) {
    if (stop_requested()) throw RuntimeFailure(fmt::format("{}: stopped before the end", output));
}

}  // namespace neuvv::tools
