// Shaders that replace those that the program was built with: a developer may change shaders while the program runs.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <vector>

namespace neuvv::gpu {

// From SPIR-V that was built in to the SPIR-V that replaces it.
using ShaderReplacements = std::map<std::vector<uint32_t>, std::vector<uint32_t>>;

// Any thread may use it. Passes look their shaders up when they are created; existing passes do not change.
class ShaderTable {
  public:
    ShaderReplacements replacements() const {
        const std::lock_guard lock(mutex_);
        return replacements_;
    }
    void set(ShaderReplacements replacements) {
        const std::lock_guard lock(mutex_);
        replacements_ = std::move(replacements);
    }
    // The replacement of `built_in`, or `built_in` itself where there is none.
    std::vector<uint32_t> newest(std::span<const uint32_t> built_in) const {
        std::vector<uint32_t> words(built_in.begin(), built_in.end());
        const std::lock_guard lock(mutex_);
        const auto found = replacements_.find(words);
        return found == replacements_.end() ? words : found->second;
    }

  private:
    mutable std::mutex mutex_;
    ShaderReplacements replacements_;
};

}  // namespace neuvv::gpu
