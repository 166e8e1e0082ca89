// What shaders print and assert arrives at the host on every device.
#include "gpu/debug_buffer.h"

#include <algorithm>
#include <bit>

#include "gpu/commands.h"
#include "spirv/debug_probe.comp.h"
#include "support/gpu_test.h"

namespace neuvv::test {
namespace {

struct ProbePush {
    uint32_t count, bad;
};

struct DebugBuffers : GpuTest {
    gpu::ComputePass probe{device(), "debug probe", debug_probe_comp};
    gpu::BindingSet set{probe, {}};  // the debug buffer is bound by itself

    std::vector<DebugRecord> run(uint32_t count, uint32_t bad, uint64_t& lost) {
        gpu::run_once(device(), "debug probe", [&](gpu::Commands& commands) {
            gpu::dispatch(commands, probe, set, count, ProbePush{count, bad});
        });
        return device().debug_buffer().drain(lost);
    }
};

TEST_F(DebugBuffers, HoldWhatEveryThreadSaid) {
    uint64_t lost = 1;
    std::vector<DebugRecord> records = run(1000, 123, lost);
    ASSERT_EQ(records.size(), 1001u);
    EXPECT_EQ(lost, 0u);
    std::sort(records.begin(), records.end(),
              [](auto& a, auto& b) { return std::pair(a.code, a.x) < std::pair(b.code, b.x); });
    for (uint32_t i = 0; i < 1000; ++i) {
        EXPECT_EQ(records[i].code, 7u);
        EXPECT_EQ(records[i].x, i);
        EXPECT_EQ(records[i].words.x, i);
        EXPECT_EQ(std::bit_cast<float>(records[i].words.y), 0.5f * static_cast<float>(i));
    }
    EXPECT_EQ(gpu::text_of(records[4]), "print 7 at (4, 0, 0): 4 1073741824 0 0 (5.60519e-45 2 0 0)");
    EXPECT_EQ(gpu::text_of(records[1000]).substr(0, 38), "assertion 8 failed at (123, 0, 0): 123");
    EXPECT_TRUE(run(0, 0, lost).empty()) << "what was drained does not come again";
}

TEST_F(DebugBuffers, CountWhatHasNoRoom) {
    uint64_t lost = 0;
    EXPECT_EQ(run(kMaxDebugRecords + 100, UINT32_MAX, lost).size(), kMaxDebugRecords);
    EXPECT_EQ(lost, 100u);
    EXPECT_EQ(run(10, UINT32_MAX, lost).size(), 10u);
    EXPECT_EQ(lost, 0u);
}

}  // namespace
}  // namespace neuvv::test
