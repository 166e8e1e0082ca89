// A stage's JSON whose copies share what they have in common: each top-level member ("nodes", "buffers", …) is a value
// of its own, which is copied when it is edited while another copy of the document holds it. So a copy costs a pointer
// a member, an edit costs the member that it changes, and whoever keeps a copy can tell by pointers what changed since.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
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
    template <typename Value>
    Value value(std::string_view name, const Value& otherwise) const {
        const nlohmann::ordered_json* found = find(name);
        return found ? found->get<Value>() : otherwise;
    }
    size_t size() const { return members_.size(); }
    bool empty() const { return members_.empty(); }
    // In their order.
    std::vector<std::pair<std::string_view, const nlohmann::ordered_json*>> members() const;

    // The member to be written, made (null) where it is missing. The reference lasts until the document is copied or
    // the member erased: after that it is somebody else's value.
    nlohmann::ordered_json& edit(std::string_view name);
    void set(std::string_view name, nlohmann::ordered_json value) { edit(name) = std::move(value); }
    void erase(std::string_view name);
    // Takes over the values of `other` that are equal to its own, so that both hold them once.
    void share(const StageJson& other);

    // Whether both hold the very same value of a member, or neither has it: known without looking at it.
    bool shares(const StageJson& other, std::string_view name) const { return find(name) == other.find(name); }
    // Values that are shared are not compared. The order of members counts, as in ordered_json.
    friend bool operator==(const StageJson& a, const StageJson& b);

    // About how many bytes of memory each member takes, by its address.
    std::vector<std::pair<const void*, uint64_t>> sizes() const;

    // All of it as one value, for who cannot do with members: a deep copy.
    nlohmann::ordered_json whole() const;
    // As whole().dump() would write it, without the copy. Bytes that are no UTF-8 are replaced.
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
