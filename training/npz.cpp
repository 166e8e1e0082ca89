#include "training/npz.h"

#include <fmt/format.h>
#include <zip.h>

#include <charconv>
#include <cstring>
#include <memory>

#include "base/error.h"

namespace neuvv {

namespace {

constexpr uint64_t kMaxArrayBytes = uint64_t{1} << 30, kMaxFileBytes = uint64_t{1} << 31;
constexpr int64_t kMaxArrays = 4096;
constexpr size_t kMaxDimensions = 8;
constexpr uint8_t kMagic[6] = {0x93, 'N', 'U', 'M', 'P', 'Y'};
constexpr const char* kMend = "write it with numpy.savez from float32 arrays";

using Zip = std::unique_ptr<zip_t, decltype(&zip_discard)>;
using ZipFile = std::unique_ptr<zip_file_t, decltype(&zip_fclose)>;

// What follows 'key': in the header, a Python dictionary.
std::string value_of(const std::string& header, const std::string& key) {
    const size_t at = header.find("'" + key + "':");
    if (at == std::string::npos) return "";
    const size_t begin = header.find_first_not_of(' ', at + key.size() + 3);
    return begin == std::string::npos ? "" : header.substr(begin);
}

// "(64, 3, 11, 11)…"; false where it is none, or larger than arrays may be.
bool parse_shape(const std::string& text, FloatArray& array, uint64_t& count) {
    const size_t end = text.find(')');
    if (text.empty() || text[0] != '(' || end == std::string::npos) return false;
    count = 1;
    const char *at = text.data() + 1, *last = text.data() + end;
    while (at != last) {
        if (*at == ' ' || *at == ',') {
            ++at;
            continue;
        }
        uint32_t extent = 0;
        const auto [next, error] = std::from_chars(at, last, extent);
        if (error != std::errc() || array.shape.size() == kMaxDimensions) return false;
        array.shape.push_back(extent);
        count *= extent;
        if (count > kMaxArrayBytes / sizeof(float)) return false;
        at = next;
    }
    return true;
}

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

FloatArray parse_npy(const std::vector<uint8_t>& bytes, const std::string& file, const std::string& name) {
    const auto fail = [&](const std::string& problem) -> InputError { return {file, name, problem, kMend}; };
    if (bytes.size() < 12 || std::memcmp(bytes.data(), kMagic, sizeof(kMagic)) != 0) throw fail("is no .npy array");
    const bool long_header = bytes[6] > 1;
    const size_t start = long_header ? 12 : 10;
    uint64_t length = uint64_t{bytes[8]} | uint64_t{bytes[9]} << 8;
    if (long_header) length |= uint64_t{bytes[10]} << 16 | uint64_t{bytes[11]} << 24;
    if (length > bytes.size() - start) throw fail("ends within its header");
    const std::string header(bytes.begin() + static_cast<ptrdiff_t>(start),
                             bytes.begin() + static_cast<ptrdiff_t>(start + length));
    if (value_of(header, "descr").rfind("'<f4'", 0) != 0) throw fail("is not of little-endian float32");
    if (value_of(header, "fortran_order").rfind("False", 0) != 0) throw fail("is not in C order");
    FloatArray array;
    uint64_t count = 0;
    if (!parse_shape(value_of(header, "shape"), array, count)) throw fail("has no shape that can be read");
    if (bytes.size() - start - length != count * sizeof(float))
        throw fail(
            fmt::format("should hold {} numbers, and has {} bytes of them", count, bytes.size() - start - length));
    array.values.resize(count);
    if (count > 0) std::memcpy(array.values.data(), bytes.data() + start + length, count * sizeof(float));
    return array;
}

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
        arrays[name] = parse_npy(read_entry(zip.get(), entry, file.string()), file.string(), name);
    }
    return arrays;
}

}  // namespace neuvv
