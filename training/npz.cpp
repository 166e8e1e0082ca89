#include "training/npz.h"

#include <fmt/format.h>
#include <zip.h>

#include <memory>

#include "base/error.h"
#include "training/npy.h"

namespace neuvv {

namespace {

constexpr uint64_t kMaxArrayBytes = uint64_t{1} << 30, kMaxFileBytes = uint64_t{1} << 31;
constexpr int64_t kMaxArrays = 4096;
constexpr const char* kMend = "write it with numpy.savez";

using Zip = std::unique_ptr<zip_t, decltype(&zip_discard)>;
using ZipFile = std::unique_ptr<zip_file_t, decltype(&zip_fclose)>;

std::vector<uint8_t> read_entry(zip_t* zip, const zip_stat_t& entry, const std::string& file) {
    const ZipFile stream(zip_fopen_index(zip, entry.index, 0), zip_fclose);
    std::vector<uint8_t> bytes(entry.size);
    // Reading one byte more than there should be makes libzip check the whole entry's checksum.
    uint8_t beyond = 0;
    if (!stream || zip_fread(stream.get(), bytes.data(), bytes.size()) != static_cast<zip_int64_t>(bytes.size()) ||
        zip_fread(stream.get(), &beyond, 1) != 0)
        throw InputError(file, entry.name, "is damaged", "copy the file again");
    return bytes;
}

}  // namespace

std::map<std::string, FloatArray> read_npz(const std::filesystem::path& file) {
    int error = 0;
    const Zip zip(zip_open(file.c_str(), ZIP_RDONLY, &error), zip_discard);
    if (!zip) {
        zip_error_t reason;
        zip_error_init_with_code(&reason, error);
        const std::string text = zip_error_strerror(&reason);
        zip_error_fini(&reason);
        throw InputError(file.string(), "", fmt::format("cannot be opened as an .npz: {}", text), kMend);
    }
    const int64_t entries = zip_get_num_entries(zip.get(), 0);
    if (entries > kMaxArrays) throw InputError(file.string(), "", fmt::format("holds {} arrays", entries), kMend);
    std::map<std::string, FloatArray> arrays;
    uint64_t total = 0;
    for (int64_t i = 0; i < entries; ++i) {
        zip_stat_t entry;
        zip_stat_init(&entry);
        constexpr zip_uint64_t kNeeded = ZIP_STAT_NAME | ZIP_STAT_SIZE | ZIP_STAT_INDEX;
        if (zip_stat_index(zip.get(), static_cast<zip_uint64_t>(i), 0, &entry) != 0 ||
            (entry.valid & kNeeded) != kNeeded)
            throw InputError(file.string(), fmt::format("entry {}", i), "is damaged", "copy the file again");
        total += entry.size;
        if (entry.size > kMaxArrayBytes || total > kMaxFileBytes)
            throw InputError(file.string(), entry.name, "is too large", kMend);
        std::string name = entry.name;
        if (name.ends_with(".npy")) name.resize(name.size() - 4);
        const NpyArray array = parse_npy(read_entry(zip.get(), entry, file.string()), file.string(), name);
        arrays[name] = {array.shape, {array.values.begin(), array.values.end()}};
    }
    return arrays;
}

}  // namespace neuvv
