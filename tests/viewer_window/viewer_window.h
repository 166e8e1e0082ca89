// What the tests of the window share: a small stage, a screen, and comparisons of images.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "support/stage_on_disk.h"
#include "support/temporary_folder.h"
#include "support/waver_tree.h"
#include "tests/tools/run_neuvv.h"
#include "viewer_window/hands.h"
#include "voctree/files/nvv.h"

namespace neuvv::test {

// The share of pixels that differ by more than `steps` of 255 in a channel; 1 where sizes differ.
inline double share_that_differs(const media::Image& a, const media::Image& b, int steps) {
    if (a.width != b.width || a.height != b.height) return 1;
    size_t differ = 0;
    for (size_t i = 0; i < a.rgba.size(); i += 4) {
        int max = 0;
        for (size_t c = 0; c < 3; ++c) max = std::max(max, std::abs(a.rgba[i + c] - b.rgba[i + c]));
        differ += max > steps;
    }
    return 4.0 * static_cast<double>(differ) / static_cast<double>(a.rgba.size());
}

// Images of the same view differ by the rounding of the cameras of blocks, which moves an edge of a leaf or of a shadow
// across the centre of a few pixels.
constexpr double kSameImage = 0.002;
// A change that moves, adds or lights something changes more pixels than this.
constexpr double kOtherImage = 0.005;
constexpr int kSteps = 8;

inline bool same(const media::Image& a, const media::Image& b) {
    return share_that_differs(a, b, kSteps) <= kSameImage;
}
inline bool other(const media::Image& a, const media::Image& b) {
    return a.width == b.width && a.height == b.height && share_that_differs(a, b, kSteps) > kOtherImage;
}

// A stage with the performer `anna`, of two seconds, and with what `neuvv stage new` adds.
struct ViewerWindow : testing::Test {
    TemporaryFolder folder;
    std::string clip = (folder.path / "waver.nvv").string(), stage = (folder.path / "show.gltf").string();
    std::optional<VirtualScreen> screen;

    void SetUp() override {
        if (const std::string why = why_no_hands(); !why.empty()) GTEST_SKIP() << why;
        voctree::write_nvv(clip, waver_tree());
        write_stage(stage, clip, "anna");
        screen.emplace(folder.path);
    }
    std::string file(const char* name) const { return (folder.path / name).string(); }
    static void done(const std::vector<std::string>& arguments) {
        const ProgramResult result = run_neuvv(arguments);
        ASSERT_EQ(result.code, 0) << result.err;
    }
    std::unique_ptr<Hands> open(const std::string& what, const std::string& size = "640x400") const {
        return std::make_unique<Hands>(*screen, folder.path, std::vector<std::string>{what, "--size", size});
    }
    // The image that `neuvv render` makes of the stage through its camera, as large as `as`.
    media::Image rendered(const media::Image& as, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> arguments{"render",     stage,
                                           "-o",         file("rendered.png"),
                                           "--size",     std::to_string(as.width) + "x" + std::to_string(as.height),
                                           "--overwrite"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        done(arguments);
        return media::read_png(file("rendered.png"));
    }
    nlohmann::json saved() const { return nlohmann::json::parse(read_text(stage)); }
    // The number of a node in the file; the count of nodes where there is no such node.
    static size_t node(const nlohmann::json& document, const std::string& name) {
        size_t i = 0;
        while (i < document["nodes"].size() && document["nodes"][i].value("name", "") != name) ++i;
        return i;
    }
};

}  // namespace neuvv::test
