#include "base/formats/npz.h"

#include <fmt/format.h>
#include <libdeflate.h>
#include <zip.h>

#include <new>

#include "base/error.h"
#include "base/formats/npy.h"
#include "base/platform.h"

namespace neuvv {

namespace {

// Weights and octrees pack to a third or a tenth of their size. The limit also bounds the memory that a small file can
// take.
constexpr uint64_t kAllowedBytes = uint64_t{64} << 20, kAllowedRatio = 128;
constexpr int64_t kMaxArrays = 4096;
constexpr const char *kFix = "write it with numpy.savez", *kCopyAgain = "copy the file again";

using ZipFile = std::unique_ptr<zip_file_t, decltype(&zip_fclose)>;

zip_t* open_zip(const std::filesystem::path& file) {
    expect_regular_file(file);
    int error = 0;
    zip_t* zip = zip_open(file.c_str(), ZIP_RDONLY, &error);
    if (zip) return zip;
    zip_error_t reason;
    zip_error_init_with_code(&reason, error);
    const std::string text = zip_error_strerror(&reason);
    zip_error_fini(&reason);
    throw InputError(file.string(), "", fmt::format("cannot be opened as an .npz: {}", text), kFix);
}

}  // namespace

NpzReader::NpzReader(const std::filesystem::path& file) : file_(file.string()), zip_(open_zip(file), zip_discard) {
    const int64_t count = zip_get_num_entries(zip_.get(), 0);
    if (count > kMaxArrays) throw InputError(file_, "", fmt::format("holds {} arrays", count), kFix);
    std::error_code none;
    const uint64_t file_bytes = std::filesystem::file_size(file, none);
    uint64_t left = none ? 0 : kAllowedBytes + kAllowedRatio * file_bytes;
    for (int64_t i = 0; i < count; ++i) {
        zip_stat_t entry;
        zip_stat_init(&entry);
        constexpr zip_uint64_t kNeeded = ZIP_STAT_NAME | ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE | ZIP_STAT_CRC |
                                         ZIP_STAT_COMP_METHOD | ZIP_STAT_ENCRYPTION_METHOD;
        if (zip_stat_index(zip_.get(), static_cast<zip_uint64_t>(i), 0, &entry) != 0 ||
            (entry.valid & kNeeded) != kNeeded || entry.comp_size > file_bytes)
            throw InputError(file_, fmt::format("entry {}", i), "is damaged", kCopyAgain);
        if (entry.size > left) throw InputError(file_, entry.name, "is too large for a file of this size", kFix);
        left -= entry.size;
        std::string name = entry.name;
        if (name.ends_with(".npy")) name.resize(name.size() - 4);
        entries_[name] = {static_cast<uint64_t>(i), entry.size, entry.comp_size, entry.crc,
                          entry.comp_method == ZIP_CM_DEFLATE && entry.encryption_method == ZIP_EM_NONE};
    }
}

std::vector<std::string> NpzReader::names() const {
    std::vector<std::string> names;
    for (const auto& [name, entry] : entries_) names.push_back(name);
    return names;
}

std::vector<uint8_t> NpzReader::bytes(const std::string& name) const {
    const auto found = entries_.find(name);
    if (found == entries_.end()) throw InputError(file_, name, "is missing", kFix);
    if (found->second.deflated) return inflated(found->second, name);
    const ZipFile stream(zip_fopen_index(zip_.get(), found->second.index, 0), zip_fclose);
    std::vector<uint8_t> bytes(found->second.bytes);
    // Reading one byte more than there should be makes libzip check the whole entry's checksum.
    uint8_t beyond = 0;
    if (!stream || zip_fread(stream.get(), bytes.data(), bytes.size()) != static_cast<zip_int64_t>(bytes.size()) ||
        zip_fread(stream.get(), &beyond, 1) != 0)
        throw InputError(file_, name, "is damaged", kCopyAgain);
    return bytes;
}

// libdeflate unpacks at more than twice the speed of zlib, with which libzip does.
std::vector<uint8_t> NpzReader::inflated(const Entry& entry, const std::string& name) const {
    const ZipFile stream(zip_fopen_index(zip_.get(), entry.index, ZIP_FL_COMPRESSED), zip_fclose);
    std::vector<uint8_t> packed(entry.packed_bytes), bytes(entry.bytes);
    const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> decompressor(
        libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
    if (!decompressor) throw std::bad_alloc();
    if (!stream || zip_fread(stream.get(), packed.data(), packed.size()) != static_cast<zip_int64_t>(packed.size()) ||
        libdeflate_deflate_decompress(decompressor.get(), packed.data(), packed.size(), bytes.data(), bytes.size(),
                                      nullptr) != LIBDEFLATE_SUCCESS ||
        libdeflate_crc32(0, bytes.data(), bytes.size()) != entry.checksum)
        throw InputError(file_, name, "is damaged", kCopyAgain);
    return bytes;
}

std::map<std::string, FloatArray> read_npz(const std::filesystem::path& file) {
    const NpzReader npz(file);
    std::map<std::string, FloatArray> arrays;
    for (const std::string& name : npz.names()) {
        const NpyArray array = parse_npy(npz.bytes(name), file.string(), name);
        arrays[name] = {array.shape, {array.values.begin(), array.values.end()}};
    }
    return arrays;
}

}  // namespace neuvv
