// The text of OpenUSD's attributes and names.
#pragma once

#include <glm/glm.hpp>
#include <set>
#include <string>
#include <vector>

namespace neuvv::interchange {

// Appends "name = value", or samples at the time codes 0, 1, … where the values differ; `name` has the type before it.
// There is at least one value.
void append_usd_values(std::string& text, const std::string& indent, const std::string& name,
                       const std::vector<std::string>& values);

// A matrix for column vectors as OpenUSD writes it, for row vectors.
std::string usd_matrix(const glm::dmat4& matrix);
// "quoted", with what would end it escaped.
std::string usd_quoted(const std::string& text);

// Names of prims that are not taken yet: letters, digits and underscores.
class UsdNames {
  public:
    std::string take(const std::string& name);

  private:
    std::set<std::string> taken_;
};

}  // namespace neuvv::interchange
