// What dialogs ask before they run a verb of `neuvv`: its most used options, as a table. The verb itself checks what is
// typed, and all of its other options are on the command line.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace neuvv::viewer {

struct FormField {
    enum class Kind {
        kInput,   // a file to read, with one of the endings in `what` ("" among them: a folder)
        kOutput,  // a file to write, with one of the endings in `what`; "": a folder
        kChoice,  // one of `what`
        kText,
    };
    Kind kind;
    const char* name;    // as it is displayed and reported
    const char* option;  // "--minutes"; "": the verb's argument
    const char* value;   // at first, of an output what follows the input's name; an empty one leaves the option out
    std::vector<const char*> what = {};
    const char* explanation = "";
};

struct VerbForm {
    const char* verb;
    const char* title;
    std::vector<FormField> fields;
    const char* explanation;
};

// capture, import, train, publish and export.
std::span<const VerbForm> verb_forms();
const VerbForm& form_of(const std::string& verb);

// The form's values at first, without input and output.
std::vector<std::string> first_values(const VerbForm& form);
// Sets the verb's argument, and names the output after it where none is given.
void set_input(const VerbForm& form, const std::filesystem::path& input, std::vector<std::string>& values);

// The command line that a filled form means: the verb, then its arguments.
std::vector<std::string> arguments_of(const VerbForm& form, std::span<const std::string> values);
// The same for people, with quotes where a shell needs them.
std::string command_text(std::span<const std::string> arguments);

// The path that the form writes to; empty where none was typed.
std::filesystem::path output_of(const VerbForm& form, std::span<const std::string> values);

// What a line that a verb prints about its progress says: "capture 12/120 …", "0:12 eta 0:48 | …". The share that is
// done, 0 to 1; negative for any other line.
double progress_of(const std::string& line);

}  // namespace neuvv::viewer
