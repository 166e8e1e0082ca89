#include "training/npy.h"

#include <fmt/format.h>

#include <cstring>
#include <regex>

#include "base/error.h"
#include "base/platform.h"

namespace neuvv {

namespace {

constexpr uint64_t kMaxBytes = uint64_t{1} << 28;
constexpr size_t kMaxHeader = 4096;  // ours take a hundred bytes
constexpr uint8_t kMagic[6] = {0x93, 'N', 'U', 'M', 'P', 'Y'};
constexpr const char* kMend = "save it with numpy from an array of float32 or float64";

// What the header, a Python dictionary, says of a key; empty: nothing.
std::string entry(const std::string& header, const char* key, const char* value_pattern) {
    std::smatch match;
    const std::regex pattern(fmt::format("['\"]{}['\"]\\s*:\\s*{}", key, value_pattern));
    return std::regex_search(header, match, pattern) ? match[1].str() : "";
}

std::vector<uint64_t> parse_shape(const std::string& text, const std::string& file, const std::string& place) {
    std::vector<uint64_t> shape;
    const std::regex number("[0-9]+");
    for (auto at = std::sregex_iterator(text.begin(), text.end(), number); at != std::sregex_iterator(); ++at) {
        if (at->length() > 9) throw InputError(file, place, "its shape is out of all proportion", kMend);
        shape.push_back(std::stoull(at->str()));
    }
    return shape;
}

}  // namespace

NpyArray parse_npy(const std::vector<uint8_t>& bytes, const std::string& file, const std::string& place) {
    const auto fail = [&](const std::string& problem) { throw InputError(file, place, problem, kMend); };
    if (bytes.size() < 12 || std::memcmp(bytes.data(), kMagic, sizeof(kMagic)) != 0) fail("is no .npy file");
    const uint8_t version = bytes[6];
    if (version < 1 || version > 3) fail(fmt::format("is of version {}, not 1 to 3", version));
    const size_t begin = version == 1 ? 10 : 12;
    size_t length = bytes[8] | size_t{bytes[9]} << 8;
    if (version > 1) length |= size_t{bytes[10]} << 16 | size_t{bytes[11]} << 24;
    if (length > kMaxHeader || begin + length > bytes.size()) fail("ends within its header, or the header is damaged");
    const std::string header(bytes.begin() + static_cast<ptrdiff_t>(begin),
                             bytes.begin() + static_cast<ptrdiff_t>(begin + length));

    const std::string type = entry(header, "descr", "['\"]([^'\"]{0,16})['\"]");
    if (type != "<f8" && type != "<f4")
        fail(fmt::format("holds {}, not little-endian f4 or f8",
                         type.empty() ? "records or nothing" : "numbers of type " + type));
    if (entry(header, "fortran_order", "(True|False)") != "False") fail("is not in C order");
    if (entry(header, "shape", "(\\([0-9, ]{0,200}\\))").empty()) fail("has no shape");
    NpyArray array;
    array.shape = parse_shape(entry(header, "shape", "(\\([0-9, ]{0,200}\\))"), file, place);
    const size_t width = type == "<f8" ? 8 : 4, available = bytes.size() - begin - length;
    uint64_t count = 1;
    for (const uint64_t side : array.shape) {
        count *= side;  // < 2³⁰ · 2³⁰
        if (count > kMaxBytes) fail("is larger than any that is read here");
    }
    if (count * width != available)
        fail(fmt::format("holds {} bytes of numbers, but its shape {}", available, count * width));
    array.values.resize(count);
    const uint8_t* at = bytes.data() + begin + length;
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
