#include "fuzz/mutate.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "voctree/files/chunk_file.h"

namespace neuvv::fuzz {

namespace {

size_t below(size_t end, Random& random) {
    return end == 0 ? 0 : std::uniform_int_distribution<size_t>(0, end - 1)(random);
}

template <typename T, size_t N>
const T& any_of(const T (&things)[N], Random& random) {
    return things[below(N, random)];
}

struct Piece {
    size_t begin = 0, size = 0;
};

// A length from 1 on; short ones are more frequent.
Piece any_piece(const std::string& bytes, Random& random) {
    const size_t begin = below(bytes.size(), random);
    const size_t longest = below(4, random) == 0 ? bytes.size() - begin : std::min<size_t>(bytes.size() - begin, 32);
    return {begin, below(longest + 1, random)};
}

template <typename T>
void overwrite(std::string& bytes, T value, Random& random) {
    if (bytes.size() < sizeof(T)) return;
    const size_t offsets = bytes.size() - sizeof(T) + 1;
    std::memcpy(&bytes[below(offsets, random)], &value, sizeof(T));
}

void overwrite_number(std::string& bytes, Random& random) {
    static constexpr uint64_t kIntegers[] = {0,
                                             1,
                                             2,
                                             16,
                                             0x7f,
                                             0xff,
                                             0x7fff,
                                             0xffff,
                                             0x7fffffff,
                                             0x80000000,
                                             0xffffffff,
                                             0x100000000,
                                             uint64_t{1} << 40,
                                             uint64_t{1} << 61,
                                             uint64_t{1} << 63,
                                             UINT64_MAX / 24,
                                             UINT64_MAX - 1,
                                             UINT64_MAX};
    using Limits = std::numeric_limits<double>;
    static constexpr double kDoubles[] = {0.0,
                                          -0.0,
                                          1.0,
                                          -1.0,
                                          0.5,
                                          1e-9,
                                          1e9,
                                          -1e30,
                                          Limits::max(),
                                          1e16,
                                          1e-6,
                                          1e300,
                                          3.0,
                                          90.0,
                                          Limits::min(),
                                          Limits::denorm_min(),
                                          Limits::infinity(),
                                          Limits::quiet_NaN()};
    const uint64_t integer = any_of(kIntegers, random);
    switch (below(5, random)) {
        case 0:
            return overwrite(bytes, static_cast<uint8_t>(integer), random);
        case 1:
            return overwrite(bytes, static_cast<uint16_t>(integer), random);
        case 2:
            return overwrite(bytes, static_cast<uint32_t>(integer), random);
        case 3:
            return overwrite(bytes, integer, random);
        default:
            overwrite(bytes, any_of(kDoubles, random), random);
    }
}

// Replaces a number that is written in digits by another.
void replace_text_number(std::string& bytes, Random& random) {
    static constexpr const char* kNumbers[] = {
        "0",     "-0",  "1",  "-1",   "0.5",        "1e9",        "-1e30", "1e308", "1e-308",
        "1e999", "nan", "",   "inf",  "-inf",       ".nan",       ".inf",  "null",  "99999999999999999999",
        "0x10",  "1,5", "1 ", "true", "2147483648", "4294967296", "1.",    "\"3\"", "[1]"};
    constexpr const char* kDigits = "0123456789.-+eE";
    const size_t begin = bytes.find_first_of("0123456789", below(bytes.size(), random));
    if (begin == std::string::npos) return;
    const size_t end = std::min(bytes.find_first_not_of(kDigits, begin), bytes.size());
    bytes.replace(begin, end - begin, any_of(kNumbers, random));
}

void insert_syntax(std::string& bytes, Random& random) {
    static constexpr const char* kSyntax[] = {"{",  "}",    "[",   "]",   ":",       ",",    "\"",          "'",
                                              "\n", "\r\n", " ",   "\t",  "- ",      "# ",   "&a",          "*a",
                                              "!!", "%",    "../", "/",   "\\u0000", "\\",   "\xff",        "|",
                                              "? ", "<<",   "---", "...", "[[[[[[",  "{a: ", "\xef\xbb\xbf"};
    const char* what = any_of(kSyntax, random);
    const size_t times = below(16, random) == 0 ? below(2000, random) : 1;
    std::string text;
    for (size_t i = 0; i < times; ++i) text += what;
    bytes.insert(below(bytes.size() + 1, random), text);
}

void change(std::string& bytes, const std::vector<std::string>& others, Random& random) {
    const size_t kind = below(12, random);
    if (bytes.empty() && kind < 9) return;
    const Piece piece = any_piece(bytes, random);
    switch (kind) {
        case 0:
            bytes[piece.begin] = static_cast<char>(bytes[piece.begin] ^ (1 << below(8, random)));
            break;
        case 1:
            bytes[piece.begin] = static_cast<char>(below(256, random));
            break;
        case 2:
        case 3:
            overwrite_number(bytes, random);
            break;
        case 4:
        case 5:
            replace_text_number(bytes, random);
            break;
        case 6:
            bytes.erase(piece.begin, piece.size);
            break;
        case 7:
            bytes.insert(below(bytes.size() + 1, random), bytes.substr(piece.begin, piece.size));
            break;
        case 8: {
            const std::string moved = bytes.substr(piece.begin, piece.size);
            bytes.erase(piece.begin, piece.size);
            bytes.insert(below(bytes.size() + 1, random), moved);
            break;
        }
        case 9:
            insert_syntax(bytes, random);
            break;
        case 10:
            if (below(4, random) == 0) bytes.resize(below(bytes.size() + 1, random));
            break;
        default: {
            if (others.empty()) break;
            const std::string& other = others[below(others.size(), random)];
            const Piece taken = any_piece(other, random);
            bytes.insert(below(bytes.size() + 1, random), other.substr(taken.begin, taken.size));
        }
    }
}

}  // namespace

std::string mutate(std::string bytes, const std::vector<std::string>& others, size_t limit, Random& random) {
    for (size_t changes = 1 + below(8, random); changes > 0; --changes) change(bytes, others, random);
    if (bytes.size() > limit) bytes.resize(limit);
    return bytes;
}

std::string mutate_chunks(const std::filesystem::path& sound, const std::vector<std::string>& others, size_t limit,
                          Random& random) {
    std::vector<std::pair<std::string, std::string>> chunks;  // names and contents
    voctree::ChunkReader reader(sound);
    for (voctree::ChunkHeader header; reader.next(header);) {
        const std::vector<uint8_t> bytes = reader.take(header.raw_bytes);
        chunks.emplace_back(header.name, std::string(bytes.begin(), bytes.end()));
    }
    const size_t chosen = below(chunks.size(), random), kind = below(8, random);
    if (kind == 0)
        chunks.erase(chunks.begin() + static_cast<std::ptrdiff_t>(chosen));
    else if (kind == 1)
        std::swap(chunks[chosen], chunks[below(chunks.size(), random)]);
    else
        chunks[chosen].second = mutate(chunks[chosen].second, others, limit, random);
    std::string file;
    const ByteSink sink = [&](const void* data, size_t bytes) { file.append(static_cast<const char*>(data), bytes); };
    voctree::ChunkWriter writer("fuzz", sink, 1);
    for (const auto& [name, content] : chunks) writer.add(name, content.data(), content.size());
    writer.finish();
    return file;
}

}  // namespace neuvv::fuzz
