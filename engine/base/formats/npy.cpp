#include "base/formats/npy.h"

#include <fmt/format.h>

#include <cstring>
#include <regex>

#include "base/error.h"
#include "base/platform.h"

namespace neuvv {

namespace {

constexpr uint64_t kMaxBytes = uint64_t{1} << 28;  // of a file
constexpr uint64_t kMaxCount = uint64_t{1} << 33;
constexpr size_t kMaxHeader = 4096;  // usual ones take a hundred bytes
constexpr uint8_t kMagic[6] = {0x93, 'N', 'U', 'M', 'P', 'Y'};
constexpr const char* kSaveAgain = "save it with numpy from an array of plain numbers";

// The value of a key in the header, which is a Python dictionary; empty: the key is missing.
std::string entry(const std::string& header, const char* key, const char* value_pattern) {
    std::smatch match;
    const std::regex pattern(fmt::format("['\"]{}['\"]\\s*:\\s*{}", key, value_pattern));
    return std::regex_search(header, match, pattern) ? match[1].str() : "";
}

std::vector<uint64_t> parse_shape(const std::string& text, const std::string& file, const std::string& place) {
    std::vector<uint64_t> shape;
    const std::regex number("[0-9]+");
    for (auto at = std::sregex_iterator(text.begin(), text.end(), number); at != std::sregex_iterator(); ++at) {
        if (at->length() > 9) throw InputError(file, place, "its shape is out of all proportion", kSaveAgain);
        shape.push_back(std::stoull(at->str()));
    }
    return shape;
}

// The bytes of one number of a plain little-endian type, 0 for other types.
size_t width_of(const std::string& type) {
    std::smatch match;
    if (std::regex_match(type, match, std::regex("<U([1-9][0-9]{0,3})"))) return 4 * std::stoul(match[1].str());
    static const std::regex plain("<[fiu][248]|\\|[iub]1");
    return std::regex_match(type, plain) ? static_cast<size_t>(type.back() - '0') : 0;
}

}  // namespace

NpyHeader parse_npy_header(const std::vector<uint8_t>& bytes, const std::string& file, const std::string& place) {
    const auto fail = [&](const std::string& problem) { throw InputError(file, place, problem, kSaveAgain); };
    if (bytes.size() < 12 || std::memcmp(bytes.data(), kMagic, sizeof(kMagic)) != 0) fail("is no .npy file");
    const uint8_t version = bytes[6];
    if (version < 1 || version > 3) fail(fmt::format("is of version {}, not 1 to 3", version));
    const size_t start = version == 1 ? 10 : 12;
    size_t length = bytes[8] | size_t{bytes[9]} << 8;
    if (version > 1) length |= size_t{bytes[10]} << 16 | size_t{bytes[11]} << 24;
    if (length > kMaxHeader || start + length > bytes.size()) fail("ends within its header, or the header is damaged");
    const std::string text(bytes.begin() + static_cast<ptrdiff_t>(start),
                           bytes.begin() + static_cast<ptrdiff_t>(start + length));

    NpyHeader header;
    header.begin = start + length;
    header.type = entry(text, "descr", "['\"]([^'\"]{0,16})['\"]");
    const size_t width = width_of(header.type);
    if (width == 0)
        fail(fmt::format("holds {}, not little-endian ones",
                         header.type.empty() ? "records or nothing" : "numbers of type " + header.type));
    if (entry(text, "fortran_order", "(True|False)") != "False") fail("is not in C order");
    const std::string shape = entry(text, "shape", "(\\([0-9, ]{0,200}\\))");
    if (shape.empty()) fail("has no shape");
    header.shape = parse_shape(shape, file, place);
    for (const uint64_t side : header.shape) {
        header.count *= side;  // < 2³³ · 2³⁰
        if (header.count > kMaxCount) fail("is larger than any that is read here");
    }
    const size_t available = bytes.size() - header.begin;
    if (available % width != 0 || available / width != header.count)
        fail(fmt::format("holds {} bytes of numbers, but its shape {}", available, header.count * width));
    return header;
}

NpyArray parse_npy(const std::vector<uint8_t>& bytes, const std::string& file, const std::string& place) {
    const NpyHeader header = parse_npy_header(bytes, file, place);
    if (header.type != "<f8" && header.type != "<f4")
        throw InputError(file, place, fmt::format("holds numbers of type {}, not f4 or f8", header.type), kSaveAgain);
    const size_t width = header.type == "<f8" ? 8 : 4;
    NpyArray array{header.shape, std::vector<double>(header.count)};
    const uint8_t* at = bytes.data() + header.begin;
    for (double& value : array.values) {
        float single = 0;
        std::memcpy(width == 8 ? static_cast<void*>(&value) : &single, at, width);
        if (width == 4) value = double{single};
        at += width;
    }
    return array;
}

NpyArray read_npy(const std::filesystem::path& file) {
    return parse_npy(read_file(file, kMaxBytes), file.string(), "header");
}

}  // namespace neuvv
