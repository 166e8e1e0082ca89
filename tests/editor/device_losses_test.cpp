#include "editor/draw/device_losses.h"

#include <gtest/gtest.h>

namespace neuvv {
namespace {

TEST(DeviceLosses, AreAnsweredUnlessTheyComeInARow) {
    editor::DeviceLosses losses;
    for (const double now_s : {10.0, 30.0, 50.0}) EXPECT_NO_THROW(losses.note("device lost", now_s));
    EXPECT_NO_THROW(losses.note("device lost", 71)) << "the first is longer than a minute ago";
    try {
        losses.note("vkQueueSubmit2 failed for \"frame\": device lost", 72);
        ADD_FAILURE() << "the fourth within a minute";
    } catch (const RuntimeFailure& failure) {
        const std::string text = failure.what();
        for (const char* part : {"4 times within 60 s", "vkQueueSubmit2 failed for \"frame\"", "another device"})
            EXPECT_NE(text.find(part), std::string::npos) << text;
    }
}

}  // namespace
}  // namespace neuvv
