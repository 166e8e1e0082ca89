// The names of findings in the report and in README.md. Other names do not compile.
#pragma once

#include <algorithm>
#include <string_view>

namespace neuvv::xr_runtime {

inline constexpr std::string_view kRules[] = {"type",
                                              "next-chain",
                                              "null",
                                              "flags",
                                              "enum",
                                              "two-call",
                                              "handle",
                                              "extension",
                                              "path",
                                              "name",
                                              "time",
                                              "pose",
                                              "system",
                                              "view-configuration",
                                              "view-index",
                                              "reference-space",
                                              "refresh-rate",
                                              "hand-tracking",
                                              "body-tracking",
                                              "joint-count",
                                              "passthrough",
                                              "debug",
                                              "graphics-requirements",
                                              "graphics-device",
                                              "session-state",
                                              "session",
                                              "frame-order",
                                              "events",
                                              "display-time",
                                              "view-pose",
                                              "view-fov",
                                              "view-untracked",
                                              "locate-views",
                                              "should-render",
                                              "swapchain",
                                              "swapchain-order",
                                              "swapchain-image",
                                              "swapchain-format",
                                              "swapchain-usage",
                                              "swapchain-size",
                                              "swapchain-rect",
                                              "swapchain-array",
                                              "layer",
                                              "layer-count",
                                              "view-count",
                                              "quad-size",
                                              "fov",
                                              "depth-range",
                                              "depth-planes",
                                              "depth-views",
                                              "blend-mode",
                                              "action-order",
                                              "action-type",
                                              "subaction-path",
                                              "binding",
                                              "profile",
                                              "haptic",
                                              "runtime"};

struct Rule {
    std::string_view name;
    // NOLINTNEXTLINE(google-explicit-constructor): literals are to become rules
    consteval Rule(const char* text) : name(text) {
        if (std::find(std::begin(kRules), std::end(kRules), name) == std::end(kRules)) throw "no rule has this name";
    }
};

}  // namespace neuvv::xr_runtime
