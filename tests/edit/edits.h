// A stage of another program, opened to be edited.
#pragma once

#include <gtest/gtest.h>

#include "edit/operations.h"
#include "stage/evaluated_stage.h"
#include "stage/stage.h"
#include "support/near.h"
#include "tests/stage/stage_files.h"

namespace neuvv::edits_test {

using nlohmann::ordered_json;
using test::expect_near;

struct Edits : testing::Test {
    TemporaryFolder folder;
    stage::StageFile file;

    void SetUp() override { file = stage::read_stage_file(test::put_foreign_stage(folder.path)); }
    std::filesystem::path at(const std::string& name) const { return folder.path / name; }
    // The stage of the document as it would be saved.
    stage::Stage stage() const {
        stage::expect_sound_document(file);
        return stage::make_stage(file);
    }
    ordered_json& node(const std::string& name) { return file.json.edit("nodes")[edit::find_node(file, name)]; }
    const stage::EvaluatedPerformer performer(const std::string& name, double t = 0) const {
        const stage::Stage now = stage();
        for (const stage::EvaluatedPerformer& at : stage::stage_at(now, t).performers)
            if (now.performers[at.performer].name == name) return at;
        throw std::runtime_error("no performer " + name);
    }
};

inline glm::dvec3 position(const glm::dmat4& m) {
    return m[3];
}

inline glm::dvec3 front(const glm::dmat4& m) {
    return glm::normalize(glm::dvec3(m[2]));
}

}  // namespace neuvv::edits_test
