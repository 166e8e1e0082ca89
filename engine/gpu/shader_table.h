// Shaders that take the place of those that the program was built with: a developer's, who changes them while it runs.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <vector>

namespace neuvv::gpu {

// SPIR-V by the SPIR-V that was built in.
using ShaderReplacements = std::map<std::vector<uint32_t>, std::vector<uint32_t>>;

// For any thread. Passes look their shaders up when they are made; those that are there stay as they are.
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
    // What stands for it now; itself, where nothing does.
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
