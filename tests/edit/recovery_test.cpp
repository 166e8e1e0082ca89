#include "edit/recovery.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "edit/operations.h"
#include "edit/paint_layers.h"
#include "stage/stage.h"
#include "support/input_error.h"
#include "tests/edit/foreign_stage.h"
#include "voctree/files/nvpaint.h"

namespace neuvv {
namespace {

struct Recovery : test::ForeignDocument {
    std::filesystem::path entries = at("state/recovery");

    std::shared_ptr<const voctree::EditLayer> layer(float red) const {
        return std::make_shared<voctree::EditLayer>(voctree::EditLayer{field, {{3, 0, 1, {red, 0, 0}, 1}}});
    }
    edit::RecoveryEntry only_entry() const {
        const std::vector<edit::RecoveryEntry> all = edit::list_recovery(entries);
        EXPECT_EQ(all.size(), 1u);
        return all.at(0);
    }
};

TEST_F(Recovery, ADocumentComesBackAsItWas) {
    voctree::write_paint(at("red.nvpaint"), *layer(0.25f));
    voctree::write_paint(at("blue.nvpaint"), *layer(0.25f));
    edit::add_paint_layer(document.file, 4, at("red.nvpaint"), {});
    edit::add_paint_layer(document.file, 4, at("blue.nvpaint"), {});
    edit::open_paint(document, at("red.nvpaint"), field);
    edit::open_paint(document, at("blue.nvpaint"), field);
    document.paint[at("red.nvpaint")] = layer(0.5f);
    edit::rename_node(document.file, 4, "Bärta");
    {
        edit::RecoveryWriter writer(entries);
        writer.store(document);
        EXPECT_TRUE(only_entry().alive);
        EXPECT_EQ(only_entry().process, process_id());
    }
    const edit::RecoveryEntry entry = only_entry();
    EXPECT_EQ(entry.stage, at("stage.gltf"));
    EXPECT_FALSE(entry.alive) << "its writer is gone";
    EXPECT_TRUE(entry.on_disk);
    EXPECT_FALSE(entry.changed);
    EXPECT_GT(entry.when_s, 1700000000);
    const edit::Document back = edit::restore(entry);
    EXPECT_EQ(back.file.path, at("stage.gltf"));
    EXPECT_EQ(back.file.json, document.file.json);
    EXPECT_EQ(back.file.saved->bytes, document.file.saved->bytes) << "what the disk has";
    EXPECT_NE(back.file.json, back.file.saved->json);
    ASSERT_EQ(back.paint.size(), 1u) << "the blue layer is as on the disk";
    EXPECT_EQ(back.paint.at(at("red.nvpaint"))->edits, layer(0.5f)->edits);
    edit::Document saved = back;
    EXPECT_TRUE(edit::save_document(saved, saved.file.path).empty()) << "nobody else has painted";
    EXPECT_EQ(edit::find_node(stage::load_stage(at("stage.gltf")).file, "Bärta"), 4u);
    EXPECT_EQ(voctree::read_paint(at("red.nvpaint"), field).edits, layer(0.5f)->edits);
    EXPECT_TRUE(only_entry().changed) << "the file was written since";
    edit::discard(entry);
    EXPECT_TRUE(edit::list_recovery(entries).empty());
    EXPECT_TRUE(std::filesystem::is_empty(entries));
}

TEST_F(Recovery, PaintOfAnotherProgramSinceTheCrashIsKept) {
    voctree::write_paint(at("red.nvpaint"), *layer(0.25f));
    for (const char* name : {"red.nvpaint", "new.nvpaint"}) edit::add_paint_layer(document.file, 4, at(name), {});
    edit::open_paint(document, at("red.nvpaint"), field);
    document.paint[at("red.nvpaint")] = document.paint[at("new.nvpaint")] = layer(0.5f);
    { edit::RecoveryWriter(entries).store(document); }
    for (const char* name : {"red.nvpaint", "new.nvpaint"}) voctree::write_paint(at(name), *layer(0.75f));
    edit::RecoveryWriter again(entries);
    again.store(edit::restore(only_entry()));
    ASSERT_EQ(edit::list_recovery(entries).size(), 2u);
    for (const edit::RecoveryEntry& entry : edit::list_recovery(entries)) {
        edit::Document back = edit::restore(entry);
        EXPECT_EQ(edit::save_document(back, back.file.path).size(), 2u) << "also when it is recovered once more";
        for (const char* name : {"red", "new"}) {
            const std::filesystem::path mine = at(std::string(name) + ".nvpaint"),
                                        theirs = at(std::string(name) + "-theirs.nvpaint");
            EXPECT_EQ(voctree::read_paint(mine, field).edits, layer(0.5f)->edits);
            EXPECT_EQ(voctree::read_paint(theirs, field).edits, layer(0.75f)->edits);
            std::filesystem::rename(theirs, mine);
        }
    }
}

// What the disk has may change while the painted layer stays: by a save of an older state.
TEST_F(Recovery, WhatTheDiskHasIsStoredWithEachSave) {
    edit::add_paint_layer(document.file, 4, at("red.nvpaint"), {});
    document.paint[at("red.nvpaint")] = layer(0.5f);
    edit::RecoveryWriter writer(entries);
    writer.store(document);
    document.saved_paint[at("red.nvpaint")] = layer(0.25f);
    voctree::write_paint(at("red.nvpaint"), *layer(0.25f));
    writer.store(document);
    edit::Document back = edit::restore(only_entry());
    EXPECT_TRUE(edit::save_document(back, back.file.path).empty()) << "nobody else has painted";
}

// Of a layer on a clip in segments, the files that were painted.
TEST_F(Recovery, PaintOfSegmentsComesBackFileByFile) {
    const std::filesystem::path look = at("look.nvpaint"), first = look / "000000.nvpaint",
                                second = look / "000012.nvpaint";
    edit::set_paint(document, 4, look, "look", {{first, layer(0.5f)}}, "painted");
    const auto none = std::make_shared<const voctree::EditLayer>(voctree::EditLayer{field, {}});
    document.paint[second] = document.saved_paint[second] = none;  // opened, not painted
    { edit::RecoveryWriter(entries).store(document); }
    edit::Document back = edit::restore(only_entry());
    ASSERT_EQ(back.paint.size(), 1u);
    EXPECT_EQ(back.paint.at(first)->edits, layer(0.5f)->edits);
    EXPECT_EQ(edit::paint_layers_of(back.file, 4)->back().path, look);
    edit::save_document(back, back.file.path);
    EXPECT_EQ(voctree::read_paint(first, field).edits, layer(0.5f)->edits);
    EXPECT_FALSE(std::filesystem::exists(second));
}

TEST_F(Recovery, OnlyWhatChangedIsWritten) {
    document.paint[at("red.nvpaint")] = layer(0.5f);
    document.paint[at("blue.nvpaint")] = layer(0.5f);
    edit::RecoveryWriter writer(entries);
    writer.store(document);
    const std::filesystem::path entry = only_entry().folder;
    const auto files = [&] {
        std::map<std::string, std::filesystem::file_time_type> all;
        for (const auto& file : std::filesystem::directory_iterator(entry))
            all[file.path().filename().string()] = file.last_write_time();
        return all;
    };
    const auto first = files();
    EXPECT_EQ(first.size(), 4u) << "two layers, the JSON, the lock";
    writer.store(document);
    EXPECT_EQ(files(), first);
    document.paint[at("red.nvpaint")] = layer(0.75f);
    writer.store(document);
    const auto second = files();
    EXPECT_EQ(second.size(), 4u) << "the layer that was replaced is gone";
    size_t kept = 0;
    for (const auto& [name, when] : first) kept += second.contains(name) && second.at(name) == when;
    EXPECT_EQ(kept, 2u) << "the other layer and the lock";
    EXPECT_EQ(edit::restore(only_entry()).paint.at(at("red.nvpaint"))->edits, layer(0.75f)->edits);
    document.paint.clear();
    writer.store(document);
    EXPECT_EQ(files().size(), 2u);
    writer.discard();
    EXPECT_TRUE(edit::list_recovery(entries).empty());
    edit::rename_node(document.file, 4, "later");
    writer.store(document);
    EXPECT_EQ(edit::restore(only_entry()).file.json, document.file.json) << "a discarded entry may be begun anew";
}

TEST_F(Recovery, EntriesOfTwoViewersAreTwo) {
    edit::RecoveryWriter one(entries), other(entries);
    one.store(document);
    const stage::StageJson first = document.file.json;
    edit::rename_node(document.file, 4, "other");
    other.store(document);
    edit::Document else_where = document;
    stage::save_stage_file(else_where.file, at("else.gltf"));
    edit::RecoveryWriter third(entries);
    third.store(else_where);
    EXPECT_EQ(edit::list_recovery(entries).size(), 3u);
    const std::vector<edit::RecoveryEntry> found = edit::find_recovery(entries, at("x/../stage.gltf"));
    ASSERT_EQ(found.size(), 2u);
    EXPECT_NE(edit::restore(found[0]).file.json, edit::restore(found[1]).file.json);
    one.discard();
    EXPECT_EQ(edit::find_recovery(entries, at("stage.gltf")).size(), 1u);
    EXPECT_EQ(edit::restore(edit::find_recovery(entries, at("stage.gltf"))[0]).file.json, document.file.json);
}

TEST_F(Recovery, StagesThatWereNeverSaved) {
    for (const char* name : {"new.gltf", "new.glb"}) {
        document = {edit::new_stage(at(name)), {}, {}};
        EXPECT_FALSE(document.file.saved->on_disk);
        edit::rename_node(document.file, 0, "ground");
        edit::RecoveryWriter writer(entries);
        writer.store(document);
        EXPECT_FALSE(only_entry().on_disk);
        EXPECT_FALSE(only_entry().changed);
        edit::Document back = edit::restore(only_entry());
        EXPECT_EQ(back.file.json, document.file.json);
        EXPECT_FALSE(back.file.saved->on_disk);
        write_text(at(name), "somebody else's");
        EXPECT_TRUE(only_entry().changed);
        back = edit::restore(only_entry());
        edit::save_document(back, at(name));
        EXPECT_TRUE(back.file.saved->on_disk);
        EXPECT_EQ(edit::find_node(stage::load_stage(at(name)).file, "ground"), 0u);
        writer.discard();
    }
}

TEST_F(Recovery, AFileThatChangedOrWentAway) {
    edit::rename_node(document.file, 4, "mine");
    edit::RecoveryWriter writer(entries);
    writer.store(document);
    std::string text = read_text(at("stage.gltf"));
    text.replace(text.find("\"Wood\""), 6, "\"Iron\"");
    write_text(at("stage.gltf"), text);
    EXPECT_TRUE(only_entry().changed);
    edit::Document over = edit::restore(only_entry());
    EXPECT_EQ(over.file.json, document.file.json) << "as it was edited, over another file";
    writer.store(over);
    EXPECT_TRUE(only_entry().changed) << "also when it is recovered once more";
    EXPECT_EQ(edit::save_document(over, at("stage.gltf")).at(0).as, at("stage-theirs.gltf"));
    EXPECT_EQ(read_text(at("stage-theirs.gltf")), text);
    EXPECT_TRUE(edit::save_document(over, at("stage.gltf")).empty()) << "now it is ours";
    std::filesystem::remove(at("stage.gltf"));
    EXPECT_TRUE(only_entry().changed);
    const edit::Document back = edit::restore(only_entry());
    EXPECT_EQ(back.file.json, document.file.json);
    EXPECT_FALSE(back.file.saved->on_disk);
    stage::StageFile binary = edit::new_stage(at("b.glb"));
    stage::save_stage_file(binary, at("b.glb"));
    writer.store({binary, {}, {}});
    std::filesystem::remove(at("b.glb"));
    expect_input_error([&] { edit::restore(only_entry()); }, {"b.glb"});
}

TEST_F(Recovery, PathsAreBytes) {
    const std::string odd = "od%d \xff\xfe \"name\".gltf";
    std::filesystem::copy_file(at("stage.gltf"), at(odd));
    document.file = stage::read_stage_file(at(odd));
    edit::RecoveryWriter writer(entries);
    writer.store(document);
    ASSERT_EQ(edit::find_recovery(entries, at(odd)).size(), 1u);
    EXPECT_EQ(edit::restore(only_entry()).file.path, at(odd));
}

TEST_F(Recovery, DamagedEntriesAreRefusedAndHideNoOthers) {
    EXPECT_TRUE(edit::list_recovery(at("no such folder")).empty());
    voctree::write_paint(at("red.nvpaint"), *layer(0.25f));
    document.saved_paint[at("red.nvpaint")] = layer(0.25f);
    document.paint[at("red.nvpaint")] = layer(0.5f);
    edit::RecoveryWriter writer(entries), sound(entries);
    writer.store(document);
    const edit::RecoveryEntry entry = only_entry();
    sound.store(document);
    std::filesystem::create_directory(entries / "empty");
    std::filesystem::create_symlink(entry.folder, entries / "link");
    write_text(entries / "file", "x");
    EXPECT_EQ(edit::list_recovery(entries).size(), 2u);
    const std::string text = read_text(entry.folder / "entry.json");
    const auto refused = [&](const std::string& what, const std::string& with, std::initializer_list<std::string> parts,
                             bool listed) {
        std::string damaged = text;
        const size_t place = damaged.find(what);
        ASSERT_NE(place, std::string::npos) << what;
        write_text(entry.folder / "entry.json", damaged.replace(place, what.size(), with));
        expect_input_error([&] { edit::restore(entry); }, parts);
        EXPECT_EQ(edit::list_recovery(entries).size(), listed ? 2u : 1u) << with;
    };
    refused("\"version\": 1", "\"version\": 2", {"entry.json", "version"}, false);
    refused("\"stage\": \"/", "\"stage\": \"./", {"stage"}, false);
    refused("stage.gltf", "%00stage.gltf", {"stage"}, false);
    refused("\"on_disk\": true", "\"on_disk\": 1", {"on_disk"}, false);
    refused("\"paint\": [", "\"paint\": [7, ", {"entry.json"}, true);
    refused("\"0.nvpaint\"", "\"../0.nvpaint\"", {"entry.json", "file"}, true);
    refused("\"0.nvpaint\"", "\"..\"", {"entry.json", "file"}, true);
    refused("\"0.nvpaint\"", "\"1.nvpaint\"", {"1.nvpaint"}, true);
    refused("\"leaves\": ", "\"leaves\": 1", {"0.nvpaint"}, true);
    refused("\"saved\": \"", "\"saved\": \"x", {"saved"}, true);
    refused("\"topology\": \"", "\"topology\": \"x", {"topology"}, true);
    refused("\"document\": \"{", "\"document\": \"[", {"entry.json"}, true);
    refused("\\\"version\\\":\\\"2.0\\\"", "\\\"version\\\":\\\"1.0\\\"", {"glTF 1.0"}, true);
    write_text(entry.folder / "entry.json", text.substr(0, text.size() / 2));
    expect_input_error([&] { edit::restore(entry); }, {"entry.json"});
    write_text(entry.folder / "entry.json", text);
    const std::string paint = read_text(entry.folder / "0.nvpaint");
    write_text(entry.folder / "0.nvpaint", paint.substr(0, paint.size() - 9));
    expect_input_error([&] { edit::restore(entry); }, {"0.nvpaint"});
    write_text(entry.folder / "0.nvpaint", paint);
    EXPECT_EQ(edit::restore(entry).paint.size(), 1u);
}

TEST_F(Recovery, AFolderThatCannotBeWrittenIsAFailure) {
    write_text(at("state"), "a file in its way");
    edit::RecoveryWriter writer(entries);
    EXPECT_THROW(writer.store(document), RuntimeFailure);
}

}  // namespace
}  // namespace neuvv
