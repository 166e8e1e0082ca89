// To watch: what both eyes see.
#include "golden/golden.h"
#include "render/stage_renderer.h"
#include "support/gpu_test.h"
#include "xr/eye_camera.h"
#include "xr_session/xr_session.h"

namespace neuvv::test {
namespace {

struct Watching : XrSession {};

TEST_F(Watching, BothEyesSeeTheStage) {
    XrScript script;
    script.save(4);
    script.end(6);
    const XrRun run = this->run(script);
    expect_clean(run);
    EXPECT_EQ(check_golden("xr_left", run.picture(4, "left")), "");
    EXPECT_EQ(check_golden("xr_right", run.picture(4, "right")), "");
}

}  // namespace
}  // namespace neuvv::test
