// Commits each violation alone, in a session of its own: expects its result, and only its rule in the report.
#include <fstream>
#include <set>

#include "xr_runtime_test/violation.h"

namespace neuvv::test {

using nlohmann::json;

static void PrintTo(const Violation& violation, std::ostream* stream) {
    *stream << violation.rule.name << " in " << violation.function;
}

namespace {

using Lines = std::set<std::string>;

// The findings as "xrEndFrame: layer"; what is wrong in both eyes is found twice.
Lines lines_of(const json& findings) {
    Lines lines;
    for (const json& finding : findings)
        lines.insert(finding.at("function").get<std::string>() + ": " + finding.at("rule").get<std::string>());
    return lines;
}

struct Violations : testing::TestWithParam<Violation> {};

TEST_P(Violations, IsAnsweredAndReported) {
    const Violation& violation = GetParam();
    Application app;
    EXPECT_EQ(violation.commit(app), violation.result);
    const json report = app.end();
    ASSERT_TRUE(report.is_object());
    const Lines found = {std::string(violation.function) + ": " + std::string(violation.rule.name)};
    const bool is_warning = violation.severity == Severity::kWarning;
    EXPECT_EQ(lines_of(report["violations"]), is_warning ? Lines() : found) << report["violations"];
    EXPECT_EQ(lines_of(report["warnings"]), is_warning ? found : Lines()) << report["warnings"];
    EXPECT_EQ(report["destroyed_cleanly"], true);
}

std::string violation_name(const testing::TestParamInfo<Violation>& info) {
    return info.param.name;
}
INSTANTIATE_TEST_SUITE_P(Setup, Violations, testing::ValuesIn(setup_violations()), violation_name);
INSTANTIATE_TEST_SUITE_P(Struct, Violations, testing::ValuesIn(struct_violations()), violation_name);
INSTANTIATE_TEST_SUITE_P(Parameter, Violations, testing::ValuesIn(parameter_violations()), violation_name);
INSTANTIATE_TEST_SUITE_P(Session, Violations, testing::ValuesIn(session_violations()), violation_name);
INSTANTIATE_TEST_SUITE_P(Frame, Violations, testing::ValuesIn(frame_violations()), violation_name);
INSTANTIATE_TEST_SUITE_P(Layer, Violations, testing::ValuesIn(layer_violations()), violation_name);
INSTANTIATE_TEST_SUITE_P(Swapchain, Violations, testing::ValuesIn(swapchain_violations()), violation_name);
INSTANTIATE_TEST_SUITE_P(Action, Violations, testing::ValuesIn(action_violations()), violation_name);
INSTANTIATE_TEST_SUITE_P(Input, Violations, testing::ValuesIn(input_violations()), violation_name);

// Not in the tables, as the runtime also warns of a second acquired image.
TEST(Swapchain, GivesNoMoreImagesThanItHas) {
    Application app;
    app.make_session();
    uint32_t count = 0, index = 0;
    EXPECT_EQ(xrEnumerateSwapchainImages(app.panel, 0, &count, nullptr), XR_SUCCESS);
    for (uint32_t i = 0; i < count; ++i) EXPECT_EQ(xrAcquireSwapchainImage(app.panel, nullptr, &index), XR_SUCCESS);
    EXPECT_EQ(xrAcquireSwapchainImage(app.panel, nullptr, &index), XR_ERROR_CALL_ORDER_INVALID);
    const json report = app.end();
    EXPECT_EQ(lines_of(report["violations"]), Lines{"xrAcquireSwapchainImage: swapchain-order"});
}

// The rules in the table of the README's section "What is checked"; "`swapchain-order`, `-image`" is short for
// `swapchain-order`, `swapchain-image`.
std::set<std::string> rules_of_readme() {
    std::ifstream file(NEUVV_XR_RUNTIME_README);
    std::string line, stem;
    while (std::getline(file, line) && line != "## What is checked") {
    }
    std::set<std::string> rules;
    while (std::getline(file, line)) {
        if (!line.starts_with("| `")) continue;
        std::istringstream cell(line.substr(0, line.find('|', 1)));
        for (std::string word; std::getline(cell, word, '`') && std::getline(cell, word, '`');) {
            if (!word.starts_with('-')) stem = word.substr(0, word.find('-'));
            rules.insert(word.starts_with('-') ? stem + word : word);
        }
    }
    return rules;
}

TEST(Rules, AreTheReadmesAndEachIsBrokenHere) {
    std::set<std::string> broken;
    for (const auto& table :
         {setup_violations(), struct_violations(), parameter_violations(), session_violations(), frame_violations(),
          layer_violations(), swapchain_violations(), action_violations(), input_violations()})
        for (const Violation& violation : table) broken.emplace(violation.rule.name);
    const std::set<std::string> known(std::begin(xr_runtime::kRules), std::end(xr_runtime::kRules));
    EXPECT_EQ(broken, known);
    EXPECT_EQ(rules_of_readme(), known);
}

}  // namespace
}  // namespace neuvv::test
