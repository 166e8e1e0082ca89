#include "editor/shader_sources.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "base/child_program.h"
#include "base/error.h"
#include "base/platform.h"
#include "spirv/neuvv_render_shaders.h"

namespace neuvv::editor {

namespace {

constexpr uint64_t kMaxSourceBytes = 1 << 20;  // of a file
constexpr uint32_t kSpirvMagic = 0x07230203;

// The first error in the output of the compiler: "trace.comp:12: 'x' : undeclared identifier".
std::string first_error(const std::string& output, const std::string& file) {
    std::istringstream lines(output);
    constexpr std::string_view kError = "ERROR: ";
    for (std::string line; std::getline(lines, line);)
        if (const size_t at = line.find(kError); at != std::string::npos) return line.substr(at + kError.size());
    return fmt::format("{}: glslangValidator: {}", file, output.substr(0, output.find('\n')));
}

// A folder of this user alone, removed with this object.
struct PrivateFolder {
    std::filesystem::path path;
    PrivateFolder() {
        const std::filesystem::path own = cache_folder();
        path = make_private_folder((own.empty() ? std::filesystem::temp_directory_path() : own) / "shader-");
    }
    ~PrivateFolder() {
        std::error_code error;
        std::filesystem::remove_all(path, error);
    }
    PrivateFolder(const PrivateFolder&) = delete;
    PrivateFolder& operator=(const PrivateFolder&) = delete;
};

// The names of the files that a source includes, as they are written there.
std::vector<std::string> include_names(const std::filesystem::path& file) {
    const std::vector<uint8_t> bytes = read_file(file, kMaxSourceBytes);
    std::istringstream lines(std::string(bytes.begin(), bytes.end()));
    std::vector<std::string> names;
    for (std::string line; std::getline(lines, line);) {
        const size_t begin = line.find('"'), end = line.rfind('"');
        if (line.starts_with("#include") && begin < end) names.push_back(line.substr(begin + 1, end - begin - 1));
    }
    return names;
}

}  // namespace

ShaderSources::ShaderSources(std::filesystem::path folder) : folder_(std::move(folder)) {
    for (const auto& [file, words, storage] : neuvv_render_shaders)
        if (!std::filesystem::is_regular_file(folder_ / file))
            throw InputError(folder_.string(), file, "is not there: give the folder shaders of this program's sources");
    last_times_ = times();
}

ShaderSources::Times ShaderSources::times() const {
    Times times;
    std::error_code error;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_, error))
        if (entry.is_regular_file(error)) times[entry.path()] = entry.last_write_time(error);
    return times;
}

// A shader's source and all files that it includes, directly or through others.
std::set<std::filesystem::path> ShaderSources::included(const std::filesystem::path& file) const {
    std::set<std::filesystem::path> found{file};
    std::vector<std::filesystem::path> open{file};
    while (!open.empty()) {
        const std::filesystem::path of = open.back();
        open.pop_back();
        if (!std::filesystem::is_regular_file(of)) continue;  // a text editor is just replacing it
        for (const std::string& name : include_names(of))
            for (const std::filesystem::path& at : {of.parent_path() / name, folder_ / name})
                if (std::filesystem::is_regular_file(at) && found.insert(at).second) open.push_back(at);
    }
    return found;
}

std::vector<uint32_t> ShaderSources::compiled(const std::string& file, bool storage) const {
    const PrivateFolder folder;
    const std::filesystem::path out = folder.path / "out.spv";
    std::vector<std::string> command = {"glslangValidator",      "--quiet", "-V",        "--target-env", "vulkan1.3",
                                        "-I" + folder_.string(), "-o",      out.string()};
    if (storage) command.emplace_back("-DNEUVV_STORAGE_BUFFERS");
    command.push_back((folder_ / file).string());
    const ProgramOutput output = run_program(command);
    if (output.code != 0) throw InputError(folder_.string(), file, first_error(output.text, file));
    const std::vector<uint8_t> bytes = read_file(out, kMaxSourceBytes);
    std::vector<uint32_t> words(bytes.size() / 4);
    if (!words.empty()) std::memcpy(words.data(), bytes.data(), 4 * words.size());
    if (words.empty() || words[0] != kSpirvMagic) throw InputError(folder_.string(), file, "gave no SPIR-V");
    return words;
}

ShaderSources::Change ShaderSources::compile_changes() {
    Change change;
    try {
        Times now = times();
        std::set<std::filesystem::path> changed;
        for (const auto& [path, time] : now)
            if (const auto before = last_times_.find(path); before == last_times_.end() || before->second != time)
                changed.insert(path);
        if (changed.empty()) return change;
        last_times_ = std::move(now);
        find_stale(changed);
        gpu::ShaderReplacements replacements = replacements_;
        for (const auto& [file, words, storage] : neuvv_render_shaders) {
            if (!stale_.contains(file)) continue;
            replacements[{words.begin(), words.end()}] = compiled(file, storage);
            if (!storage) change.compiled.emplace_back(file);
        }
        replacements_ = std::move(replacements);
        stale_.clear();
    } catch (const std::runtime_error& error) {
        change = {{}, error.what()};
    }
    return change;
}

// Marks the shaders that depend on the changed files before it throws, so that they are compiled once that is possible.
// Throws InputError where a header of shared/ changed.
void ShaderSources::find_stale(const std::set<std::filesystem::path>& changed) {
    for (const std::filesystem::path& path : changed)
        if (path.parent_path().filename() == "shared") shared_ = path;
    for (const auto& [file, words, storage] : neuvv_render_shaders) {
        if (storage) continue;  // it has the same parts
        const std::set<std::filesystem::path> parts = included(folder_ / file);
        if (std::any_of(parts.begin(), parts.end(), [&](const auto& part) { return changed.contains(part); }))
            stale_.insert(file);
    }
    if (!shared_.empty()) throw InputError(shared_.string(), "", "C++ has it, too", "build the program anew");
}

}  // namespace neuvv::editor
