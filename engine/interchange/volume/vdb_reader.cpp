#include "interchange/volume/vdb_reader.h"

#include <blosc.h>
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/gtc/matrix_access.hpp>
#include <span>
#include <stdexcept>

#include "base/error.h"
#include "base/platform.h"
#include "interchange/volume/vdb_types.h"
#include "stream/codec/bytes.h"

namespace neuvv::interchange {

namespace {

// The layout is that of openvdb/io/Archive.cc and Compression.h, tree/RootNode.h, InternalNode.h and LeafNode.h.
constexpr uint64_t kMagic = 0x56444220;
constexpr uint32_t kOldestVersion = 222, kNewestVersion = 224, kUuidBytes = 36;
enum Packing : uint32_t { kZip = 1, kActiveMask = 2, kBlosc = 4 };
// What a node's first byte says of its values that are not active.
enum Inactive : uint8_t { kBackground, kMinusBackground, kOne, kMaskOfBackgrounds, kMaskAndOne, kMaskAndTwo, kAll };
// Edges of the cubes that nodes cover, voxels, as powers of two: leaf, its parent, and the root's child.
constexpr uint32_t kLeafLog2 = 3, kLowerLog2 = 7, kUpperLog2 = 12;
// Of voxels, in the file's units.
constexpr double kLeastEdge = 1e-9, kMostEdge = 1e9, kMostOffset = 1e12;
// Around the name of a grid's type.
constexpr const char *kTypeBegin = "Tree_", *kTypeEnd = "_5_4_3", *kSavedAsHalf = "_HalfFloat";
constexpr uint32_t kMostGrids = 1000, kMostMetadata = 10000;

// Bits of a node's children or values.
struct Mask {
    std::vector<uint64_t> words;
    bool operator[](size_t i) const { return words[i / 64] >> i % 64 & 1; }
    size_t count() const {
        size_t sum = 0;
        for (const uint64_t word : words) sum += static_cast<size_t>(std::popcount(word));
        return sum;
    }
};

// Of a grid that is sound, but of a kind that is not read.
struct UnreadGrid : std::runtime_error {
    using std::runtime_error::runtime_error;
};

class GridReader {
  public:
    // Takes what the grid needs from `memory`, in bytes.
    GridReader(stream::ByteReader& bytes, uint64_t& memory) : bytes_(bytes), memory_(memory) {}
    // Reads what stands behind the grid's descriptor. `shared`: the grid whose voxels it has, or null.
    VdbGrid read(const VdbType& type, bool halves, const VdbGrid* shared);

  private:
    void read_metadata();
    void read_map();
    void read_root();
    void read_node(const glm::ivec3& min, uint32_t log2);
    void read_leaf_values(VdbBlock& block);
    void read_leaf_bits(VdbBlock& block);
    void share_voxels(const VdbGrid& with);
    Mask read_mask(size_t bits);
    std::vector<float> read_values(const Mask& active, size_t count);
    std::vector<uint8_t> unpacked(size_t count);
    void add_tile(const glm::ivec3& min, uint32_t log2, const float* value);
    void keep(const float* value);
    void use_memory(uint64_t bytes) {
        if (bytes > memory_) throw std::runtime_error("needs more memory than there is");
        memory_ -= bytes;
    }
    glm::ivec3 read_origin(uint32_t log2);

    stream::ByteReader& bytes_;
    uint64_t& memory_;
    uint32_t packing_ = 0;
    const VdbType* type_ = nullptr;
    bool halves_ = false;
    VdbGrid grid_;
};

int32_t whole(stream::ByteReader& bytes) {
    return static_cast<int32_t>(bytes.number(4));
}

std::string text(stream::ByteReader& bytes) {
    const auto taken = bytes.take(bytes.number(4));
    return {taken.begin(), taken.end()};
}

// Passes over metadata, but for the text of one of this name.
std::string read_metadata(stream::ByteReader& bytes, const std::string& wanted) {
    std::string found;
    const uint64_t count = bytes.number(4);
    if (count > kMostMetadata) throw std::runtime_error("has too many metadata");
    for (uint64_t i = 0; i < count; ++i) {
        const std::string name = text(bytes), type = text(bytes), value = text(bytes);
        if (name == wanted && type == "string") found = value;
    }
    return found;
}

void GridReader::read_metadata() {
    grid_.grid_class = interchange::read_metadata(bytes_, "class");
}

void GridReader::read_map() {
    const std::string type = text(bytes_);
    const auto vector = [&] {
        glm::dvec3 v;
        for (int i = 0; i < 3; ++i) v[i] = std::bit_cast<double>(bytes_.number(8));
        return v;
    };
    glm::dmat4& m = grid_.world_from_index;
    if (type == "AffineMap" || type == "UnitaryMap") {  // its rows are our columns: vectors stand to the left of it
        for (int c = 0; c < 4; ++c)
            for (int r = 0; r < 4; ++r) m[c][r] = std::bit_cast<double>(bytes_.number(8));
    } else {
        const bool translates = type.ends_with("TranslateMap") || type == "TranslationMap";
        const bool scales = type.starts_with("Scale") || type.starts_with("UniformScale");
        if (!translates && !scales) throw UnreadGrid("has a " + type + ", which is not affine");
        if (translates) m[3] = glm::dvec4(vector(), 1);
        if (scales) {
            const glm::dvec3 scale = vector();
            for (int i = 0; i < 4; ++i) vector();  // what follows from it
            for (int i = 0; i < 3; ++i) m[i][i] = scale[i];
        }
    }
    if (glm::row(m, 3) != glm::dvec4(0, 0, 0, 1)) throw std::runtime_error("has a transform that is not affine");
    for (int i = 0; i < 3; ++i) {
        const double edge = glm::length(glm::dvec3(m[i]));
        if (!(edge >= kLeastEdge && edge <= kMostEdge && std::abs(m[3][i]) <= kMostOffset))
            throw std::runtime_error("has a transform with numbers that are too small or too large");
    }
    const double determinant = glm::determinant(glm::dmat3(m));
    if (!std::isfinite(determinant) || determinant == 0 || !std::isfinite(m[3][0] + m[3][1] + m[3][2]))
        throw std::runtime_error("has a transform without an inverse");
}

Mask GridReader::read_mask(size_t bits) {
    Mask mask{std::vector<uint64_t>(bits / 64)};
    for (uint64_t& word : mask.words) word = bytes_.number(8);
    return mask;
}

// The bytes of so many values.
std::vector<uint8_t> GridReader::unpacked(size_t count) {
    const size_t size = count * grid_.channels * (halves_ ? 2 : type_->bytes_of_number);
    if (halves_ && count == 0) return {};  // without a size in front
    if (!(packing_ & (kZip | kBlosc))) {
        const auto taken = bytes_.take(size);
        return {taken.begin(), taken.end()};
    }
    const auto stored = static_cast<int64_t>(bytes_.number(8));
    if (stored <= 0) {  // did not become smaller
        if (stored != -static_cast<int64_t>(size)) throw std::runtime_error("has values of a wrong size");
        const auto taken = bytes_.take(size);
        return {taken.begin(), taken.end()};
    }
    const auto packed = bytes_.take(static_cast<uint64_t>(stored));
    std::vector<uint8_t> bytes(size);
    bool good = false;
    if (packing_ & kBlosc) {
        size_t expected = 0;
        good = blosc_cbuffer_validate(packed.data(), packed.size(), &expected) == 0 && expected == size &&
               blosc_decompress_ctx(packed.data(), bytes.data(), size, 1) == static_cast<int>(size);
    } else {
        uLongf expected = size;
        good = uncompress(bytes.data(), &expected, packed.data(), packed.size()) == Z_OK && expected == size;
    }
    if (!good) throw std::runtime_error("has values that cannot be unpacked");
    return bytes;
}

// The values of the active voxels of a node with so many, in order.
std::vector<float> GridReader::read_values(const Mask& active, size_t count) {
    const uint64_t inactive = bytes_.number(1);
    if (inactive > kAll) throw std::runtime_error("has a node of an unknown kind");
    const int stored = inactive == kMaskAndTwo ? 2 : inactive == kOne || inactive == kMaskAndOne ? 1 : 0;
    bytes_.take(uint64_t{type_->bytes_of_number} * grid_.channels * static_cast<uint64_t>(stored));
    if (inactive == kMaskOfBackgrounds || inactive == kMaskAndOne || inactive == kMaskAndTwo) bytes_.take(count / 8);
    const bool only_active = (packing_ & kActiveMask) && inactive != kAll;
    const std::vector<uint8_t> raw = unpacked(only_active ? active.count() : count);
    stream::ByteReader numbers(raw);
    std::vector<float> values;
    for (size_t i = 0; i < count; ++i)
        for (uint32_t c = 0; c < grid_.channels && (active[i] || !only_active); ++c) {
            const float value = read_vdb_number(numbers, halves_ ? VdbNumber::kHalf : type_->number);
            if (active[i]) values.push_back(value);
        }
    return values;
}

void GridReader::keep(const float* value) {
    grid_.values.insert(grid_.values.end(), value, value + grid_.channels);
}

// What is active of a mask is all that it says; the library stores any value with it.
void GridReader::add_tile(const glm::ivec3& min, uint32_t log2, const float* value) {
    constexpr float kActive = 1;
    use_memory(2 * (sizeof(VdbTile) + sizeof(float) * grid_.channels));  // twice: vectors grow so
    grid_.tiles.push_back({min, 1 << log2, grid_.values.size() / grid_.channels});
    keep(type_->number == VdbNumber::kMask ? &kActive : value);
}

glm::ivec3 GridReader::read_origin(uint32_t log2) {
    glm::ivec3 origin;
    for (int i = 0; i < 3; ++i) {
        origin[i] = whole(bytes_);
        if (origin[i] < -kMostVdbIndex || origin[i] > kMostVdbIndex - (1 << log2))
            throw std::runtime_error(fmt::format("has voxels beyond {}", kMostVdbIndex));
        if (origin[i] % (1 << log2) != 0) throw std::runtime_error("has a node at an odd place");
    }
    return origin;
}

// A node of the two kinds between root and leaves.
void GridReader::read_node(const glm::ivec3& min, uint32_t log2) {
    const uint32_t child_log2 = log2 == kUpperLog2 ? kLowerLog2 : kLeafLog2, side_log2 = log2 - child_log2;
    const size_t count = size_t{1} << 3 * side_log2;
    const Mask children = read_mask(count), active = read_mask(count);
    const std::vector<float> values = read_values(active, count);
    size_t next = 0;
    for (size_t i = 0; i < count; ++i) {
        const size_t mask = (size_t{1} << side_log2) - 1;
        const glm::ivec3 at = min + glm::ivec3(i >> 2 * side_log2, i >> side_log2 & mask, i & mask) * (1 << child_log2);
        if (active[i] && !children[i]) add_tile(at, child_log2, &values[next]);
        if (active[i]) next += grid_.channels;
        if (!children[i]) continue;
        if (child_log2 == kLeafLog2) {
            bytes_.take(sizeof(VdbBlock::active));  // the mask is there again before the leaf's values
            use_memory(2 * sizeof(VdbBlock));
            grid_.blocks.push_back({at, {}, 0});
        } else {
            read_node(at, child_log2);
        }
    }
}

void GridReader::read_root() {
    if (bytes_.number(4) != 1) throw std::runtime_error("has several buffers a grid, as files of old versions");
    std::vector<float> value(grid_.channels);
    const auto read_value = [&] {
        for (float& v : value) v = read_vdb_number(bytes_, type_->number);
    };
    read_value();  // the background
    const uint64_t tiles = bytes_.number(4), children = bytes_.number(4);
    for (uint64_t i = 0; i < tiles; ++i) {
        const glm::ivec3 at = read_origin(kUpperLog2);
        read_value();
        if (bytes_.number(1) != 0) add_tile(at, kUpperLog2, value.data());
    }
    for (uint64_t i = 0; i < children; ++i) {
        const glm::ivec3 at = read_origin(kUpperLog2);
        read_node(at, kUpperLog2);
    }
}

void GridReader::read_leaf_values(VdbBlock& block) {
    const Mask active = read_mask(64 * block.active.size());
    std::copy(active.words.begin(), active.words.end(), block.active.begin());
    block.first = grid_.values.size() / grid_.channels;
    const std::vector<float> values = read_values(active, 64 * block.active.size());
    use_memory(2 * sizeof(float) * values.size());
    grid_.values.insert(grid_.values.end(), values.begin(), values.end());
}

// Of a bool or a mask: one bit each voxel. The voxels that are true stay active.
void GridReader::read_leaf_bits(VdbBlock& block) {
    constexpr uint64_t kOriginBytes = 12;
    Mask active = read_mask(64 * block.active.size());
    if (type_->number == VdbNumber::kBool) {
        bytes_.take(kOriginBytes);
        const Mask values = read_mask(64 * block.active.size());
        for (size_t i = 0; i < block.active.size(); ++i) active.words[i] &= values.words[i];
    } else {
        bytes_.take(kOriginBytes);
    }
    std::copy(active.words.begin(), active.words.end(), block.active.begin());
    block.first = grid_.values.size();
    use_memory(2 * sizeof(float) * active.count());
    grid_.values.insert(grid_.values.end(), active.count(), 1.0f);
}

void GridReader::share_voxels(const VdbGrid& with) {
    use_memory(with.values.size() * sizeof(float) + with.blocks.size() * sizeof(VdbBlock) +
               with.tiles.size() * sizeof(VdbTile));
    grid_.blocks = with.blocks;
    grid_.tiles = with.tiles;
    grid_.values = with.values;
}

VdbGrid GridReader::read(const VdbType& type, bool halves, const VdbGrid* shared) {
    type_ = &type;
    grid_.type = type.name;
    grid_.channels = type.channels;
    halves_ = halves && type.is_real();
    packing_ = static_cast<uint32_t>(bytes_.number(4));
    read_metadata();
    read_map();
    if (shared) {
        share_voxels(*shared);
        return std::move(grid_);
    }
    read_root();
    for (VdbBlock& block : grid_.blocks) type.has_bits() ? read_leaf_bits(block) : read_leaf_values(block);
    return std::move(grid_);
}

struct Descriptor {
    std::string unique_name, type, instance_of;
    bool halves;
    uint64_t begin, end;  // in the file; 0: not known

    // Several grids of a name are told apart by a number behind a separator.
    std::string name() const { return unique_name.substr(0, unique_name.find('\x1e')); }
};

Descriptor read_descriptor(stream::ByteReader& bytes) {
    Descriptor descriptor{text(bytes), text(bytes), text(bytes), false, bytes.number(8), 0};
    bytes.number(8);  // where its values begin
    descriptor.end = bytes.number(8);
    std::string& type = descriptor.type;
    if (type.ends_with(kSavedAsHalf)) {
        descriptor.halves = true;
        type.resize(type.size() - std::string_view(kSavedAsHalf).size());
    }
    if (type.starts_with(kTypeBegin)) type.erase(0, std::string_view(kTypeBegin).size());
    if (type.ends_with(kTypeEnd)) type.resize(type.size() - std::string_view(kTypeEnd).size());
    return descriptor;
}

// The values of a grid, or UnreadGrid. `shared`: the grid whose voxels it has, or null.
VdbGrid read_grid(stream::ByteReader& bytes, const Descriptor& descriptor, uint64_t& memory, const VdbGrid* shared) {
    const VdbType* type = find_vdb_type(descriptor.type);
    if (!type) throw UnreadGrid("is of the type " + descriptor.type);
    const bool shares = !descriptor.instance_of.empty();
    if (shares && (!shared || !shared->unread.empty() || shared->type != descriptor.type))
        throw UnreadGrid("has the voxels of the grid " + descriptor.instance_of + ", which is not read");
    return GridReader(bytes, memory).read(*type, descriptor.halves, shares ? shared : nullptr);
}

VdbFile parse(std::span<const uint8_t> file, std::string& place) {
    stream::ByteReader bytes(file);
    if (bytes.number(8) != kMagic) throw std::runtime_error("is no OpenVDB file");
    const uint64_t version = bytes.number(4);
    if (version < kOldestVersion || version > kNewestVersion)
        throw std::runtime_error(fmt::format("has version {} of the format", version));
    bytes.take(8);  // the library's version
    const bool has_offsets = bytes.number(1) != 0;
    bytes.take(kUuidBytes);
    VdbFile read{read_metadata(bytes, "creator"), {}};
    const uint64_t count = bytes.number(4);
    if (count > kMostGrids) throw std::runtime_error("has too many grids");
    std::vector<std::string> names;  // with the numbers that tell several of a name apart
    uint64_t memory = available_memory_bytes() / 2;
    for (uint64_t i = 0; i < count; ++i) {
        place.clear();
        const Descriptor descriptor = read_descriptor(bytes);
        place = descriptor.name();
        const auto parent = std::find(names.begin(), names.end(), descriptor.instance_of);
        VdbGrid grid;
        try {
            grid =
                read_grid(bytes, descriptor, memory,
                          parent == names.end() ? nullptr : &read.grids[static_cast<size_t>(parent - names.begin())]);
        } catch (const UnreadGrid& error) {
            if (!has_offsets) throw;
            grid.type = descriptor.type;
            grid.unread = error.what();
            const auto here = static_cast<uint64_t>(bytes.take(0).data() - file.data());
            if (descriptor.end < here || descriptor.end > file.size()) throw std::runtime_error("ends at an odd place");
            bytes = stream::ByteReader(file.subspan(descriptor.end));
        }
        grid.name = place;
        read.grids.push_back(std::move(grid));
        names.push_back(descriptor.unique_name);
    }
    place.clear();
    return read;
}

}  // namespace

uint64_t VdbGrid::voxel_count() const {
    uint64_t count = 0;
    for (const VdbTile& tile : tiles)
        count += static_cast<uint64_t>(tile.edge) * static_cast<uint64_t>(tile.edge) * static_cast<uint64_t>(tile.edge);
    for (const VdbBlock& block : blocks)
        for (const uint64_t word : block.active) count += static_cast<uint64_t>(std::popcount(word));
    return count;
}

VdbFile parse_vdb(std::span<const uint8_t> bytes, const std::string& file) {
    std::string place;
    try {
        return parse(bytes, place);
    } catch (const std::runtime_error& error) {
        throw InputError(file, place, error.what(),
                         "write grids of numbers and of vectors of three by OpenVDB 3 or later");
    }
}

VdbFile read_vdb(const std::filesystem::path& file) {
    return parse_vdb(read_file(file, available_memory_bytes() / 2), file.string());
}

}  // namespace neuvv::interchange
