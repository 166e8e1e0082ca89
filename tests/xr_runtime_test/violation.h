// One thing that an application does wrong, and the runtime's expected reaction.
#pragma once

#include <gtest/gtest.h>

#include "xr_runtime/rules.h"
#include "xr_runtime_test/application.h"

namespace neuvv::test {

enum class Severity { kViolation, kWarning };

struct Violation {
    const char* name;  // of the test
    xr_runtime::Rule rule;
    const char* function;  // the function that is called wrongly
    XrResult result;       // what the call must return
    XrResult (*commit)(Application& app);
    Severity severity = Severity::kViolation;
};

// The tables of violations, one per file.
std::vector<Violation> setup_violations();
std::vector<Violation> struct_violations();
std::vector<Violation> parameter_violations();
std::vector<Violation> session_violations();
std::vector<Violation> frame_violations();
std::vector<Violation> layer_violations();
std::vector<Violation> swapchain_violations();
std::vector<Violation> action_violations();
std::vector<Violation> input_violations();

}  // namespace neuvv::test
