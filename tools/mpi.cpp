#include "tools/mpi.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <memory>

#include "base/error.h"

namespace neuvv::tools {

namespace {

// The library of Open MPI 3, 4 and 5, whose binary interface is known by this name: handles are addresses of objects.
constexpr const char* kLibrary = "libmpi.so.40";

// How many bytes of all ranks one call moves at most: MPI counts with int.
constexpr uint64_t kBytesAtOnce = uint64_t{1} << 30;

// The functions of <mpi.h> that gather uses.
struct Mpi {
    int (*init)(int*, char***) = nullptr;
    int (*finalize)() = nullptr;
    int (*comm_rank)(void*, int*) = nullptr;
    int (*comm_size)(void*, int*) = nullptr;
    int (*allgather)(const void*, int, void*, void*, int, void*, void*) = nullptr;
    int (*allgatherv)(const void*, int, void*, void*, const int*, const int*, void*, void*) = nullptr;
    void *world = nullptr, *byte = nullptr;
};

[[noreturn]] void throw_missing(const std::string& problem) {
    throw InputError(kLibrary, "", problem,
                     "install Open MPI on every machine, or train a clip in segments (--segment), which needs none");
}

template <typename Symbol>
void find(void* library, const char* name, Symbol& symbol) {
    void* found = dlsym(library, name);
    if (found == nullptr) throw_missing(fmt::format("has no {}", name));
    symbol = reinterpret_cast<Symbol>(found);
}

Mpi load_mpi() {
    // Open MPI's plug-ins look for its symbols among those of the whole process.
    void* library = dlopen(kLibrary, RTLD_NOW | RTLD_GLOBAL);
    if (library == nullptr) throw_missing("is not there");
    Mpi mpi;
    find(library, "MPI_Init", mpi.init);
    find(library, "MPI_Finalize", mpi.finalize);
    find(library, "MPI_Comm_rank", mpi.comm_rank);
    find(library, "MPI_Comm_size", mpi.comm_size);
    find(library, "MPI_Allgather", mpi.allgather);
    find(library, "MPI_Allgatherv", mpi.allgatherv);
    find(library, "ompi_mpi_comm_world", mpi.world);
    find(library, "ompi_mpi_byte", mpi.byte);
    return mpi;
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

  private:
    void gather_piece(std::span<const uint8_t> own, uint64_t begin, uint64_t piece,
                      std::vector<training::Bytes>& all) const;

    Mpi mpi_;
    int rank_ = 0, size_ = 1;
};

// Errors end all ranks by MPI's own handler, so that return values need no look.
std::vector<training::Bytes> World::gather(std::span<const uint8_t> own) const {
    const uint64_t own_bytes = own.size();
    std::vector<uint64_t> bytes(size());
    mpi_.allgather(&own_bytes, sizeof(own_bytes), mpi_.byte, bytes.data(), sizeof(own_bytes), mpi_.byte, mpi_.world);
    std::vector<training::Bytes> all(size());
    for (size_t i = 0; i < all.size(); i++) all[i].resize(bytes[i]);
    const uint64_t longest = *std::max_element(bytes.begin(), bytes.end()), piece = kBytesAtOnce / size();
    for (uint64_t begin = 0; begin < longest; begin += piece) gather_piece(own, begin, piece, all);
    return all;
}

// Gathers the bytes from `begin` on, at most `piece` of each rank.
void World::gather_piece(std::span<const uint8_t> own, uint64_t begin, uint64_t piece,
                         std::vector<training::Bytes>& all) const {
    const auto count_of = [&](uint64_t bytes) {
        return static_cast<int>(bytes > begin ? std::min(bytes - begin, piece) : 0);
    };
    std::vector<int> counts, places;
    int sum = 0;
    for (const training::Bytes& bytes : all) {
        counts.push_back(count_of(bytes.size()));
        places.push_back(sum);
        sum += counts.back();
    }
    training::Bytes received(static_cast<size_t>(sum));
    const int own_count = count_of(own.size());
    mpi_.allgatherv(own_count > 0 ? own.data() + begin : nullptr, own_count, mpi_.byte, received.data(), counts.data(),
                    places.data(), mpi_.byte, mpi_.world);
    for (size_t i = 0; i < all.size(); i++)
        std::copy_n(received.begin() + places[i], counts[i], all[i].begin() + static_cast<ptrdiff_t>(begin));
}

}  // namespace

training::Team join_team(const Ranks& ranks) {
    const auto world = std::make_shared<World>();
    if (world->rank() != ranks.rank || world->size() != ranks.count)
        throw InputError(kLibrary, "",
                         fmt::format("calls this process number {} of {}, the starter {} of {}", world->rank() + 1,
                                     world->size(), ranks.rank + 1, ranks.count),
                         "start the program by the mpirun of the Open MPI that it loads; with srun, by --mpi=pmix");
    return {ranks.rank, ranks.count, [world](std::span<const uint8_t> own) { return world->gather(own); }};
}

}  // namespace neuvv::tools
