#include "stage/file/stage_json.h"

#include <algorithm>
#include <atomic>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace neuvv::stage {

namespace {

using nlohmann::ordered_json;

uint64_t bytes_of(const ordered_json& json) {
    uint64_t bytes = sizeof(ordered_json);
    if (json.is_string()) return bytes + json.get_ref<const std::string&>().size();
    if (json.is_object())
        for (const auto& [name, value] : json.items()) bytes += sizeof(std::string) + name.size() + bytes_of(value);
    if (json.is_array())
        for (const ordered_json& element : json) bytes += bytes_of(element);
    return bytes;
}

}  // namespace

// A value is written only through edit(), and only while a single document refers to it.
struct StageJson::Value {
    ordered_json json;
    mutable std::atomic<uint64_t> bytes{0};  // 0: not counted yet

    explicit Value(ordered_json value) : json(std::move(value)) {}
};

StageJson::StageJson(ordered_json object) {
    if (!object.is_object()) throw std::invalid_argument("a stage's JSON is an object");
    for (auto& [name, value] : object.get_ref<ordered_json::object_t&>())
        members_.push_back({name, std::make_shared<Value>(std::move(value))});
}

size_t StageJson::index_of(std::string_view name) const {
    const auto found = std::find_if(members_.begin(), members_.end(), [&](const Member& m) { return m.name == name; });
    return static_cast<size_t>(found - members_.begin());
}

const ordered_json* StageJson::find(std::string_view name) const {
    const size_t index = index_of(name);
    return index < members_.size() ? &members_[index].value->json : nullptr;
}

const ordered_json& StageJson::at(std::string_view name) const {
    const ordered_json* found = find(name);
    if (!found) throw std::out_of_range("the stage's JSON has no member \"" + std::string(name) + "\"");
    return *found;
}

size_t StageJson::value(std::string_view name, size_t otherwise) const {
    const ordered_json* found = find(name);
    return found ? found->get<size_t>() : otherwise;
}

ordered_json StageJson::value(std::string_view name, const ordered_json& otherwise) const {
    const ordered_json* found = find(name);
    return found ? *found : otherwise;
}

std::vector<std::pair<std::string_view, const ordered_json*>> StageJson::members() const {
    std::vector<std::pair<std::string_view, const ordered_json*>> all;
    for (const Member& member : members_) all.emplace_back(member.name, &member.value->json);
    return all;
}

ordered_json& StageJson::edit(std::string_view name) {
    const size_t index = index_of(name);
    if (index == members_.size()) members_.push_back({std::string(name), std::make_shared<Value>(ordered_json())});
    std::shared_ptr<Value>& value = members_[index].value;
    if (value.use_count() > 1) value = std::make_shared<Value>(value->json);
    // Another thread may just have released its copy. The fence orders that thread's reads before the caller's writes.
    std::atomic_thread_fence(std::memory_order_acquire);
    value->bytes = 0;
    return value->json;
}

void StageJson::set(std::string_view name, ordered_json value) {
    edit(name) = std::move(value);
}

void StageJson::erase(std::string_view name) {
    std::erase_if(members_, [&](const Member& member) { return member.name == name; });
}

void StageJson::share(const StageJson& other) {
    for (Member& member : members_) {
        const size_t index = other.index_of(member.name);
        if (index == other.members_.size()) continue;
        const std::shared_ptr<Value>& theirs = other.members_[index].value;
        if (theirs != member.value && theirs->json == member.value->json) member.value = theirs;
    }
}

bool operator==(const StageJson& a, const StageJson& b) {
    return std::equal(a.members_.begin(), a.members_.end(), b.members_.begin(), b.members_.end(),
                      [](const StageJson::Member& one, const StageJson::Member& other) {
                          return one.name == other.name &&
                                 (one.value == other.value || one.value->json == other.value->json);
                      });
}

std::vector<std::pair<const void*, uint64_t>> StageJson::sizes() const {
    std::vector<std::pair<const void*, uint64_t>> sizes;
    for (const Member& member : members_) {
        if (member.value->bytes == 0) member.value->bytes = bytes_of(member.value->json);
        sizes.emplace_back(member.value.get(), member.value->bytes);
    }
    return sizes;
}

ordered_json StageJson::whole() const {
    ordered_json object = ordered_json::object();
    for (const Member& member : members_) object[member.name] = member.value->json;
    return object;
}

std::string StageJson::text() const {
    std::string text = "{";
    for (const Member& member : members_) {
        if (text.size() > 1) text += ',';
        text += ordered_json(member.name).dump() + ':';
        text += member.value->json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
    }
    return text + '}';
}

}  // namespace neuvv::stage
