#include "base/formats/npz_writer.h"

#include <fmt/format.h>
#include <zip.h>

#include <cstring>
#include <memory>

#include "base/error.h"
#include "base/platform.h"

namespace neuvv {

namespace {

constexpr size_t kNpyAlignment = 64;

std::vector<uint8_t> npy_bytes_of(const NpzArray& array) {
    std::string sides;
    for (const uint64_t side : array.shape) sides += fmt::format("{}, ", side);
    std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", array.type, sides);
    constexpr size_t kBefore = 10;  // magic, version, the header's length
    header.resize((header.size() + 1 + kBefore + kNpyAlignment - 1) / kNpyAlignment * kNpyAlignment - kBefore, ' ');
    header.back() = '\n';
    const uint8_t start[kBefore] = {0x93,
                                    'N',
                                    'U',
                                    'M',
                                    'P',
                                    'Y',
                                    1,
                                    0,
                                    static_cast<uint8_t>(header.size() & 0xff),
                                    static_cast<uint8_t>(header.size() >> 8)};
    std::vector<uint8_t> bytes;
    bytes.reserve(kBefore + header.size() + array.bytes.size());
    bytes.insert(bytes.end(), std::begin(start), std::end(start));
    bytes.insert(bytes.end(), header.begin(), header.end());
    bytes.insert(bytes.end(), array.bytes.begin(), array.bytes.end());
    return bytes;
}

[[noreturn]] void fail_npz(const std::filesystem::path& file, const char* problem) {
    throw RuntimeFailure(fmt::format("{}: cannot be written: {}", file.string(), problem));
}

// Of what libzip has allocated, the last owner lets go.
using ZipSource = std::unique_ptr<zip_source_t, decltype(&zip_source_free)>;

template <typename T>
std::vector<uint8_t> raw_bytes(const T& value) {
    std::vector<uint8_t> bytes(sizeof(T));
    std::memcpy(bytes.data(), &value, sizeof(T));
    return bytes;
}

}  // namespace

NpzArray npz_number(const std::string& name, int64_t number) {
    return {name, "<i8", {}, raw_bytes(number)};
}

NpzArray npz_number(const std::string& name, double number) {
    return {name, "<f8", {}, raw_bytes(number)};
}

NpzArray npz_text(const std::string& name, const std::string& text) {
    NpzArray array{name, fmt::format("<U{}", text.size()), {}, {}};
    for (const char c : text) array.bytes.insert(array.bytes.end(), {static_cast<uint8_t>(c), 0, 0, 0});
    return array;
}

void write_npz(const std::filesystem::path& file, const std::vector<NpzArray>& arrays) {
    std::vector<std::vector<uint8_t>> contents;  // must live until the zip is closed
    for (const NpzArray& array : arrays) contents.push_back(npy_bytes_of(array));
    const ZipSource memory(zip_source_buffer_create(nullptr, 0, 0, nullptr), zip_source_free);
    if (!memory) fail_npz(file, "no memory");
    zip_t* zip = zip_open_from_source(memory.get(), ZIP_TRUNCATE, nullptr);
    if (!zip) fail_npz(file, "no memory");
    zip_source_keep(memory.get());
    for (size_t i = 0; i < arrays.size(); ++i) {
        zip_source_t* source = zip_source_buffer(zip, contents[i].data(), contents[i].size(), 0);
        const std::string name = arrays[i].name + ".npy";
        if (!source || zip_file_add(zip, name.c_str(), source, ZIP_FL_ENC_UTF_8) < 0) {
            if (source) zip_source_free(source);
            zip_discard(zip);
            fail_npz(file, "no memory");
        }
    }
    if (zip_close(zip) != 0) {
        zip_discard(zip);
        fail_npz(file, "it cannot be packed");
    }
    std::vector<uint8_t> packed;
    zip_stat_t stat;
    if (zip_source_open(memory.get()) != 0 || zip_source_stat(memory.get(), &stat) != 0) fail_npz(file, "no memory");
    packed.resize(stat.size);
    const zip_int64_t read = zip_source_read(memory.get(), packed.data(), packed.size());
    zip_source_close(memory.get());
    if (read < 0 || static_cast<uint64_t>(read) != packed.size()) fail_npz(file, "it cannot be packed");
    write_file_atomically(file, [&](const ByteSink& sink) { sink(packed.data(), packed.size()); });
}

}  // namespace neuvv
