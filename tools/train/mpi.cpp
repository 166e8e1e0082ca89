#include "tools/train/mpi.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <exception>
#include <memory>

#include "base/error.h"
#include "base/platform.h"

namespace neuvv::tools {

namespace {

// The library of Open MPI 3, 4 and 5, whose binary interface is known by this name: handles are addresses of objects.
constexpr const char* kLibrary = "libmpi.so.40";

// How many bytes of all ranks one call moves at most: MPI counts with int.
constexpr uint64_t kBytesAtOnce = uint64_t{1} << 30;

// The functions of <mpi.h> that a team uses.
struct Mpi {
    int (*init)(int*, char***) = nullptr;
    int (*finalize)() = nullptr;
    int (*comm_rank)(void*, int*) = nullptr;
    int (*comm_size)(void*, int*) = nullptr;
    int (*allgather)(const void*, int, void*, void*, int, void*, void*) = nullptr;
    int (*allgatherv)(const void*, int, void*, void*, const int*, const int*, void*, void*) = nullptr;
    int (*alltoallv)(const void*, const int*, const int*, void*, void*, const int*, const int*, void*, void*) = nullptr;
    void *world = nullptr, *byte = nullptr;
};

[[noreturn]] void throw_missing(const std::string& problem) {
    throw InputError(kLibrary, "", problem,
                     "install Open MPI on every machine, or train a clip in segments (--segment), which needs none");
}

template <typename Symbol>
void find(void* library, const char* name, Symbol& symbol) {
    void* found = symbol_of(library, name);
    if (found == nullptr) throw_missing(fmt::format("has no {}", name));
    symbol = reinterpret_cast<Symbol>(found);
}

Mpi load_mpi() {
    void* library = load_library(kLibrary);
    if (library == nullptr) throw_missing("is not there");
    Mpi mpi;
    find(library, "MPI_Init", mpi.init);
    find(library, "MPI_Finalize", mpi.finalize);
    find(library, "MPI_Comm_rank", mpi.comm_rank);
    find(library, "MPI_Comm_size", mpi.comm_size);
    find(library, "MPI_Allgather", mpi.allgather);
    find(library, "MPI_Allgatherv", mpi.allgatherv);
    find(library, "MPI_Alltoallv", mpi.alltoallv);
    find(library, "ompi_mpi_comm_world", mpi.world);
    find(library, "ompi_mpi_byte", mpi.byte);
    return mpi;
}

// What one call moves of several messages: of each, some bytes, which stand behind each other in one buffer.
struct Pieces {
    Pieces(const std::vector<uint64_t>& bytes, uint64_t begin, uint64_t piece) {
        for (const uint64_t all : bytes) {
            counts.push_back(static_cast<int>(all > begin ? std::min(all - begin, piece) : 0));
            places.push_back(sum);
            sum += counts.back();
        }
    }
    std::vector<int> counts, places;
    int sum = 0;
};

std::vector<uint64_t> sizes_of(const std::vector<training::Bytes>& messages) {
    std::vector<uint64_t> sizes;
    for (const training::Bytes& bytes : messages) sizes.push_back(bytes.size());
    return sizes;
}

void put_pieces(const training::Bytes& buffer, const Pieces& pieces, uint64_t begin,
                std::vector<training::Bytes>& messages) {
    for (size_t i = 0; i < messages.size(); ++i)
        if (pieces.counts[i] > 0)
            std::copy_n(buffer.begin() + pieces.places[i], pieces.counts[i],
                        messages[i].begin() + static_cast<ptrdiff_t>(begin));
}

class World {
  public:
    World() : mpi_(load_mpi()) {
        mpi_.init(nullptr, nullptr);
        mpi_.comm_rank(mpi_.world, &rank_);
        mpi_.comm_size(mpi_.world, &size_);
    }
    // MPI_Finalize waits for all ranks, so one that fails leaves without it, and mpirun then ends the others.
    ~World() {
        if (std::uncaught_exceptions() == 0) mpi_.finalize();
    }
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    uint32_t rank() const { return static_cast<uint32_t>(rank_); }
    uint32_t size() const { return static_cast<uint32_t>(size_); }
    std::vector<training::Bytes> gather(std::span<const uint8_t> own) const;
    std::vector<training::Bytes> exchange(const std::vector<training::Bytes>& to) const;

  private:
    void gather_piece(std::span<const uint8_t> own, uint64_t begin, uint64_t piece,
                      std::vector<training::Bytes>& all) const;
    void exchange_piece(const std::vector<training::Bytes>& to, uint64_t begin, uint64_t piece,
                        std::vector<training::Bytes>& from) const;

    Mpi mpi_;
    int rank_ = 0, size_ = 1;
};

// Errors end all ranks by MPI's own handler, so that return values need no look.
std::vector<training::Bytes> World::gather(std::span<const uint8_t> own) const {
    const uint64_t own_bytes = own.size();
    std::vector<uint64_t> bytes(size());
    mpi_.allgather(&own_bytes, sizeof(own_bytes), mpi_.byte, bytes.data(), sizeof(own_bytes), mpi_.byte, mpi_.world);
    std::vector<training::Bytes> all(size());
    for (size_t i = 0; i < all.size(); ++i) all[i].resize(bytes[i]);
    const uint64_t longest = *std::max_element(bytes.begin(), bytes.end()), piece = kBytesAtOnce / size();
    for (uint64_t begin = 0; begin < longest; begin += piece) gather_piece(own, begin, piece, all);
    return all;
}

// Gathers the bytes from `begin` on, at most `piece` of each rank.
void World::gather_piece(std::span<const uint8_t> own, uint64_t begin, uint64_t piece,
                         std::vector<training::Bytes>& all) const {
    const Pieces pieces(sizes_of(all), begin, piece);
    training::Bytes received(static_cast<size_t>(pieces.sum));
    const int own_count = pieces.counts[rank()];
    mpi_.allgatherv(own_count > 0 ? own.data() + begin : nullptr, own_count, mpi_.byte, received.data(),
                    pieces.counts.data(), pieces.places.data(), mpi_.byte, mpi_.world);
    put_pieces(received, pieces, begin, all);
}

std::vector<training::Bytes> World::exchange(const std::vector<training::Bytes>& to) const {
    // By sender and receiver: every rank must know the longest message, which says how many calls there are.
    assert(to.size() == size());
    const std::vector<uint64_t> own = sizes_of(to);
    std::vector<uint64_t> sizes(size_t{size()} * size());
    const int row = static_cast<int>(sizeof(uint64_t)) * size_;
    mpi_.allgather(own.data(), row, mpi_.byte, sizes.data(), row, mpi_.byte, mpi_.world);
    std::vector<training::Bytes> from(size());
    for (size_t i = 0; i < from.size(); ++i) from[i].resize(sizes[i * size() + rank()]);
    const uint64_t longest = *std::max_element(sizes.begin(), sizes.end()), piece = kBytesAtOnce / size();
    for (uint64_t begin = 0; begin < longest; begin += piece) exchange_piece(to, begin, piece, from);
    return from;
}

// Exchanges the bytes from `begin` on, at most `piece` of each message.
void World::exchange_piece(const std::vector<training::Bytes>& to, uint64_t begin, uint64_t piece,
                           std::vector<training::Bytes>& from) const {
    const Pieces sent(sizes_of(to), begin, piece), received(sizes_of(from), begin, piece);
    training::Bytes out(static_cast<size_t>(sent.sum)), in(static_cast<size_t>(received.sum));
    for (size_t i = 0; i < to.size(); ++i)
        if (sent.counts[i] > 0)
            std::copy_n(to[i].begin() + static_cast<ptrdiff_t>(begin), sent.counts[i], out.begin() + sent.places[i]);
    mpi_.alltoallv(out.data(), sent.counts.data(), sent.places.data(), mpi_.byte, in.data(), received.counts.data(),
                   received.places.data(), mpi_.byte, mpi_.world);
    put_pieces(in, received, begin, from);
}

}  // namespace

training::Team join_team(const Ranks& ranks) {
    const auto world = std::make_shared<World>();
    if (world->rank() != ranks.rank || world->size() != ranks.count)
        throw InputError(kLibrary, "",
                         fmt::format("calls this process number {} of {}, the starter {} of {}", world->rank() + 1,
                                     world->size(), ranks.rank + 1, ranks.count),
                         "start the program by the mpirun of the Open MPI that it loads; with srun, by --mpi=pmix");
    return {ranks.rank, ranks.count, [world](std::span<const uint8_t> own) { return world->gather(own); },
            [world](const std::vector<training::Bytes>& to) { return world->exchange(to); }};
}

}  // namespace neuvv::tools
