#include "base/memory_group.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace neuvv {

namespace {

constexpr uint64_t kNoLimit = uint64_t{1} << 60;  // version 1 writes a number of about 2^63 where there is none

// The number after a label in a file of /proc or /sys; nothing where there is none, as of a limit that is "max".
std::optional<uint64_t> number_after(const std::filesystem::path& path, const std::string& label) {
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        if (!line.starts_with(label)) continue;
        char* end = nullptr;
        const char* digits = line.c_str() + label.size();
        const uint64_t value = std::strtoull(digits, &end, 10);
        return end == digits ? std::nullopt : std::optional(value);
    }
    return std::nullopt;
}

// The names of a version's files.
struct GroupFiles {
    std::vector<const char*> limits;
    const char* used;
    const char* cached;  // label in memory.stat: cached files count as used, but are dropped when memory is needed
};
const GroupFiles kVersion1{{"memory.limit_in_bytes"}, "memory.usage_in_bytes", "total_inactive_file "};
const GroupFiles kVersion2{{"memory.max", "memory.high"}, "memory.current", "inactive_file "};

// What one group leaves; nothing where it has no limit.
std::optional<uint64_t> left_by(const std::filesystem::path& folder, const GroupFiles& files) {
    uint64_t limit = kNoLimit;
    for (const char* name : files.limits) limit = std::min(limit, number_after(folder / name, "").value_or(kNoLimit));
    if (limit == kNoLimit) return std::nullopt;
    const uint64_t used = number_after(folder / files.used, "").value_or(0);
    const uint64_t cached = number_after(folder / "memory.stat", files.cached).value_or(0);
    return limit - std::min(limit, used - std::min(used, cached));
}

// A file system of control groups: the group that is its root, and where that is mounted.
struct Mount {
    std::filesystem::path group, folder;
    const GroupFiles* files;
};

// Of a line of /proc/self/mountinfo: "32 31 0:29 ROOT FOLDER rw … - TYPE SOURCE OPTIONS".
std::optional<Mount> mount_of(const std::string& line) {
    std::istringstream words(line);
    std::string skipped, group, folder, word, type, source, options;
    words >> skipped >> skipped >> skipped >> group >> folder;
    while (words >> word && word != "-") {
    }
    if (!(words >> type >> source >> options)) return std::nullopt;
    if (type == "cgroup2") return Mount{group, folder, &kVersion2};
    const bool of_memory = type == "cgroup" && ("," + options + ",").find(",memory,") != std::string::npos;
    return of_memory ? std::optional(Mount{group, folder, &kVersion1}) : std::nullopt;
}

// The group of this process for a version, of a line of /proc/self/cgroup: "4:memory:/slurm/job_7", "0::/user.slice".
std::optional<std::filesystem::path> group_of(const std::string& line, const GroupFiles* files) {
    const size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) return std::nullopt;
    const std::string kinds = "," + line.substr(first + 1, second - first - 1) + ",";
    const bool meant = files == &kVersion2 ? kinds == ",," : kinds.find(",memory,") != std::string::npos;
    return meant ? std::optional<std::filesystem::path>(line.substr(second + 1)) : std::nullopt;
}

// The folders of a process's group and of those around it, as far as they are mounted. In a container the group may be
// named as the machine names it, or lie outside of what is mounted: then what is mounted is the container's own.
std::vector<std::filesystem::path> folders_of(const Mount& mount, const std::filesystem::path& group,
                                              const std::filesystem::path& root) {
    const std::filesystem::path mounted = root / mount.folder.relative_path();
    std::filesystem::path inside = group.lexically_relative(mount.group);
    std::error_code error;
    if (inside.empty() || *inside.begin() == ".." || !std::filesystem::is_directory(mounted / inside, error))
        inside = ".";
    std::vector<std::filesystem::path> folders = {mounted};
    for (const std::filesystem::path& name : inside)
        if (name != ".") folders.push_back(folders.back() / name);
    return folders;
}

std::vector<std::string> lines_of(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);) lines.push_back(line);
    return lines;
}

}  // namespace

std::optional<uint64_t> memory_left_by_groups(const std::filesystem::path& root) {
    std::optional<uint64_t> least;
    const std::vector<std::string> groups = lines_of(root / "proc/self/cgroup");
    for (const std::string& line : lines_of(root / "proc/self/mountinfo")) {
        const std::optional<Mount> mount = mount_of(line);
        if (!mount) continue;
        for (const std::string& group_line : groups) {
            const auto group = group_of(group_line, mount->files);
            if (!group) continue;
            for (const std::filesystem::path& folder : folders_of(*mount, *group, root))
                if (const auto left = left_by(folder, *mount->files)) least = least ? std::min(*least, *left) : *left;
        }
    }
    return least;
}

uint64_t available_memory_bytes() {
    const std::optional<uint64_t> free_kb = number_after("/proc/meminfo", "MemAvailable:");
    return std::min(free_kb ? *free_kb * 1024 : UINT64_MAX, memory_left_by_groups().value_or(UINT64_MAX));
}

}  // namespace neuvv
