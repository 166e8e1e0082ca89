// Splats of other programs: read, turned, drawn, and made into cells.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <initializer_list>
#include <limits>
#include <tuple>

#include "base/error.h"
#include "fuzz/mutate.h"
#include "interchange/splats/splat_image.h"
#include "interchange/splats/splat_ply.h"
#include "interchange/splats/voxelise.h"
#include "reference/splats.h"
#include "support/look_at.h"
#include "support/random_tree.h"
#include "support/temporary_folder.h"
#include "voctree/tree_slice.h"

namespace neuvv::test {
namespace {

using interchange::Splat;
using interchange::Splats;

// Splats of all forms around the origin.
Splats some_splats(uint32_t degree, size_t count) {
    Random random(7);
    Splats splats{degree, {}};
    for (size_t i = 0; i < count; ++i) {
        Splat splat;
        splat.centre = 0.4f * glm::vec3(random.bell(), random.bell(), random.bell());
        splat.rotation =
            glm::normalize(glm::quat(static_cast<float>(random.bell()), static_cast<float>(random.bell()),
                                     static_cast<float>(random.bell()), static_cast<float>(random.bell())));
        for (int a = 0; a < 3; ++a) splat.deviation[a] = static_cast<float>(std::exp(-3.5 + 0.7 * random.bell()));
        splat.opacity = static_cast<float>(random.uniform(0.1, 0.9));
        for (uint32_t k = 0; k < sh_count(degree); ++k)
            for (int c = 0; c < 3; ++c) splat.colour[k][c] = static_cast<float>((k == 0 ? 0.5 : 0.1) * random.bell());
        splats.splats.push_back(splat);
    }
    return splats;
}

// A .ply as a program would write it that has other columns, and doubles among them.
void write_other_ply(const std::filesystem::path& path, const Splats& splats) {
    std::ofstream file(path, std::ios::binary);
    file << "ply\nformat binary_little_endian 1.0\ncomment by another program\nelement camera 2\nproperty uchar id\n"
         << "element vertex " << splats.splats.size() << "\nproperty uchar red\n";
    for (const char* name : {"rot_0", "rot_1", "rot_2", "rot_3", "opacity", "f_dc_0", "f_dc_1", "f_dc_2", "scale_0",
                             "scale_1", "scale_2", "z", "y", "x"})
        file << "property double " << name << "\n";
    file << "end_header\n__";
    for (const Splat& s : splats.splats) {
        file.put('r');
        for (const float value : {2 * s.rotation.w, 2 * s.rotation.x, 2 * s.rotation.y, 2 * s.rotation.z,
                                  std::log(s.opacity / (1 - s.opacity)), s.colour[0].r, s.colour[0].g, s.colour[0].b,
                                  std::log(s.deviation.x), std::log(s.deviation.y), std::log(s.deviation.z), s.centre.z,
                                  s.centre.y, s.centre.x}) {
            const double number = value;
            file.write(reinterpret_cast<const char*>(&number), sizeof(number));
        }
    }
}

void expect_same(const Splats& read, const Splats& truth) {
    ASSERT_EQ(read.splats.size(), truth.splats.size());
    EXPECT_EQ(read.degree, truth.degree);
    for (size_t i = 0; i < read.splats.size(); ++i) {
        const Splat &a = read.splats[i], &b = truth.splats[i];
        EXPECT_LT(glm::distance(a.centre, b.centre), 1e-6f);
        EXPECT_LT(glm::distance(a.deviation, b.deviation), 1e-6f);
        EXPECT_NEAR(std::abs(glm::dot(a.rotation, b.rotation)), 1, 1e-5);
        EXPECT_NEAR(a.opacity, b.opacity, 1e-5);
        for (uint32_t k = 0; k < kMaxShCount; ++k) EXPECT_LT(glm::distance(a.colour[k], b.colour[k]), 1e-6f);
    }
}

TEST(SplatReader, ReadsWhatWeAndOthersWrite) {
    const TemporaryFolder folder;
    for (const uint32_t degree : {0u, 1u, 2u, 3u}) {
        const Splats splats = some_splats(degree, 50);
        interchange::write_splat_ply(folder.path / "x.ply", splats);
        expect_same(interchange::read_splat_ply(folder.path / "x.ply").splats, splats);
    }
    const Splats splats = some_splats(0, 50);
    write_other_ply(folder.path / "y.ply", splats);
    expect_same(interchange::read_splat_ply(folder.path / "y.ply").splats, splats);
    const Splats doubled = interchange::read_splat_ply(folder.path / "y.ply", 2).splats;
    EXPECT_LT(glm::distance(doubled.splats[9].centre, 2.0f * splats.splats[9].centre), 1e-6f);
    EXPECT_LT(glm::distance(doubled.splats[9].deviation, 2.0f * splats.splats[9].deviation), 1e-6f);
}

std::string error_of(const std::function<void()>& run) {
    try {
        run();
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(SplatReader, SaysWhatItCannotRead) {
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.path / "x.ply";
    const std::string start = "ply\nformat binary_little_endian 1.0\n";
    const std::pair<std::string, std::string> cases[] = {
        {"PLY", "is no .ply"},
        {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n", "is ascii"},
        {start + "element vertex 1\nproperty float x\n", "no end of its header"},
        {start + "element vertex 1\nproperty float x\nend_header\n....", "without y"},
        {start + "element vertex 2\nproperty float x\nend_header\n....", "ends before its last vertex"},
        {start + "element vertex 18446744073709551615\nproperty float x\nend_header\n....", "ends before"},
        {start + "element chunk 1\nproperty float x\nend_header\n....", "compressed"},
        {start + "element face 1\nproperty list uchar int x\nend_header\n....", "lists"},
    };
    for (const auto& [bytes, expected] : cases) {
        std::ofstream(path, std::ios::binary) << bytes;
        const std::string error = error_of([&] { interchange::read_splat_ply(path); });
        EXPECT_NE(error.find(expected), std::string::npos) << error;
    }
}

// Puts a number in the place of a property of a splat in a file of ours of degree 0, whose last properties those are.
void overwrite(const std::filesystem::path& path, size_t splats, size_t splat, const std::string& property,
               float value) {
    const std::vector<std::string> names = {"x",       "y",      "z",      "nx",      "ny",      "nz",
                                            "f_dc_0",  "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1",
                                            "scale_2", "rot_0",  "rot_1",  "rot_2",   "rot_3"};
    const auto column = static_cast<size_t>(std::find(names.begin(), names.end(), property) - names.begin());
    ASSERT_LT(column, names.size());
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(-static_cast<std::streamoff>(sizeof(float) * (names.size() * (splats - splat) - column)), std::ios::end);
    file.write(reinterpret_cast<const char*>(&value), sizeof(value));
}

constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();

TEST(SplatReader, LeavesOutWhatIsNotFiniteAndNamesIt) {
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.path / "x.ply";
    const Splats splats = some_splats(0, 5);
    const std::tuple<std::string, float, std::string> cases[] = {
        {"x", kNan, "splat 3, whose x is nan"},
        {"z", -kInfinity, "splat 3, whose z is -inf"},
        {"y", 2e6f, "splat 3, whose y is 2e+06 m"},
        {"opacity", kNan, "splat 3, whose opacity is nan"},
        {"scale_1", 100, "splat 3, whose scale_1 is 100"},
        {"scale_2", kInfinity, "splat 3, whose scale_2 is inf"},
        {"f_dc_2", 1e30f, "splat 3, whose f_dc_2 is 1e+30"},
        {"rot_2", kNan, "splat 3, whose rot_2 is nan"},
        {"rot_0", 3e38f, "splat 3, whose rotation has the length inf"},
    };
    for (const auto& [property, value, reason] : cases) {
        interchange::write_splat_ply(path, splats);
        overwrite(path, 5, 3, property, value);
        const interchange::PlySplats read = interchange::read_splat_ply(path);
        EXPECT_EQ(read.left_out, 1u) << property;
        EXPECT_TRUE(read.first_left_out.starts_with(reason)) << read.first_left_out;
        ASSERT_EQ(read.splats.splats.size(), 4u);
        EXPECT_EQ(read.splats.splats[3].row, 4u);
        EXPECT_LT(glm::distance(read.splats.splats[3].centre, splats.splats[4].centre), 1e-6f);
    }
    Splats unturned = splats;
    unturned.splats[1].rotation = glm::quat(0, 0, 0, 0);
    interchange::write_splat_ply(path, unturned);
    EXPECT_EQ(interchange::read_splat_ply(path).first_left_out, "splat 1, whose rotation has the length 0");
}

// The logits of 1 and 0 are infinite, and so is the logarithm of 0.
TEST(SplatReader, ReadsInfiniteLogits) {
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.path / "x.ply";
    interchange::write_splat_ply(path, some_splats(0, 5));
    overwrite(path, 5, 0, "opacity", kInfinity);
    overwrite(path, 5, 1, "opacity", -kInfinity);
    overwrite(path, 5, 2, "scale_1", -kInfinity);
    const interchange::PlySplats read = interchange::read_splat_ply(path);
    EXPECT_EQ(read.left_out, 0u);
    ASSERT_EQ(read.splats.splats.size(), 5u);
    EXPECT_EQ(read.splats.splats[0].opacity, 1);
    EXPECT_EQ(read.splats.splats[1].opacity, 0);
    EXPECT_LT(read.splats.splats[2].deviation.y, 1e-6f);
    // As doubles, too.
    Splats opaque = some_splats(0, 2);
    opaque.splats[0].opacity = 1;
    write_other_ply(path, opaque);
    EXPECT_EQ(interchange::read_splat_ply(path).splats.splats.at(0).opacity, 1);
}

// A tree of opaque splats is opaque.
TEST(Voxelise, OpaqueSplatsAreOpaque) {
    const TemporaryFolder folder;
    Splats splats = some_splats(0, 1);
    splats.splats[0].centre = glm::vec3(0);
    splats.splats[0].deviation = glm::vec3(0.1f);
    interchange::write_splat_ply(folder.path / "x.ply", splats);
    overwrite(folder.path / "x.ply", 1, 0, "opacity", kInfinity);
    const Splats read = interchange::read_splat_ply(folder.path / "x.ply").splats;
    const slice::Slice volume =
        voctree::slice_of(interchange::voxelised(read, interchange::box_of(read), 0.02, 25, "x", [] {}), 0);
    float most = 0;
    for (const slice::Leaf& leaf : volume.leaves) most = std::max(most, leaf.sigma);
    EXPECT_GT(1 - std::exp(-most * 0.2f), 0.98f);
}

TEST(SplatReader, SurvivesDamagedFiles) {
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.path / "x.ply", damaged = folder.path / "y.ply";
    std::vector<std::string> files;
    for (const uint32_t degree : {0u, 2u}) {
        interchange::write_splat_ply(path, some_splats(degree, 4));
        std::ifstream file(path, std::ios::binary);
        files.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    }
    fuzz::Random random(1);
    size_t refused = 0, read = 0;
    for (int i = 0; i < 800; ++i) {
        std::ofstream(damaged, std::ios::binary)
            << fuzz::mutate(files[random() % files.size()], files, size_t{1} << 16, random);
        const std::string error = error_of([&] {
            const Splats splats = interchange::read_splat_ply(damaged).splats;
            const interchange::SplatBox box = interchange::box_of(splats);
            const glm::dvec3 size = box.high - box.low;
            const double cell_m = std::max({size.x, size.y, size.z, 1e-3}) / 16;
            const voctree::VOctree tree = interchange::voxelised(splats, box, cell_m, 25, damaged.string(), [] {});
            EXPECT_EQ(voctree::defect_of(tree), "");
            ++read;
        });
        refused += error.empty() ? 0 : 1;
        EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    }
    EXPECT_GT(refused, 100u);
    EXPECT_GT(read, 80u);
}

// Splats that are turned, each by itself and all together, as an independent reader and renderer sees them.
TEST(SplatReader, DrawsFilesAsTheDefinitionDoes) {
    const TemporaryFolder folder;
    interchange::write_splat_ply(folder.path / "x.ply", some_splats(3, 60));
    Splats splats = interchange::read_splat_ply(folder.path / "x.ply").splats;
    interchange::turn(splats, interchange::kPlyRotation);
    const stage::Camera camera = look_at({1.5, 0.8, 2.0}, {0, 0, 0}, 48, 40);
    const glm::dmat3 about_x(1, 0, 0, 0, -1, 0, 0, 0, -1), about_z(-1, 0, 0, 0, -1, 0, 0, 0, 1);
    const reference::SplatCamera turned{about_x * glm::transpose(glm::dmat3(camera.world_from_camera)) * about_z,
                                        about_z * glm::dvec3(camera.world_from_camera[3]),
                                        camera.fx,
                                        camera.fy,
                                        camera.cx,
                                        camera.cy,
                                        48,
                                        40};
    const auto truth = reference::draw_splats(reference::read_splats(folder.path / "x.ply"), turned, glm::dvec3(1));
    const media::Image image = interchange::splat_image(splats, camera, glm::vec3(1));
    double sum = 0, coverage = 0;
    for (size_t i = 0; i < truth.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const double shown = image.rgba[4 * i + static_cast<size_t>(c)] / 255.0;
            EXPECT_NEAR(shown, truth[i][c], 0.02);
            sum += std::abs(shown - truth[i][c]);
            coverage += std::abs(1 - truth[i][c]);
        }
    EXPECT_LT(sum / static_cast<double>(3 * truth.size()), 0.002);
    EXPECT_GT(coverage / static_cast<double>(3 * truth.size()), 0.03) << "something is seen";
}

// Splats within about 2 m, of which some are moved.
Splats cloud(size_t count, std::initializer_list<glm::vec3> floaters) {
    Splats splats = some_splats(0, count);
    size_t i = 7;
    for (const glm::vec3& place : floaters) splats.splats[i++].centre = place;
    return splats;
}

TEST(SplatBox, LeavesOutWhatFloatsFarAway) {
    const double size = interchange::box_of(cloud(453, {})).longest_m();
    for (const auto& floaters : {std::initializer_list<glm::vec3>{{1000, 0, 0}, {990, 10, 0}, {0, 1000, 5}},
                                 {{0, 0, -30}},
                                 {{20, 0, 0}, {-20, 0, 0}, {0, 20, 0}, {0, -20, 0}, {0, 0, 20}}}) {
        const Splats splats = cloud(453, floaters);
        const interchange::MainBox main = interchange::main_box_of(splats);
        EXPECT_EQ(main.beyond, floaters.size());
        EXPECT_LE(main.box.longest_m(), size);
        EXPECT_GT(main.box.longest_m(), 0.9 * size);
        ASSERT_TRUE(main.farthest);
        EXPECT_GT(glm::length(main.farthest->centre), 15);
        EXPECT_FALSE(main.dense);
        Splats cropped = splats;
        interchange::crop(cropped, main.box);
        EXPECT_EQ(cropped.splats.size(), 453 - floaters.size());
    }
}

TEST(SplatBox, LeavesOutWhatIsFarTooLarge) {
    Splats splats = cloud(200, {});
    splats.splats[3].deviation.z = 50;
    const interchange::MainBox main = interchange::main_box_of(splats);
    EXPECT_EQ(main.beyond, 1u);
    EXPECT_EQ(main.farthest, &splats.splats[3]);
    EXPECT_LT(main.box.longest_m(), 10);
}

// Nothing of a performer is cut, however thin an arm is, nor of few splats, nor of what is faint.
TEST(SplatBox, KeepsAllThatBelongsTogether) {
    Splats splats = cloud(2000, {{2.2f, 0, 0}, {-2.3f, 0.1f, 0}, {0, 3, 0}});
    splats.splats[20].centre = glm::vec3(1000);
    splats.splats[20].opacity = 1e-3f;
    for (const Splats& each : {splats, cloud(9, {{50, 0, 0}})}) {
        const interchange::MainBox main = interchange::main_box_of(each);
        EXPECT_EQ(main.beyond, 0u);
        const interchange::SplatBox box = interchange::box_of(each);
        EXPECT_EQ(main.box.low, box.low);
        EXPECT_EQ(main.box.high, box.high);
    }
    EXPECT_EQ(interchange::main_box_of(Splats{}).box.longest_m(), 0);
}

// A tenth of all splats is no floater, but cells are larger by it: that is said.
TEST(SplatBox, TellsWhereMostSplatsAre) {
    Splats splats = cloud(400, {});
    for (size_t i = 0; i < 32; ++i) splats.splats[i].centre.x += i % 2 == 0 ? 40.0f : -40.0f;
    const interchange::MainBox main = interchange::main_box_of(splats);
    EXPECT_EQ(main.beyond, 0u);
    EXPECT_GT(main.box.longest_m(), 60);
    ASSERT_TRUE(main.dense);
    EXPECT_LT(main.dense->longest_m(), 5);
    const interchange::MainBox of_few = interchange::main_box_of(cloud(9, {{9e5f, 0, 0}}));
    EXPECT_GT(of_few.box.longest_m(), 8e5);
    ASSERT_TRUE(of_few.dense);
    EXPECT_LT(of_few.dense->longest_m(), 5);
}

TEST(Voxelise, NamesTheSplatThatIsTooFarAway) {
    Splats splats = cloud(20, {{9e5f, 0, 0}});
    splats.splats[7].row = 12;
    const auto error = [&](double cell_m) {
        return error_of(
            [&] { interchange::voxelised(splats, interchange::box_of(splats), cell_m, 25, "x.ply", [] {}); });
    };
    EXPECT_NE(error(1e-3).find("x.ply: splat 12 at (900000, 0, 0): lies too far from the origin"), std::string::npos);
    EXPECT_NE(error(1).find("x.ply: splat 12 at (900000, 0, 0): lies in a box of 90000"), std::string::npos)
        << error(1);
}

Splats one_splat(const glm::vec3& deviation, const glm::quat& rotation, float opacity) {
    Splats splats{0, {Splat{}}};
    splats.splats[0].centre = {0.1f, -0.2f, 0.3f};
    splats.splats[0].deviation = deviation;
    splats.splats[0].rotation = rotation;
    splats.splats[0].opacity = opacity;
    splats.splats[0].colour[0] = {1, 0, -1};
    return splats;
}

// The optical depth along an axis through (x, y).
double depth_along(const slice::Slice& volume, int axis, const glm::dvec3& through) {
    double sum = 0;
    for (const slice::Leaf& leaf : volume.leaves) {
        const glm::dvec3 offset = glm::abs(through - glm::dvec3(volume.centre_m(leaf)));
        bool crosses = true;
        for (int a = 0; a < 3; ++a) crosses &= a == axis || offset[a] <= 0.5 * double{volume.edges_m(leaf)[a]};
        if (crosses) sum += double{leaf.sigma} * double{volume.edges_m(leaf)[axis]};
    }
    return sum;
}

// Rays see what a splat's definition says: opacity · exp(−½ x²).
TEST(Voxelise, DimsRaysAsASplatDoes) {
    for (const float opacity : {0.3f, 0.9f, 0.99f}) {
        const Splats splats = one_splat(glm::vec3(0.1f), {1, 0, 0, 0}, opacity);
        const voctree::VOctree tree =
            interchange::voxelised(splats, {glm::dvec3(-1), glm::dvec3(1)}, 0.02, 25, "x", [] {});
        const slice::Slice volume = voctree::slice_of(tree, 0);
        for (const double distance : {0.0, 0.05, 0.1, 0.15, 0.2})
            for (int axis = 0; axis < 3; ++axis) {
                glm::dvec3 through(splats.splats[0].centre);
                through[(axis + 1) % 3] += distance;
                through = 0.04 * (glm::floor(through / 0.04) + 0.5);  // the centre of a cell
                glm::dvec3 offset = through - glm::dvec3(splats.splats[0].centre);
                offset[axis] = 0;
                const double x = glm::length(offset) / 0.1;
                const double alpha = double{opacity} * std::exp(-0.5 * x * x);
                EXPECT_NEAR(1 - std::exp(-depth_along(volume, axis, through)), alpha, 0.03)
                    << opacity << " " << distance;
            }
    }
}

// A disc is as opaque as it is, seen along its axis, though it is thinner than a cell.
TEST(Voxelise, KeepsDiscsThatAreThinnerThanCells) {
    const glm::quat about_y(std::sqrt(0.5f), 0, std::sqrt(0.5f), 0);  // z becomes x
    const Splats splats = one_splat({0.3f, 0.3f, 0.002f}, about_y, 0.6f);
    const voctree::VOctree tree = interchange::voxelised(splats, {glm::dvec3(-2), glm::dvec3(2)}, 0.05, 25, "x", [] {});
    const slice::Slice volume = voctree::slice_of(tree, 0);
    EXPECT_NEAR(1 - std::exp(-depth_along(volume, 0, {0.101, -0.201, 0.301})), 0.6, 0.03);
    for (const slice::Leaf& leaf : volume.leaves) {
        const glm::vec3 offset = glm::abs(volume.centre_m(leaf) - splats.splats[0].centre);
        EXPECT_LT(offset.x, 0.2f);
        EXPECT_LT(std::max(offset.y, offset.z), 1.3f);
    }
}

TEST(Voxelise, HasTheColoursOfSplats) {
    const Splats splats = one_splat(glm::vec3(0.1f), {1, 0, 0, 0}, 0.9f);
    const slice::Slice volume =
        voctree::slice_of(interchange::voxelised(splats, {glm::dvec3(-1), glm::dvec3(1)}, 0.05, 25, "x", [] {}), 0);
    ASSERT_GT(volume.leaves.size(), 20u);
    for (const slice::Leaf& leaf : volume.leaves)
        for (int c = 0; c < 3; ++c) {
            const double srgb = 0.5 + 0.28209479 * double{splats.splats[0].colour[0][c]};
            const double linear = 1 / (1 + std::exp(-0.28209479 * double{leaf.colours[static_cast<size_t>(c)][0]}));
            EXPECT_NEAR(linear, media::linear_from_srgb(srgb), 0.002);
        }
}

// Large splats get large cells, however small those of others are; what lies outside the box is left out.
TEST(Voxelise, ChoosesCellsBySplatsAndKeepsToTheBox) {
    Splats splats = one_splat(glm::vec3(0.4f), {1, 0, 0, 0}, 0.5f);
    splats.splats.push_back(splats.splats[0]);
    splats.splats[1].centre = {1.5f, 1.5f, 1.5f};
    splats.splats[1].deviation = glm::vec3(0.02f);
    splats.splats.push_back(splats.splats[1]);
    splats.splats[2].centre.x = 5;
    const slice::Slice volume =
        voctree::slice_of(interchange::voxelised(splats, {glm::dvec3(-2), glm::dvec3(2)}, 0.01, 25, "x", [] {}), 0);
    float least = 1, most = 0;
    for (const slice::Leaf& leaf : volume.leaves) {
        least = std::min(least, volume.edge_m(leaf));
        most = std::max(most, volume.edge_m(leaf));
        for (int a = 0; a < 3; ++a) EXPECT_LT(std::abs(volume.centre_m(leaf)[a]), 2);
    }
    EXPECT_NEAR(least, 0.01, 1e-6);
    EXPECT_GT(most, 0.1f);
    EXPECT_LT(volume.leaves.size(), 60000u);
}

}  // namespace
}  // namespace neuvv::test
