// The table of controllers: each can be bound as a runtime demands, and has what a user needs.
#include "xr/bindings.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace neuvv::test {
namespace {

using xr::BoundHands;
using xr::HandAction;

bool is_bound(const xr::Binding& binding, BoundHands hand) {
    return binding.hands == BoundHands::kBoth || binding.hands == hand;
}

bool has(const xr::ControllerProfile& profile, HandAction action, BoundHands hand) {
    for (const xr::Binding& one : profile.bindings)
        if (one.action == action && is_bound(one, hand)) return true;
    return false;
}

bool has_anywhere(const xr::ControllerProfile& profile, HandAction action) {
    return has(profile, action, BoundHands::kLeftHand) || has(profile, action, BoundHands::kRightHand);
}

TEST(BindingsTest, NoPathIsThereTwice) {
    std::set<std::string> profiles;
    for (const xr::ControllerProfile& profile : xr::controller_profiles()) {
        EXPECT_TRUE(profiles.insert(profile.path).second) << profile.path;
        EXPECT_EQ(xr::find_profile(profile.path), &profile);
        for (const BoundHands hand : {BoundHands::kLeftHand, BoundHands::kRightHand}) {
            std::set<std::string> paths;
            for (const xr::Binding& one : profile.bindings)
                if (is_bound(one, hand)) {
                    EXPECT_TRUE(paths.insert(one.path).second) << profile.path << one.path;
                }
        }
    }
}

TEST(BindingsTest, EachControllerCanDoWhatAUserNeeds) {
    for (const xr::ControllerProfile& profile : xr::controller_profiles()) {
        for (const BoundHands hand : {BoundHands::kLeftHand, BoundHands::kRightHand}) {
            for (const HandAction action : {HandAction::kAim, HandAction::kGrip, HandAction::kSelect})
                EXPECT_TRUE(has(profile, action, hand)) << profile.path << xr::name_of(action).name;
            EXPECT_EQ(has(profile, HandAction::kGrab, hand), profile.has_grab) << profile.path;
            EXPECT_EQ(has(profile, HandAction::kPadClick, hand), profile.has_touch_pad) << profile.path;
            EXPECT_EQ(has(profile, HandAction::kHaptic, hand), !profile.is_hand) << profile.path;
        }
        EXPECT_EQ(has_anywhere(profile, HandAction::kMenu), !profile.is_hand) << profile.path;
    }
}

TEST(BindingsTest, EachActionHasAButtonOnAControllerWithAllButtons) {
    for (const char* path : {"oculus/touch_controller", "facebook/touch_controller_pro", "meta/touch_controller_plus",
                             "bytedance/pico4_controller", "htc/vive_focus3_controller", "hp/mixed_reality_controller",
                             "valve/index_controller", "microsoft/motion_controller", "khr/generic_controller"}) {
        const xr::ControllerProfile* profile = xr::find_profile(std::string("/interaction_profiles/") + path);
        ASSERT_TRUE(profile) << path;
        for (const HandAction action : xr::kHandActions)
            EXPECT_EQ(has_anywhere(*profile, action), action != HandAction::kPadClick)
                << path << " " << xr::name_of(action).name;
    }
}

TEST(BindingsTest, ControllersThatTheCoreDoesNotHaveNameTheirExtension) {
    const std::set<std::string> core{"khr/simple_controller", "oculus/touch_controller", "valve/index_controller",
                                     "htc/vive_controller", "microsoft/motion_controller"};
    for (const xr::ControllerProfile& profile : xr::controller_profiles()) {
        const std::string name = std::string(profile.path).substr(std::string("/interaction_profiles/").size());
        EXPECT_EQ(profile.extension == nullptr, core.contains(name)) << name;
    }
}

}  // namespace
}  // namespace neuvv::test
