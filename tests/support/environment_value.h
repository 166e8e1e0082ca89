// An environment variable with another value for as long as the object exists.
#pragma once

#include <cstdlib>
#include <optional>
#include <string>

namespace neuvv::test {

class EnvironmentValue {
  public:
    EnvironmentValue(const char* name, const char* value) : name_(name) {
        if (const char* before = std::getenv(name)) before_ = before;
        setenv(name, value, 1);
    }
    ~EnvironmentValue() { before_ ? setenv(name_, before_->c_str(), 1) : unsetenv(name_); }
    EnvironmentValue(const EnvironmentValue&) = delete;
    EnvironmentValue& operator=(const EnvironmentValue&) = delete;

  private:
    const char* name_;
    std::optional<std::string> before_;
};

}  // namespace neuvv::test
