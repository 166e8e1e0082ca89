// OpenVDB files that OpenVDB itself writes, and damaged ones, read by our own reader.
#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/PointDataGrid.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>

#include "base/error.h"
#include "base/platform.h"
#include "fuzz/mutate.h"
#include "interchange/volume/vdb_volume.h"
#include "media/image.h"
#include "support/look_at.h"
#include "support/random_tree.h"
#include "support/temporary_folder.h"

namespace neuvv::test {
namespace {

using interchange::VdbGrid;

template <typename Grid, typename Make>
typename Grid::Ptr random_grid(const char* name, uint64_t seed, const Make& make) {
    auto grid = Grid::create();
    grid->setName(name);
    Random random(seed);
    for (int i = 0; i < 3000; ++i) {
        const auto coordinate = [&] { return static_cast<int>(random.below(200)) - 100; };
        const openvdb::Coord at(coordinate(), coordinate(), coordinate());
        if (i % 3 == 0)
            grid->tree().setValueOff(at, make(random));  // inactive ones of other values than the background
        if (i % 3 == 1) grid->tree().setValue(at, make(random));
        if (i % 3 == 2 && i % 10 == 0) grid->tree().setValue(at, make(random));
    }
    grid->tree().addTile(1, openvdb::Coord(400, 0, -80), make(random), true);
    grid->tree().addTile(2, openvdb::Coord(512, 128, 0), make(random), true);
    grid->tree().addTile(3, openvdb::Coord(4096, 0, 0), make(random), true);
    grid->tree().addTile(1, openvdb::Coord(408, 0, 0), make(random), false);
    return grid;
}

openvdb::FloatGrid::Ptr random_floats(const char* name, uint64_t seed) {
    return random_grid<openvdb::FloatGrid>(name, seed,
                                           [](Random& random) { return static_cast<float>(0.5 + random.uniform()); });
}

openvdb::Vec3SGrid::Ptr random_vectors(const char* name, uint64_t seed) {
    return random_grid<openvdb::Vec3SGrid>(name, seed, [](Random& random) {
        const auto number = [&] { return static_cast<float>(random.uniform()); };
        return openvdb::Vec3s(number(), number(), number());
    });
}

// All active values, as the library and as our reader see them.
template <typename Grid>
void expect_same(const Grid& truth, const VdbGrid& grid, double tolerance) {
    EXPECT_EQ(grid.name, truth.getName());
    using Value = typename Grid::ValueType;
    constexpr uint32_t kChannels = openvdb::VecTraits<Value>::IsVec ? 3 : 1;
    ASSERT_EQ(grid.channels, kChannels);
    interchange::VdbLookup lookup(grid);
    uint64_t voxels = 0;
    for (const interchange::VdbTile& tile : grid.tiles) voxels += static_cast<uint64_t>(std::pow(tile.edge, 3));
    for (const interchange::VdbBlock& block : grid.blocks)
        for (const uint64_t word : block.active) voxels += static_cast<uint64_t>(std::popcount(word));
    EXPECT_EQ(voxels, truth.activeVoxelCount());
    for (auto value = truth.cbeginValueOn(); value; ++value) {
        const openvdb::CoordBBox box = value.getBoundingBox();
        for (const openvdb::Coord& at : {box.min(), box.max()}) {
            const float* found = lookup.at({at.x(), at.y(), at.z()});
            ASSERT_TRUE(found);
            const Value expected = *value;
            if constexpr (openvdb::VecTraits<Value>::IsVec) {
                for (int c = 0; c < 3; ++c) EXPECT_NEAR(double{found[c]}, static_cast<double>(expected[c]), tolerance);
            } else {
                EXPECT_NEAR(double{found[0]}, static_cast<double>(expected), tolerance);
            }
        }
    }
    const openvdb::Coord off(408, 0, 0);
    EXPECT_FALSE(lookup.at({off.x(), off.y(), off.z()}));
    for (int i = 0; i < 10; ++i) {
        const glm::dvec3 index(i * i, 3 - i, 5 * i);
        const openvdb::Vec3d world = truth.indexToWorld(openvdb::Vec3d(index.x, index.y, index.z));
        const glm::dvec3 ours(grid.world_from_index * glm::dvec4(index, 1));
        EXPECT_LT(glm::distance(ours, {world.x(), world.y(), world.z()}), 1e-9);
    }
}

void write_grids(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids, uint32_t compression) {
    openvdb::initialize();
    openvdb::io::File file(path.string());
    file.setCompression(compression);
    file.write(grids);
}

TEST(VdbReader, ReadsWhatOpenVdbWrites) {
    using namespace openvdb;
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.path / "x.vdb";
    for (const uint32_t compression : {0u, 1u, 2u, 3u, 4u, 6u})
        for (const bool halves : {false, true})
            for (const GridClass grid_class : {GRID_UNKNOWN, GRID_FOG_VOLUME}) {
                const FloatGrid::Ptr floats = random_floats("density", compression);
                const Vec3SGrid::Ptr vectors = random_vectors("Cd", compression);
                floats->setGridClass(grid_class);
                floats->setSaveFloatAsHalf(halves);
                vectors->setSaveFloatAsHalf(halves);
                write_grids(path, {floats, vectors}, compression);
                const std::vector<VdbGrid> grids = interchange::read_vdb(path).grids;
                ASSERT_EQ(grids.size(), 2u);
                EXPECT_EQ(grids[0].grid_class, grid_class == GRID_FOG_VOLUME ? "fog volume" : "unknown");
                expect_same(*floats, grids[0], halves ? 1e-3 : 0);
                expect_same(*vectors, grids[1], halves ? 1e-3 : 0);
            }
}

TEST(VdbReader, ReadsAllAffineTransforms) {
    using namespace openvdb;
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.path / "x.vdb";
    const auto turned = std::make_shared<math::UnitaryMap>(Vec3d(0, 1, 0), 0.3);
    const std::vector<math::MapBase::Ptr> maps = {
        std::make_shared<math::UniformScaleMap>(0.1),
        std::make_shared<math::ScaleMap>(Vec3d(0.1, 0.2, 0.3)),
        std::make_shared<math::TranslationMap>(Vec3d(1, 2, 3)),
        std::make_shared<math::UniformScaleTranslateMap>(0.1, Vec3d(1, 2, 3)),
        std::make_shared<math::ScaleTranslateMap>(Vec3d(0.1, 0.2, 0.3), Vec3d(1, 2, 3)),
        turned,
        std::make_shared<math::AffineMap>(
            math::Mat4d(0., 0.1, 0., 0., -0.2, 0., 0., 0., 0., 0., 0.3, 0., 7., 8., 9., 1.)),
    };
    for (const math::MapBase::Ptr& map : maps) {
        const FloatGrid::Ptr floats = random_floats("density", 1);
        floats->setTransform(std::make_shared<math::Transform>(map));
        write_grids(path, {floats}, 4);
        const std::vector<VdbGrid> grids = interchange::read_vdb(path).grids;
        ASSERT_EQ(grids.size(), 1u);
        expect_same(*floats, grids[0], 0);
    }
    EXPECT_NO_THROW(read_volume(path, glm::dmat4(1)));
    const FloatGrid::Ptr floats = random_floats("density", 1);
    floats->setTransform(std::make_shared<math::Transform>(turned));
    write_grids(path, {floats}, 4);
    EXPECT_THROW(read_volume(path, glm::dmat4(1)), InputError) << "its voxels are turned";
}

// Grids of one type, whole and as halves, in all packings.
template <typename Grid, typename Make>
void expect_type(const char* type, double tolerance_of_halves, const Make& make) {
    openvdb::initialize();
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.path / "x.vdb";
    for (const uint32_t compression : {0u, 2u, 3u, 6u})
        for (const bool halves : {false, true}) {
            const auto truth = random_grid<Grid>("density", compression + 1, make);
            truth->setSaveFloatAsHalf(halves);
            write_grids(path, {truth, random_floats("heat", 2)}, compression);
            const std::vector<VdbGrid> grids = interchange::read_vdb(path).grids;
            ASSERT_EQ(grids.size(), 2u);
            EXPECT_EQ(grids[0].type, type);
            EXPECT_EQ(grids[0].unread, "");
            expect_same(*truth, grids[0], halves ? tolerance_of_halves : 1e-6);
        }
}

TEST(VdbReader, ReadsNumbersOfAllTypes) {
    using namespace openvdb;
    expect_type<DoubleGrid>("double", 1e-3, [](Random& random) { return 0.5 + random.uniform(); });
    expect_type<Int32Grid>("int32", 0, [](Random& random) { return static_cast<int>(random.below(1000)) - 200; });
    expect_type<Int64Grid>("int64", 0, [](Random& random) { return static_cast<int64_t>(random.below(1000)) - 200; });
    const auto vector = [](Random& random) { return Vec3d(random.uniform(), random.uniform(), random.uniform()); };
    expect_type<Vec3DGrid>("vec3d", 1e-3, vector);
    expect_type<Vec3IGrid>("vec3i", 0, [&](Random& random) { return Vec3i(100.0 * vector(random)); });
}

// What is active and true is 1; other voxels are not there.
TEST(VdbReader, ReadsBoolsAndMasks) {
    using namespace openvdb;
    initialize();
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.path / "x.vdb";
    for (const uint32_t compression : {0u, 2u, 6u}) {
        const BoolGrid::Ptr bools = BoolGrid::create(false);
        const MaskGrid::Ptr masks = MaskGrid::create();
        bools->setName("density");
        masks->setName("matte");
        Random random(compression);
        uint64_t voxels = 512;
        for (int i = 0; i < 2000; ++i) {
            const Coord at(static_cast<int>(random.below(60)), static_cast<int>(random.below(60)), i);
            bools->tree().setValue(at, i % 3 != 0);
            if (i % 7 == 0) bools->tree().setValueOff(at, true);
            voxels += i % 3 != 0 && i % 7 != 0 ? 1 : 0;
            masks->tree().setValue(at, true);
        }
        bools->tree().addTile(1, Coord(400, 0, -80), true, true);
        masks->tree().addTile(2, Coord(512, 128, 0), true, true);
        write_grids(path, {bools, masks, random_floats("heat", 2)}, compression);
        const std::vector<VdbGrid> grids = interchange::read_vdb(path).grids;
        ASSERT_EQ(grids.size(), 3u);
        EXPECT_EQ(grids[0].voxel_count(), voxels);
        interchange::VdbLookup lookup(grids[0]);
        for (auto value = bools->cbeginValueOn(); value; ++value) {
            const Coord at = value.getBoundingBox().min();
            const float* found = lookup.at({at.x(), at.y(), at.z()});
            EXPECT_EQ(found != nullptr && *found == 1.0f, *value);
        }
        expect_same(*masks, grids[1], 0);
        expect_same(*random_floats("heat", 2), grids[2], 0);
    }
}

// The library stores the tiles of a mask that has another grid's topology as active and false.
TEST(VdbReader, TilesOfAMaskAreSetWhereTheyAreActive) {
    using namespace openvdb;
    const TemporaryFolder folder;
    const FloatGrid::Ptr floats = random_floats("density", 1);
    const MaskGrid::Ptr mask =
        MaskGrid::create(std::make_shared<MaskGrid::TreeType>(floats->tree(), /*background=*/false, TopologyCopy()));
    mask->setName("matte");
    write_grids(folder.path / "x.vdb", {mask}, 0);
    const std::vector<VdbGrid> grids = interchange::read_vdb(folder.path / "x.vdb").grids;
    ASSERT_EQ(grids.size(), 1u);
    ASSERT_EQ(grids[0].tiles.size(), 3u);
    EXPECT_EQ(std::ranges::count(grids[0].values, 1.0f), static_cast<ptrdiff_t>(grids[0].values.size()));
}

TEST(VdbReader, CutsWhatIsInfinite) {
    openvdb::initialize();
    const TemporaryFolder folder;
    const auto doubles = openvdb::DoubleGrid::create();
    doubles->setName("density");
    doubles->tree().setValue({0, 0, 0}, 1e300);
    doubles->tree().setValue({0, 0, 1}, std::numeric_limits<double>::infinity());
    doubles->tree().setValue({0, 0, 2}, std::numeric_limits<double>::quiet_NaN());
    write_grids(folder.path / "x.vdb", {doubles}, 0);
    const std::vector<VdbGrid> grids = interchange::read_vdb(folder.path / "x.vdb").grids;
    EXPECT_EQ(grids.at(0).values, (std::vector<float>{interchange::kMostVdbValue, interchange::kMostVdbValue, 0}));
}

// A type that is not read.
openvdb::GridBase::Ptr grid_of_pairs() {
    using Pairs = openvdb::Grid<openvdb::tree::Tree4<openvdb::Vec2s, 5, 4, 3>::Type>;
    openvdb::initialize();
    if (!Pairs::isRegistered()) Pairs::registerGrid();
    const Pairs::Ptr pairs = Pairs::create();
    pairs->setName("uv");
    pairs->tree().setValue({1, 2, 3}, openvdb::Vec2s(1, 2));
    return pairs;
}

TEST(VdbReader, NamesGridsOfOtherTypes) {
    const TemporaryFolder folder;
    const openvdb::FloatGrid::Ptr floats = random_floats("density", 1);
    write_grids(folder.path / "x.vdb", {grid_of_pairs(), floats}, 4);
    const std::vector<VdbGrid> grids = interchange::read_vdb(folder.path / "x.vdb").grids;
    ASSERT_EQ(grids.size(), 2u);
    EXPECT_EQ(grids[0].name, "uv");
    EXPECT_EQ(grids[0].unread, "is of the type vec2s");
    expect_same(*floats, grids[1], 0);
}

TEST(VdbReader, ReadsGridsThatShareVoxels) {
    using namespace openvdb;
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.path / "x.vdb";
    initialize();
    const FloatGrid::Ptr floats = random_floats("density", 1), shared = floats->copy(), last = random_floats("heat", 2);
    shared->setName("shared");
    shared->setTransform(math::Transform::createLinearTransform(0.3));
    write_grids(path, {floats, shared, last}, 4);
    const std::vector<VdbGrid> grids = interchange::read_vdb(path).grids;
    ASSERT_EQ(grids.size(), 3u);
    expect_same(*floats, grids[0], 0);
    expect_same(*shared, grids[1], 0);
    expect_same(*last, grids[2], 0);
}

TEST(VdbReader, KnowsWhoWrote) {
    const TemporaryFolder folder;
    openvdb::initialize();
    openvdb::MetaMap metadata;
    metadata.insertMeta("creator", openvdb::StringMetadata("Blender/OpenVDBWriter"));
    openvdb::io::File file((folder.path / "x.vdb").string());
    file.write(openvdb::GridCPtrVec{random_floats("density", 1)}, metadata);
    file.close();
    EXPECT_EQ(interchange::read_vdb(folder.path / "x.vdb").creator, "Blender/OpenVDBWriter");
}

std::string error_of(const std::function<void()>& run) {
    try {
        run();
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(VdbReader, RefusesDamagedFiles) {
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.path / "x.vdb", damaged = folder.path / "y.vdb";
    std::vector<std::string> files;
    for (const uint32_t compression : {0u, 1u, 6u}) {
        const auto floats = openvdb::FloatGrid::create();
        floats->setName("density");
        floats->tree().setValue({1, 2, 3}, 4);
        floats->tree().addTile(1, {16, 0, 0}, 2, true);
        const auto vectors = openvdb::Vec3SGrid::create();
        vectors->setName("Cd");
        vectors->tree().setValue({1, 2, 3}, openvdb::Vec3s(1, 0, 1));
        write_grids(path, {floats, vectors}, compression);
        const std::vector<uint8_t> bytes = read_file(path);
        files.emplace_back(bytes.begin(), bytes.end());
    }
    fuzz::Random random(1);
    size_t refused = 0, read = 0;
    for (int i = 0; i < 1500; ++i) {
        const std::string& sound = files[random() % files.size()];
        const std::string bytes =
            i < 300 ? sound.substr(0, random() % sound.size()) : fuzz::mutate(sound, files, size_t{1} << 20, random);
        std::ofstream(damaged, std::ios::binary) << bytes;
        const std::string error = error_of([&] {
            const interchange::VdbVolume volume =
                interchange::volume_of(interchange::read_vdb(damaged).grids, damaged.string(), glm::dmat4(1));
            for (const float value : volume.density.values) ASSERT_TRUE(std::isfinite(value));
            const voctree::VOctree tree =
                interchange::tree_of(volume, interchange::doublings_for(volume, 64).value_or(0), 25);
            EXPECT_EQ(voctree::defect_of(tree), "");
            ++read;
        });
        if (error.empty()) continue;
        ++refused;
        EXPECT_TRUE(error.starts_with(damaged.string()) && error.find('\n') == std::string::npos) << error;
    }
    EXPECT_GT(refused, 500u);
    EXPECT_GT(read, 50u);
}

// Puts bytes in the place of those that are there.
void overwrite(std::vector<uint8_t>& bytes, size_t at, const void* from, size_t size) {
    std::memcpy(&bytes.at(at + size - 1) - (size - 1), from, size);
}

size_t place_of(const std::vector<uint8_t>& bytes, const std::string& text) {
    return static_cast<size_t>(std::search(bytes.begin(), bytes.end(), text.begin(), text.end()) - bytes.begin());
}

TEST(VdbReader, RefusesGridsThatEndBeforeTheyBegin) {
    const TemporaryFolder folder;
    write_grids(folder.path / "x.vdb", {grid_of_pairs(), random_floats("density", 1)}, 0);
    std::vector<uint8_t> bytes = read_file(folder.path / "x.vdb");
    EXPECT_EQ(interchange::parse_vdb(bytes, "x.vdb").grids.size(), 2u);
    // Behind the type: the name of the grid that it shares voxels with, which is empty, and three places.
    const std::string type = "Tree_vec2s_5_4_3";
    const size_t end = place_of(bytes, type) + type.size() + 4 + 2 * sizeof(uint64_t);
    for (const uint64_t odd : {uint64_t{0}, uint64_t{60}, uint64_t{bytes.size() + 1}, UINT64_MAX}) {
        overwrite(bytes, end, &odd, sizeof(odd));
        EXPECT_NE(error_of([&] { interchange::parse_vdb(bytes, "x.vdb"); }).find("ends at an odd place"),
                  std::string::npos);
    }
}

// A grid of so many voxels in a row.
template <typename Grid>
typename Grid::Ptr row_of(const char* name, int voxels, const typename Grid::ValueType& value,
                          openvdb::GridClass grid_class = openvdb::GRID_FOG_VOLUME) {
    openvdb::initialize();
    const auto grid = Grid::create();
    grid->setName(name);
    grid->setGridClass(grid_class);
    for (int i = 0; i < voxels; ++i) grid->tree().setValue({i, 0, 0}, value);
    return grid;
}

interchange::VdbVolume volume_of_grids(const openvdb::GridCPtrVec& grids) {
    const TemporaryFolder folder;
    write_grids(folder.path / "x.vdb", grids, 4);
    return interchange::volume_of(interchange::read_vdb(folder.path / "x.vdb").grids, "x.vdb", glm::dmat4(1));
}

TEST(VdbVolume, SaysWhichOfSeveralGridsItShows) {
    using namespace openvdb;
    const auto heat = row_of<FloatGrid>("heat", 7, 1);
    const interchange::VdbVolume twice =
        volume_of_grids({heat, row_of<DoubleGrid>("density", 3, 2), row_of<FloatGrid>("Density", 4, 5),
                         row_of<Vec3SGrid>("v", 1, Vec3s(1))});
    EXPECT_EQ(twice.density.voxel_count(), 3u);
    EXPECT_EQ(twice.density.value(0)[0], 2);
    const std::vector<std::string> notes = {
        "has 2 grids named density, of which the first is shown: density (double, 3 voxels)",
        "does not show heat (float, 7 voxels), Density (float, 4 voxels), v (vec3s, 1 voxels)"};
    EXPECT_EQ(twice.notes, notes);
    const interchange::VdbVolume colours =
        volume_of_grids({row_of<FloatGrid>("density", 3, 2), row_of<Vec3DGrid>("Cd", 3, Vec3d(1, 0, 0)),
                         row_of<Vec3SGrid>("Cd", 5, Vec3s(1))});
    ASSERT_TRUE(colours.colour);
    EXPECT_EQ(colours.colour->type, "vec3d");
    EXPECT_NE(colours.notes.at(0).find("2 grids named Cd"), std::string::npos);
    EXPECT_EQ(volume_of_grids({row_of<FloatGrid>("density", 3, 2)}).notes, std::vector<std::string>{});
    EXPECT_NE(volume_of_grids({heat}).notes.at(0).find("its only one of numbers is shown: heat"), std::string::npos);
    EXPECT_NE(volume_of_grids({row_of<BoolGrid>("density", 3, true)}).notes.at(0).find("density of 1"),
              std::string::npos);
}

// What is named density is not replaced by another grid.
TEST(VdbVolume, NamesGridsThatItCannotShow) {
    using namespace openvdb;
    const auto heat = row_of<FloatGrid>("heat", 7, 1);
    const auto error = [&](const GridCPtrVec& grids) { return error_of([&] { volume_of_grids(grids); }); };
    EXPECT_NE(error({heat, row_of<Vec3SGrid>("density", 2, Vec3s(1))}).find("density (vec3s, 2 voxels)"),
              std::string::npos);
    EXPECT_NE(
        error({heat, row_of<FloatGrid>("density", 2, 1, GRID_LEVEL_SET)}).find("density (float, level set, 2 voxels)"),
        std::string::npos);
    EXPECT_NE(
        error({heat, row_of<Int32Grid>("fuel", 2, 1)}).find("it has heat (float, 7 voxels), fuel (int32, 2 voxels)"),
        std::string::npos);
}

// Without a colour it is white, and can be seen on black.
TEST(VdbVolume, DrawsOnAnyBackground) {
    const interchange::VdbVolume volume = volume_of_grids({row_of<openvdb::FloatGrid>("density", 1, 1000)});
    const stage::Camera camera = look_at({0, 0, 40}, {0, 0, 0}, 33, 33, 4);
    EXPECT_EQ(interchange::vdb_image(volume, camera, [] {}).at(16, 16)[0], 255);
    const media::Image image = interchange::vdb_image(
        volume, camera, [] {}, glm::vec3(0));
    EXPECT_GT(image.at(16, 16)[0], 250);
    EXPECT_EQ(image.at(1, 1)[0], 0);
}

TEST(VdbVolume, DimsAndColoursItsImage) {
    openvdb::initialize();
    const auto density = openvdb::FloatGrid::create();
    const auto colour = openvdb::Vec3SGrid::create();
    density->setName("density");
    colour->setName("Cd");
    const openvdb::CoordBBox box(openvdb::Coord(-10), openvdb::Coord(9));
    density->fill(box, 1.5f);
    colour->fill(box, openvdb::Vec3s(0.8f, 0.2f, 0));
    for (const openvdb::GridBase::Ptr& grid : {openvdb::GridBase::Ptr(density), openvdb::GridBase::Ptr(colour)})
        grid->setTransform(openvdb::math::Transform::createLinearTransform(0.05));
    const TemporaryFolder folder;
    write_grids(folder.path / "x.vdb", {density, colour}, 4);
    // The file's unit is two metres.
    const glm::dmat4 world_from_file = glm::dmat4(glm::dmat3(2.0));
    const interchange::VdbVolume volume =
        interchange::volume_of(interchange::read_vdb(folder.path / "x.vdb").grids, "x.vdb", world_from_file);
    const media::Image image =
        interchange::vdb_image(volume, look_at({-0.05, -0.05, 40}, {-0.05, -0.05, 0}, 33, 33, 4), [] {});
    const double left = std::exp(-1.5);  // along one unit
    const double shown[] = {0.8 * (1 - left) + left, 0.2 * (1 - left) + left, left};
    for (uint32_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(image.at(16, 16)[c], 255 * media::srgb_from_linear(shown[c]), 1.5);
        EXPECT_EQ(image.at(1, 1)[c], 255);
    }
}

}  // namespace
}  // namespace neuvv::test
