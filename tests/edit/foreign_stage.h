// A stage that another program wrote, in a folder of its own: the start of tests of edits.
#pragma once

#include <gtest/gtest.h>

#include "edit/edited_stage.h"
#include "support/temporary_folder.h"
#include "tests/stage/stage_files.h"
#include "voctree/files/nvv.h"

namespace neuvv::test {

struct ForeignStage : testing::Test {
    TemporaryFolder folder;
    stage::StageFile file;
    stage::StageJson before;

    void SetUp() override {
        file = stage::read_stage_file(put_foreign_stage(folder.path));
        before = file.json;
    }
};

// The same stage with its paint, as a document to be edited.
struct ForeignDocument : testing::Test {
    TemporaryFolder folder;
    edit::Document document;
    voctree::PaintedField field;  // of anna's clip

    std::filesystem::path at(const std::string& name) const { return folder.path / name; }
    void SetUp() override {
        document.file = stage::read_stage_file(put_foreign_stage(folder.path));
        field = voctree::painted_field(voctree::read_nvv(at("anna.nvv")));
    }
};

}  // namespace neuvv::test
