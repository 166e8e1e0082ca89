// A stage's JSON with copy-on-write members. Copies of a document share each top-level member ("nodes", "buffers", …)
// until one of them edits that member, which copies its value first. So a copy of a document costs one pointer per
// member, an edit costs a copy of the member that it changes, and comparing pointers shows which members differ between
// two copies.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace neuvv::stage {

class StageJson {
  public:
    // An object without members.
    StageJson() = default;
    // Throws std::invalid_argument for what is no object.
    explicit StageJson(nlohmann::ordered_json object);

    bool contains(std::string_view name) const { return find(name) != nullptr; }
    // Null where there is no such member.
    const nlohmann::ordered_json* find(std::string_view name) const;
    // Throws std::out_of_range where there is no such member.
    const nlohmann::ordered_json& at(std::string_view name) const;
    const nlohmann::ordered_json& operator[](std::string_view name) const { return at(name); }
    // The member, or `otherwise` where there is none; throws as get() of JSON does for another type.
    size_t value(std::string_view name, size_t otherwise) const;
    nlohmann::ordered_json value(std::string_view name, const nlohmann::ordered_json& otherwise) const;
    size_t size() const { return members_.size(); }
    bool empty() const { return members_.empty(); }
    // All members, in the order of the document.
    std::vector<std::pair<std::string_view, const nlohmann::ordered_json*>> members() const;

    // The member for writing; it is added with the value null where it is missing. Write through the reference only
    // until the document is next copied or the member erased: the value may then be shared with a copy.
    nlohmann::ordered_json& edit(std::string_view name);
    void set(std::string_view name, nlohmann::ordered_json value);
    void erase(std::string_view name);
    // Shares with `other` each member whose value is equal in both documents.
    void share(const StageJson& other);

    // Whether both documents share the value of a member, or neither has the member. The values are not compared.
    bool shares(const StageJson& other, std::string_view name) const { return find(name) == other.find(name); }
    // Values that are shared are not compared. The order of members counts, as in ordered_json.
    friend bool operator==(const StageJson& a, const StageJson& b);

    // For each member the address of its value, and roughly the bytes of memory that the value takes.
    std::vector<std::pair<const void*, uint64_t>> sizes() const;

    // The document as one JSON value: a deep copy.
    nlohmann::ordered_json whole() const;
    // The text that whole().dump() would return, without the copy. Bytes that are not UTF-8 are replaced.
    std::string text() const;

  private:
    struct Value;
    struct Member {
        std::string name;
        std::shared_ptr<Value> value;
    };
    size_t index_of(std::string_view name) const;  // size() where there is none

    std::vector<Member> members_;
};

}  // namespace neuvv::stage
