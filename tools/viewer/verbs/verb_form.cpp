#include "tools/viewer/verbs/verb_form.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <regex>
#include <stdexcept>

namespace neuvv::viewer {

namespace {

using Kind = FormField::Kind;

const std::vector<VerbForm>& table() {
    static const std::vector<VerbForm> kForms = {
        {"capture",
         "Capture a model",
         {{Kind::kInput, "model", "", "", {".glb", ".gltf"}, "An animated glTF model"},
          {Kind::kOutput, "into", "-o", "-data", {""}, "The folder of the data set"},
          {Kind::kText, "cameras", "--cameras", "40"},
          {Kind::kText, "frames", "--frames", "24"},
          {Kind::kText, "frame rate", "--fps", "12"},
          {Kind::kText, "image size", "--size", "320x320"}},
         "A dome of virtual cameras around the model makes a data set to train on."},
        {"import",
         "Import splats or volumes",
         {{Kind::kInput, "input", "", "", {".ply", ".vdb"}, "One file, or in_%04d.ply for a file each frame"},
          {Kind::kOutput, "into", "-o", ".nvv", {".nvv"}},
          {Kind::kText, "resolution", "--resolution", "256", {}, "Cells along the longest side"},
          {Kind::kChoice, "up", "--up", "", {"", "y", "-y", "z"}, "Empty: y of a .vdb, -y of a .ply"},
          {Kind::kText, "scale", "--scale", "1", {}, "Metres that the files' unit is"},
          {Kind::kText, "frame rate", "--fps", "25"}},
         "Gaussian splats or volumes of other programs become a clip."},
        {"train",
         "Train a clip",
         {{Kind::kInput, "data set", "", "", {""}, "The folder of a calibrated multi-view video"},
          {Kind::kOutput, "into", "-o", ".nvv", {".nvv"}},
          {Kind::kText, "minutes", "--minutes", "20"},
          {Kind::kChoice,
           "refine",
           "--refine",
           "",
           {"", "none", "auto", "colour", "exposure", "poses"},
           "What else is learnt, of the cameras; empty: colours, where they differ"},
          {Kind::kText, "segments", "--segment", "", {}, "Frames in a tree, or auto; empty: one tree for all"}},
         "The clip is read again with each checkpoint, so that it can be watched while it is trained. Stop keeps what "
         "is there."},
        {"publish",
         "Publish a stream",
         {{Kind::kInput, "clip", "", "", {".nvv", ".npz", ".gltf", ".glb"}},
          {Kind::kOutput, "into", "-o", ".nvs", {".nvs"}},
          {Kind::kText, "quality", "--quality", "47", {}, "PSNR in dB that images keep at least"}},
         "A stream has a quarter of the clip's bytes or less, and plays from any file server that answers ranges."},
        {"export",
         "Export frames",
         {{Kind::kInput, "clip", "", "", {".nvv", ".nvs", ".npz", ".gltf", ".glb"}},
          {Kind::kOutput,
           "into",
           "-o",
           "_%04d.ply",
           {".ply", ".glb", ".usda", ".obj", ".npz", ".vdb"},
           "frame_%04d.ply: a file each frame"},
          {Kind::kChoice,
           "as",
           "--as",
           "",
           {"", "splats", "mesh", "plenoctree", "volumes"},
           "Empty: the first that has the ending"},
          {Kind::kText, "frames", "--frames", "", {}, "FIRST:LAST; empty: all"}},
         "Frames for other programs: Gaussian splats, meshes, volumes or PlenOctrees."},
    };
    return kForms;
}

bool needs_quotes(const std::string& word) {
    const std::string harmless = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789/._-+=:,%@";
    return word.empty() || word.find_first_not_of(harmless) != std::string::npos;
}

// "4.2 s", "3:07", "1:02:30" in seconds.
double seconds_of(const std::string& text) {
    double seconds = 0;
    for (const char* at = text.c_str();;) {
        char* end = nullptr;
        seconds = 60 * seconds + std::strtod(at, &end);
        if (*end != ':') return seconds;
        at = end + 1;
    }
}

}  // namespace

std::span<const VerbForm> verb_forms() {
    return table();
}

const VerbForm& form_of(const std::string& verb) {
    for (const VerbForm& form : table())
        if (verb == form.verb) return form;
    throw std::logic_error("no form of " + verb);
}

std::vector<std::string> first_values(const VerbForm& form) {
    std::vector<std::string> values;
    for (const FormField& field : form.fields) values.emplace_back(field.kind == Kind::kOutput ? "" : field.value);
    return values;
}

void set_input(const VerbForm& form, const std::filesystem::path& input, std::vector<std::string>& values) {
    const std::filesystem::path whole = std::filesystem::absolute(input).lexically_normal();
    const std::filesystem::path named = whole.has_filename() ? whole : whole.parent_path();
    for (size_t i = 0; i < values.size(); ++i) {
        const FormField& field = form.fields[i];
        if (field.kind == Kind::kInput) values[i] = named.string();
        if (field.kind == Kind::kOutput && values[i].empty())
            values[i] = (named.parent_path() / named.stem()).string() + field.value;
    }
}

std::vector<std::string> arguments_of(const VerbForm& form, std::span<const std::string> values) {
    std::vector<std::string> arguments{form.verb};
    for (size_t i = 0; i < values.size(); ++i) {
        const FormField& field = form.fields[i];
        if (values[i].empty()) continue;
        if (*field.option) arguments.emplace_back(field.option);
        arguments.push_back(values[i]);
    }
    return arguments;
}

std::string command_text(std::span<const std::string> arguments) {
    std::string text;
    for (const std::string& argument : arguments) {
        if (!text.empty()) text += ' ';
        if (!needs_quotes(argument)) {
            text += argument;
            continue;
        }
        text += '\'';
        for (const char c : argument) c == '\'' ? text += "'\\''" : text += c;
        text += '\'';
    }
    return text;
}

std::filesystem::path output_of(const VerbForm& form, std::span<const std::string> values) {
    for (size_t i = 0; i < values.size(); ++i)
        if (form.fields[i].kind == Kind::kOutput) return values[i];
    return {};
}

double progress_of(const std::string& line) {
    // Progress stands at the beginning. std::regex recurses for each byte, and its time grows with their square.
    constexpr size_t kMostBytes = 300;
    const std::string begin = line.substr(0, kMostBytes);
    static const std::regex kDone(R"(\s(\d+)/(\d+)\s+elapsed)"), kTimes(R"(([\d.:]+)(?: s)? eta ([\d.:]+))");
    std::smatch found;
    if (std::regex_search(begin, found, kDone)) {
        const double done = std::stod(found[1]), all = std::stod(found[2]);
        return all > 0 ? std::min(1.0, done / all) : -1;
    }
    if (std::regex_search(begin, found, kTimes)) {
        const double elapsed = seconds_of(found[1]), left = seconds_of(found[2]);
        return elapsed + left > 0 ? elapsed / (elapsed + left) : -1;
    }
    return -1;
}

}  // namespace neuvv::viewer
