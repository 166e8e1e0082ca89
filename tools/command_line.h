// The command line of a program: verbs, their options, their help. The library that parses it, CLI11, is named in
// command_line.cpp alone: a source that includes it compiles for ten seconds more.
#pragma once

#include <cstddef>
#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace neuvv::tools {

struct CommonOptions;

// An option of a verb. A handle: copies are the same option, which lives as long as the program.
class Option {
  public:
    explicit Option(CLI::Option* option) : option_(option) {}

    Option required() const;
    Option show_default() const;  // the help shows the value that the variable has now
    Option excludes(Option other) const;
    Option needs(Option other) const;
    Option delimiter(char between) const;  // between the values of a list
    Option expected(int values) const;     // how many values the option takes
    // The environment variable that is read where the user does not give the option.
    Option environment(const std::string& name) const;

    // The user's value must be such, else the program ends with an error; the help says so.
    template <typename Whole>
    Option in_range(Whole low, Whole high) const;          // int, int64_t or uint32_t
    Option number_between(double low, double high) const;  // NaN is not
    Option one_of(const std::vector<std::string>& names) const;
    Option not_negative() const;
    Option existing_folder() const;

  private:
    CLI::Option* option_;
};

// A verb, the program itself, or a group of a verb's options. A handle like Option.
class Command {
  public:
    explicit Command(CLI::App* command) : command_(command) {}

    Command add_verb(const std::string& name, const std::string& description) const;
    void group_verbs(const std::string& title, std::initializer_list<const char*> names) const;  // in the help
    Command add_group(const std::string& title) const;

    // `name` is "--name", "-n,--name", or "name" for a positional argument. The user's value is parsed into `value`,
    // which must live until the verb has run. command_line.cpp lists the types that a value may have. An empty value is
    // refused: mostly it is a script's variable that is not set.
    template <typename Value>
    Option add_option(const std::string& name, Value& value, const std::string& description) const;
    Option add_flag(const std::string& name, bool& value, const std::string& description) const;
    // The value, which may be empty, is given to `take`, before missing options are looked for. `take` may throw
    // Finished or WrongValue.
    Option add_parsed_option(const std::string& name, std::function<void(const std::string& value)> take,
                             const std::string& description) const;
    struct Finished {};  // the program ends with exit code 0
    struct WrongValue {
        std::string problem;
    };

    void footer(std::initializer_list<std::string_view> parts) const;  // below the help, one behind the other
    void callback(std::function<void()> run) const;                    // once all is parsed
    void require_verb() const;
    void require_options(size_t low, size_t high) const;  // how many of the group the user must give

    size_t count(const std::string& option) const;  // how often the user gave it
    size_t count_all() const;                       // of all options of a group

  private:
    CLI::App* command_;
};

// A program of several verbs: what its errors look like, and the codes with which it ends.
class Program {
  public:
    // With the options, the version and the error message that every program has.
    Program(const std::string& name, const std::string& description, const std::string& version, CommonOptions& common);
    ~Program();

    Command command() { return Command(app_.get()); }

    // Parses the command line, which runs the verb that it names, and returns the exit code: 0, 1 for a failure of the
    // machine, 2 for bad input. An error is one line on stderr, and leaves no empty folder that the verb made. Without
    // a verb, and for `help`, it shows the help.
    int run(int argc, char** argv);

  private:
    int run_verb(int argc, char** argv);

    std::unique_ptr<CLI::App> app_;
    const CommonOptions& common_;
};

}  // namespace neuvv::tools
