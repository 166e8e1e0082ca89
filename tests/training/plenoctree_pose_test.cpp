// A PlenOctree and the poses of the scene that it was made of, which are turned each by its own reader, fit each other.
#include <gtest/gtest.h>

#include "interchange/camera/transforms.h"
#include "reference/camera.h"
#include "reference/slice.h"
#include "reference/trace.h"
#include "support/n3_tree.h"
#include "support/temporary_folder.h"
#include "voctree/files/plenoctree.h"

namespace neuvv::test {
namespace {

constexpr uint32_t kSide = 24;

// A solid cube from −1 to 1. In the file's axes its upper half, z > 0, is red, and of the lower one the part with x > 0
// green, the other blue.
N3Tree coloured_cube() {
    N3Tree tree;
    tree.functions = 1;
    tree.child.assign(8, 0);
    tree.invradius = glm::vec3(0.5f);
    for (uint32_t cell = 0; cell < 8; ++cell) {
        const bool up = cell & 1, right = cell & 4;
        const float on = 30, off = -30;  // logits are 0.28 times these
        tree.data.insert(tree.data.end(), {up ? on : off, !up && right ? on : off, !up && !right ? on : off, 1000});
    }
    return tree;
}

// As Blender's script for the NeRF scenes writes it. The camera is at (0, −4, 0) and looks along +Y; +Z is up.
constexpr const char* kTransforms = R"({"camera_angle_x": 0.9, "frames": [{"file_path": "./train/r_0",
    "rotation": 0.012566, "transform_matrix": [[1, 0, 0, 0], [0, 0, -1, -4], [0, 1, 0, 0], [0, 0, 0, 1]]}]})";

TEST(PlenoctreePose, IsSeenAsTheImagesOfItsSceneShowIt) {
    const TemporaryFolder folder;
    write_npz(folder.path / "tree.npz", coloured_cube().arrays());
    write_text(folder.path / "transforms_train.json", kTransforms);
    const interchange::TransformsFrame frame =
        interchange::read_transforms(folder.path / "transforms_train.json").frames[0];
    const interchange::Lens lens = interchange::make_lens(frame.intrinsics, kSide, kSide);
    stage::Camera camera;
    camera.world_from_camera = frame.world_from_camera;
    camera.width = camera.height = kSide;
    camera.fx = lens.fx;
    camera.fy = lens.fy;
    camera.cx = lens.cx;
    camera.cy = lens.cy;
    const voctree::VOctree tree = voctree::read_plenoctree(folder.path / "tree.npz");
    const std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, 0);
    const double half = lens.fx / 3;  // pixels: the front face, which hides the others, is 3 away
    for (uint32_t y = 0; y < kSide; ++y)
        for (uint32_t x = 0; x < kSide; ++x) {
            const double right = x + 0.5 - lens.cx, down = y + 0.5 - lens.cy;
            const reference::RayResult ray = reference::trace(tree, slices, reference::camera_ray(camera, x, y));
            const bool inside = std::max(std::abs(right), std::abs(down)) < half;
            ASSERT_NEAR(ray.alpha, inside ? 1 : 0, 1e-6) << x << ", " << y;
            if (!inside) continue;
            const glm::dvec3 seen = down < 0    ? glm::dvec3(1, 0, 0)
                                    : right > 0 ? glm::dvec3(0, 1, 0)
                                                : glm::dvec3(0, 0, 1);
            for (int c = 0; c < 3; ++c) ASSERT_NEAR(ray.colour[c], seen[c], 1e-3) << x << ", " << y;
        }
}

}  // namespace
}  // namespace neuvv::test
