#include "voctree/files/chunk_file.h"

#include <fmt/format.h>
#include <xxhash.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <memory>
#include <thread>

#include "base/error.h"

namespace neuvv::voctree {

namespace {

static_assert(std::endian::native == std::endian::little, "the file is little-endian, and its numbers are copied");

// Like PNG's signature: a byte with the high bit set, CRLF, ^Z and LF reveal transfers that strip bits or convert line
// ends.
constexpr unsigned char kMagic[8] = {0x89, 'N', 'V', 'V', '\r', '\n', 0x1a, '\n'};
constexpr const char* kEndName = "END ";
constexpr size_t kMaxChunks = 256;
constexpr uint64_t kMaxChunkBytes = uint64_t{1} << 36;
// A file of n bytes may unpack to at most 64 MiB + 1024 n, which refuses decompression bombs: real files unpack to a
// few times their size.
constexpr uint64_t kFreeRawBytes = uint64_t{64} << 20;
constexpr uint64_t kMaxRatio = 1024;
constexpr size_t kPieceBytes = size_t{1} << 20;

struct FileStart {
    unsigned char magic[8];
    uint32_t version;
};

struct StoredHeader {
    char name[4];
    uint32_t flags;
    uint64_t raw_bytes;
    uint64_t stored_bytes;
    uint64_t checksum;
};
static_assert(sizeof(FileStart) == 12 && sizeof(StoredHeader) == 32);
constexpr size_t kHashedHeaderBytes = offsetof(StoredHeader, checksum);

bool ratio_allowed(uint64_t raw_total, uint64_t file_bytes) {
    return raw_total <= kFreeRawBytes + kMaxRatio * file_bytes;
}

// XXH3-64 of header and stored bytes, seeded with the checksum of the chunk before. So it reveals where chunks were
// swapped, dropped or taken from another file.
class Checksum {
  public:
    Checksum(uint64_t seed, const StoredHeader& header) : state_(XXH3_createState(), XXH3_freeState) {
        if (!state_) throw std::bad_alloc();
        XXH3_64bits_reset_withSeed(state_.get(), seed);
        add(&header, kHashedHeaderBytes);
    }
    void add(const void* data, size_t bytes) { XXH3_64bits_update(state_.get(), data, bytes); }
    uint64_t value() const { return XXH3_64bits_digest(state_.get()); }

  private:
    std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state_;
};

StoredHeader stored_header(const ChunkHeader& header) {
    StoredHeader stored{};
    std::memcpy(stored.name, header.name.data(), 4);
    stored.raw_bytes = header.raw_bytes;
    stored.stored_bytes = header.stored_bytes;
    return stored;
}

bool ascii_letter(char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}

}  // namespace

bool is_chunk_name(const std::string& name) {
    return name.size() == 4 && ascii_letter(name[0]) &&
           std::all_of(name.begin(), name.end(), [](char c) { return ascii_letter(c) || (c >= '0' && c <= '9'); });
}

bool is_ancillary(const std::string& chunk_name) {
    return chunk_name[0] >= 'a' && chunk_name[0] <= 'z';
}

ChunkWriter::ChunkWriter(std::string path, const ByteSink& sink, int compression)
    : path_(std::move(path)), sink_(sink), compression_(compression) {
    FileStart start{};
    std::memcpy(start.magic, kMagic, sizeof kMagic);
    start.version = kNvvVersion;
    write(&start, sizeof start);
}

void ChunkWriter::write(const void* data, size_t bytes) {
    sink_(data, bytes);
    file_bytes_ += bytes;
}

void ChunkWriter::write_chunk(const std::string& name, uint64_t raw_bytes, const void* stored, size_t stored_bytes) {
    StoredHeader header = stored_header({name, raw_bytes, stored_bytes, 0});
    Checksum checksum(previous_checksum_, header);
    checksum.add(stored, stored_bytes);
    header.checksum = previous_checksum_ = checksum.value();
    write(&header, sizeof header);
    write(stored, stored_bytes);
}

void ChunkWriter::add(const std::string& name, const void* data, size_t bytes) {
    const auto refuse = [&](const char* problem) {
        throw RuntimeFailure(fmt::format("{}: not written: chunk {}: {}", path_, name, problem));
    };
    if (!is_chunk_name(name)) refuse("a name is four letters or digits, the first a letter");
    if (std::count(names_.begin(), names_.end(), name)) refuse("the name is taken");
    if (names_.size() + 1 >= kMaxChunks) refuse("too many chunks");
    if (bytes > kMaxChunkBytes) refuse("too large");
    names_.push_back(name);
    raw_bytes_ += bytes;

    const std::unique_ptr<ZSTD_CCtx, size_t (*)(ZSTD_CCtx*)> context(ZSTD_createCCtx(), ZSTD_freeCCtx);
    if (!context) throw std::bad_alloc();
    ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, compression_);
    // A zstd that was built without threads refuses this setting and compresses in the calling thread.
    const auto workers = static_cast<int>(std::min(std::thread::hardware_concurrency(), 16u));
    if (bytes > kPieceBytes) ZSTD_CCtx_setParameter(context.get(), ZSTD_c_nbWorkers, workers);
    const size_t room = ZSTD_compressBound(bytes);
    const auto stored = std::make_unique_for_overwrite<uint8_t[]>(room);  // a vector would fill in hundreds of MB first
    const size_t size = ZSTD_compress2(context.get(), stored.get(), room, data, bytes);
    if (ZSTD_isError(size)) refuse(ZSTD_getErrorName(size));
    write_chunk(name, bytes, stored.get(), size);
}

void ChunkWriter::finish() {
    write_chunk(kEndName, 0, nullptr, 0);
    if (!ratio_allowed(raw_bytes_, file_bytes_))
        throw RuntimeFailure(
            fmt::format("{}: not written: {} bytes of content pack into {}, and readers refuse files "
                        "that unpack to so many times their size",
                        path_, raw_bytes_, file_bytes_));
}

FileContent content_of(std::span<const uint8_t> first_bytes) {
    if (first_bytes.size() < sizeof(FileStart) + 4 || std::memcmp(first_bytes.data(), kMagic, 4) != 0)
        return FileContent::kOther;
    return std::memcmp(&first_bytes[sizeof(FileStart)], "PTHD", 4) == 0 ? FileContent::kPaint : FileContent::kClip;
}

FileContent content_of(const std::filesystem::path& path) {
    std::array<uint8_t, sizeof(FileStart) + 4> bytes{};
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return FileContent::kOther;
    std::ifstream file(path, std::ios::binary);
    file.read(reinterpret_cast<char*>(bytes.data()), bytes.size());
    return content_of(std::span<const uint8_t>(bytes).first(static_cast<size_t>(file.gcount())));
}

ChunkReader::ChunkReader(const std::filesystem::path& path, const FileKind& kind) : path_(path.string()) {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) throw InputError(path_, "", "no such file", "check the path");
    if (!std::filesystem::is_regular_file(path, error))
        throw InputError(path_, "", "is not a regular file", fmt::format("name an {} file", kind.ending));
    file_bytes_ = std::filesystem::file_size(path, error);
    file_.open(path, std::ios::binary);
    if (error || !file_) throw InputError(path_, "", "cannot open", "check its permissions");

    FileStart start{};
    read(start.magic, std::min<uint64_t>(sizeof start.magic, file_bytes_));
    if (std::memcmp(start.magic, kMagic, 4) != 0)
        throw InputError(path_, "", fmt::format("is not an {} file", kind.ending), kind.fix);
    if (std::memcmp(start.magic, kMagic, sizeof kMagic) != 0)
        throw InputError(path_, "", "was damaged by a text-mode transfer", "copy it again as binary");
    read(&start.version, sizeof start.version);
    if (start.version != kNvvVersion)
        throw InputError(path_, "",
                         fmt::format("has format version {}, this program reads {}", start.version, kNvvVersion),
                         start.version > kNvvVersion ? "open it with a newer neuvv"
                                                     : "train it again, or open it with the neuvv that wrote it");
}

void ChunkReader::fail(const std::string& problem, const std::string& fix) const {
    const std::string place = open_.name.empty() ? fmt::format("byte {}", position_) : "chunk " + open_.name;
    throw InputError(path_, place, problem, fix);
}

void ChunkReader::fail_damaged(const std::string& problem) const {
    fail(problem, "the file is damaged: copy or write it again");
}

void ChunkReader::read(void* data, size_t bytes) {
    if (bytes > file_bytes_ - position_) fail_damaged("the file ends here, but more must follow");
    file_.read(static_cast<char*>(data), static_cast<std::streamsize>(bytes));
    if (!file_) fail_damaged("cannot read on");
    position_ += bytes;
}

bool ChunkReader::next(ChunkHeader& header) {
    open_ = {};
    StoredHeader stored{};
    read(&stored, sizeof stored);
    const std::string name(stored.name, 4);
    if (name != kEndName && !is_chunk_name(name)) fail_damaged("no chunk starts here");
    open_ = {name, stored.raw_bytes, stored.stored_bytes, stored.checksum};
    if (stored.flags != 0) fail("has flags that this program does not know", "open it with a newer neuvv");
    if (name == kEndName) {
        if (stored.raw_bytes || stored.stored_bytes) fail_damaged("must be empty");
        if (position_ != file_bytes_) fail_damaged("is not the end of the file");
        skip(true);
        return false;
    }
    if (std::count(names_.begin(), names_.end(), name)) fail_damaged("appears twice");
    if (names_.size() + 1 >= kMaxChunks) fail_damaged("is one too many");
    names_.push_back(name);
    if (stored.stored_bytes > file_bytes_ - position_) fail_damaged("is cut off");
    claim(stored.raw_bytes);
    header = open_;
    return true;
}

void ChunkReader::claim(uint64_t bytes) {
    if (bytes > kMaxChunkBytes || !ratio_allowed(raw_total_ += bytes, file_bytes_))
        fail_damaged(fmt::format("claims {} bytes, too many for a file of {}", bytes, file_bytes_));
}

std::vector<uint8_t> ChunkReader::take(uint64_t raw_bytes) {
    if (open_.raw_bytes != raw_bytes)
        fail_damaged(fmt::format("holds {} bytes, not the {} it must", open_.raw_bytes, raw_bytes));
    std::vector<uint8_t> stored(open_.stored_bytes);
    read(stored.data(), stored.size());
    Checksum checksum(previous_checksum_, stored_header(open_));
    checksum.add(stored.data(), stored.size());
    if (checksum.value() != open_.checksum) fail_damaged("checksum does not match");
    previous_checksum_ = open_.checksum;

    const uint32_t magic = ZSTD_MAGICNUMBER;
    if (stored.size() < sizeof magic || std::memcmp(stored.data(), &magic, sizeof magic) != 0 ||
        ZSTD_findFrameCompressedSize(stored.data(), stored.size()) != stored.size())
        fail_damaged("is not one zstd frame");
    const std::unique_ptr<ZSTD_DCtx, size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
    if (!context) throw std::bad_alloc();
    std::vector<uint8_t> raw(raw_bytes);
    const size_t size = ZSTD_decompressDCtx(context.get(), raw.data(), raw.size(), stored.data(), stored.size());
    if (ZSTD_isError(size)) fail_damaged(fmt::format("cannot be unpacked ({})", ZSTD_getErrorName(size)));
    if (size != raw.size()) fail_damaged(fmt::format("unpacks to {} bytes, not {}", size, raw.size()));
    return raw;
}

void ChunkReader::skip(bool verify) {
    if (!verify) {
        file_.seekg(static_cast<std::streamoff>(open_.stored_bytes), std::ios::cur);
        position_ += open_.stored_bytes;
        previous_checksum_ = open_.checksum;
        return;
    }
    Checksum checksum(previous_checksum_, stored_header(open_));
    std::vector<uint8_t> piece(std::min<uint64_t>(kPieceBytes, open_.stored_bytes));
    for (uint64_t left = open_.stored_bytes; left > 0;) {
        const size_t bytes = std::min<uint64_t>(piece.size(), left);
        read(piece.data(), bytes);
        checksum.add(piece.data(), bytes);
        left -= bytes;
    }
    if (checksum.value() != open_.checksum) fail_damaged("checksum does not match");
    previous_checksum_ = open_.checksum;
}

}  // namespace neuvv::voctree
