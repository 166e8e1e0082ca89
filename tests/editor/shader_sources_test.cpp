#include "editor/shader_sources.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "spirv/resolve.comp.h"
#include "spirv/upscale.comp.h"
#include "support/input_error.h"
#include "support/temporary_folder.h"

namespace neuvv {
namespace {

struct Shaders : testing::Test {
    TemporaryFolder folder;

    void SetUp() override {
        std::filesystem::copy(NEUVV_SHADERS, folder.path, std::filesystem::copy_options::recursive);
    }
    // A time later than all that was written before, whatever the resolution of the file system's clock is.
    void touch(const std::string& name) {
        const auto file = folder.path / name;
        std::filesystem::last_write_time(file,
                                         std::filesystem::last_write_time(file) + std::chrono::seconds(++touched));
    }
    void add(const std::string& name, const std::string& text) {
        std::ofstream(folder.path / name, std::ios::app) << text;
        touch(name);
    }
    int touched = 0;
};

template <size_t n>
std::vector<uint32_t> words_of(const uint32_t (&words)[n]) {
    return {words, words + n};
}

TEST_F(Shaders, AreCompiledAsTheBuildDoes) {
    editor::ShaderSources sources(folder.path);
    EXPECT_TRUE(sources.compile_changes().compiled.empty());
    touch("rays/resolve.comp");
    const editor::ShaderSources::Change change = sources.compile_changes();
    EXPECT_EQ(change.problem, "");
    EXPECT_EQ(change.compiled, std::vector<std::string>{"rays/resolve.comp"});
    ASSERT_EQ(sources.replacements().size(), 2u);
    EXPECT_EQ(sources.replacements().at(words_of(resolve_comp)), words_of(resolve_comp));
    EXPECT_EQ(sources.replacements().at(words_of(resolve_comp_storage)), words_of(resolve_comp_storage));
    EXPECT_TRUE(sources.compile_changes().compiled.empty()) << "once is enough";
}

TEST_F(Shaders, AreCompiledWhenWhatTheyIncludeChanges) {
    editor::ShaderSources sources(folder.path);
    add("rays/show.glsl", "const float kNobodyKnows = 1.0;\n");
    std::vector<std::string> compiled = sources.compile_changes().compiled;
    std::sort(compiled.begin(), compiled.end());
    EXPECT_EQ(compiled, (std::vector<std::string>{"rays/resolve.comp", "rays/upscale.comp"}));
}

TEST_F(Shaders, ThatDoNotCompileAreNamedAndTheLastOnesStay) {
    editor::ShaderSources sources(folder.path);
    const auto whole = std::filesystem::file_size(folder.path / "rays/show.glsl");
    add("rays/show.glsl", "float broken() { return nowhere; }\n");
    editor::ShaderSources::Change change = sources.compile_changes();
    EXPECT_TRUE(change.compiled.empty());
    EXPECT_NE(change.problem.find("'nowhere' : undeclared identifier"), std::string::npos) << change.problem;
    EXPECT_NE(change.problem.find("show.glsl:"), std::string::npos) << change.problem;
    EXPECT_EQ(change.problem.find('\n'), std::string::npos);
    EXPECT_TRUE(sources.replacements().empty());

    std::filesystem::resize_file(folder.path / "rays/show.glsl", whole);
    touch("rays/show.glsl");
    change = sources.compile_changes();
    EXPECT_EQ(change.problem, "");
    EXPECT_EQ(change.compiled.size(), 2u);
    EXPECT_EQ(sources.replacements().at(words_of(upscale_comp)), words_of(upscale_comp));
}

TEST_F(Shaders, MayMakeTheCompilerWarn) {
    editor::ShaderSources sources(folder.path);
    add("rays/resolve.comp", "#extension GL_NV_nobody_has_it : enable\n");
    const editor::ShaderSources::Change change = sources.compile_changes();
    EXPECT_EQ(change.problem, "");
    EXPECT_EQ(sources.replacements().at(words_of(resolve_comp)), words_of(resolve_comp)) << "SPIR-V, and nothing said";
}

TEST_F(Shaders, WhatCppHasTooIsBuiltAnew) {
    editor::ShaderSources sources(folder.path);
    for (const char* changed : {"shared/trace.h", "rays/resolve.comp"}) {  // then none of the shaders is compiled
        touch(changed);
        const editor::ShaderSources::Change change = sources.compile_changes();
        EXPECT_TRUE(change.compiled.empty()) << changed;
        EXPECT_NE(change.problem.find("build the program anew"), std::string::npos) << change.problem;
    }
}

TEST_F(Shaders, AFolderWithoutThemIsRefused) {
    std::filesystem::remove(folder.path / "trace/merge.comp");
    expect_input_error([&] { editor::ShaderSources{folder.path}; }, {"trace/merge.comp", "is not there"});
}

}  // namespace
}  // namespace neuvv
