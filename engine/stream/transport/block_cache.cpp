#include "stream/transport/block_cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "base/error.h"
#include "base/platform.h"
#include "stream/codec/bytes.h"
#include "stream/transport/nvs_index.h"

namespace neuvv::stream {

namespace {

constexpr uint64_t kUsualLimit = uint64_t{1} << 30;
constexpr uint32_t kMostMebibytes = 1u << 24;
constexpr uint64_t kCrcBytes = 4;                        // before the bytes of a block: their CRC-32
constexpr uint64_t kMostUncounted = uint64_t{16} << 20;  // after so many bytes, those of all streams are counted
constexpr double kTrimTo = 0.9;                          // of the limit, so that not every block needs room made

struct KeptFile {
    std::filesystem::file_time_type used;
    uint64_t bytes;
    std::filesystem::path path;
};

// All blocks of all streams. What another program removes meanwhile is left out.
std::vector<KeptFile> kept_files(const std::filesystem::path& folder) {
    std::vector<KeptFile> files;
    std::error_code error;
    for (std::filesystem::recursive_directory_iterator at(folder, error), end; !error && at != end;
         at.increment(error)) {
        std::error_code gone;
        if (!at->is_regular_file(gone)) continue;
        const auto used = at->last_write_time(gone);
        const uint64_t bytes = gone ? 0 : at->file_size(gone);
        if (!gone) files.push_back({used, bytes, at->path()});
    }
    return files;
}

}  // namespace

CachePlace usual_cache() {
    uint64_t limit = kUsualLimit;
    if (const char* text = std::getenv("NEUVV_STREAM_CACHE")) {
        uint32_t mebibytes = 0;
        const char* end = text + std::strlen(text);
        const auto [at, error] = std::from_chars(text, end, mebibytes);
        if (error != std::errc() || at != end || mebibytes > kMostMebibytes)
            throw InputError("NEUVV_STREAM_CACHE", text, "is not a number of MiB",
                             fmt::format("write 0 to {}, as in 1024", kMostMebibytes));
        limit = uint64_t{mebibytes} << 20;
    }
    const std::filesystem::path folder = limit > 0 ? cache_folder() : "";
    return {folder.empty() ? folder : folder / "streams", limit};
}

BlockCache::BlockCache(CachePlace place, const std::string& address, uint64_t size, std::span<const uint8_t> beginning)
    : place_(std::move(place)) {
    if (place_.folder.empty() || place_.limit_bytes == 0) return;
    const std::span letters(reinterpret_cast<const uint8_t*>(address.data()), address.size());
    folder_ = place_.folder / fmt::format("{:08x}{:08x}-{}", check_of(letters), check_of(beginning), size);
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    if (error) folder_.clear();
}

std::filesystem::path BlockCache::file_of(uint64_t block) const {
    return folder_ / std::to_string(block);
}

std::optional<std::vector<uint8_t>> BlockCache::read(uint64_t block, uint64_t bytes) const {
    if (folder_.empty()) return std::nullopt;
    std::vector<uint8_t> all(kCrcBytes + bytes);
    std::ifstream file(file_of(block), std::ios::binary);
    file.read(reinterpret_cast<char*>(all.data()), static_cast<std::streamsize>(all.size()));
    if (!file || file.peek() != std::ifstream::traits_type::eof()) return std::nullopt;
    ByteReader reader(all);
    const uint64_t check = reader.number(kCrcBytes);
    std::vector<uint8_t> result(all.begin() + kCrcBytes, all.end());
    if (check != check_of(result)) return std::nullopt;
    std::error_code ignored;
    std::filesystem::last_write_time(file_of(block), std::filesystem::file_time_type::clock::now(), ignored);
    return result;
}

// It is not synced to the disk: whoever reads half a block after a power cut finds a wrong check.
void BlockCache::write(uint64_t block, std::span<const uint8_t> bytes) {
    if (folder_.empty() || bytes.size() > place_.limit_bytes) return;
    std::error_code ignored;
    std::filesystem::create_directories(folder_, ignored);  // others may have removed it when it was empty
    std::vector<uint8_t> check;
    append_number(check, check_of(bytes), kCrcBytes);
    try {
        NewFile file(file_of(block));
        file.write(check.data(), check.size());
        file.write(bytes.data(), bytes.size());
        file.finish(NewFile::Sync::kNo);
    } catch (const RuntimeFailure&) {  // then it is not kept
    }
    const std::lock_guard lock(mutex_);
    if (written_) *written_ += bytes.size();
    if (written_ && *written_ < std::min(kMostUncounted, place_.limit_bytes / 16)) return;
    trim();
    written_ = 0;
}

void BlockCache::trim() const {
    std::vector<KeptFile> files = kept_files(place_.folder);
    uint64_t bytes = 0;
    for (const KeptFile& file : files) bytes += file.bytes;
    if (bytes <= place_.limit_bytes) return;
    std::ranges::sort(files, {}, &KeptFile::used);
    const auto goal = static_cast<uint64_t>(kTrimTo * static_cast<double>(place_.limit_bytes));
    for (const KeptFile& file : files) {
        if (bytes <= goal) return;
        std::error_code ignored;
        std::filesystem::remove(file.path, ignored);
        bytes -= file.bytes;
        if (file.path.parent_path() != folder_) std::filesystem::remove(file.path.parent_path(), ignored);  // if empty
    }
}

void BlockCache::forget() {
    std::error_code ignored;
    if (folder_.empty()) return;
    std::filesystem::remove_all(folder_, ignored);
    std::filesystem::create_directories(folder_, ignored);
}

}  // namespace neuvv::stream
