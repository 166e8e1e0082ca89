// The two kinds of errors that modules throw. main and tests catch them; so does code that can go on without what
// failed.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "base/remedy.h"

namespace neuvv {

// A value that the user chose, by its name: "size". A command line names it by its option.
struct Setting {
    std::string name;
};

// What an error is about: a file, or a setting.
struct Subject {
    std::string name;
    bool is_setting = false;

    Subject(const char* file) : name(file) {}
    Subject(std::string file) : name(std::move(file)) {}
    Subject(Setting setting) : name(std::move(setting.name)), is_setting(true) {}
};

// what() is one line, "cause; fix", which names no program's options. cause() and fix() are for programs that have
// options to name.
struct Failure : std::runtime_error {
    const std::string& cause() const { return cause_; }
    const Fix& fix() const { return fix_; }
    bool is_about_setting() const { return about_setting_; }  // with whose name the cause begins

  protected:
    Failure(const std::string& cause, const Fix& fix, bool about_setting);

  private:
    std::string cause_;
    Fix fix_;
    bool about_setting_;
};

// A user's bad input: the cause is "subject: place: what is wrong". Exit code 2.
struct InputError : Failure {
    // `place` says where in the file the problem is (a chunk, a JSON pointer, a frame); `fix` says what to do. Both may
    // be empty.
    InputError(const Subject& subject, const std::string& place, const std::string& problem, const Fix& fix = {});
};

// The machine failed: a Vulkan call, a full disk, a missing device feature. Exit code 1.
struct RuntimeFailure : Failure {
    explicit RuntimeFailure(const std::string& cause, const Fix& fix = {}) : Failure(cause, fix, false) {}
};

// What a user should know although nothing failed, such as why a part is not shown. Without text: nothing.
struct Note {
    std::string text;
    Fix fix;

    Note() = default;
    Note(const std::exception& error);  // its what(), with the fix kept apart where there is one
    Note(const char* said) : text(said) {}
    Note(std::string said, Fix what_to_do = {}) : text(std::move(said)), fix(std::move(what_to_do)) {}
    bool empty() const { return text.empty(); }
    std::string words() const;  // "text; fix", which names no program's options
    bool operator==(const Note&) const = default;
};

// Text for one line of a terminal, cut where it is long and without passwords: what() and its parts are made so.
std::string shortened(const std::string& text);

}  // namespace neuvv
