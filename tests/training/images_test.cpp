// How read_images treats masks, mattes, plates, videos and lenses, on rigs that the tests fill in.
#include "training/data/images.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/platform.h"
#include "media/video.h"
#include "support/input_error.h"
#include "support/temporary_folder.h"

namespace neuvv {
namespace {

constexpr uint32_t kWidth = 16, kHeight = 12;

media::Image plain(uint8_t value, uint8_t alpha = 255) {
    media::Image image(kWidth, kHeight);
    for (size_t i = 0; i < image.rgba.size(); ++i) image.rgba[i] = i % 4 == 3 ? alpha : value;
    return image;
}

// A mask that is white, or opaque, where x < 8.
media::Image half_mask(bool in_alpha, uint8_t white = 255) {
    media::Image image(kWidth, kHeight);
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth; ++x) {
            const uint8_t value = x < 8 ? white : 0;
            std::fill_n(image.at(x, y), 3, in_alpha ? uint8_t{9} : value);
            image.at(x, y)[3] = in_alpha ? value : 255;
        }
    return image;
}

// A rig of two cameras with one image each.
struct ImagesTest : testing::Test {
    TemporaryFolder folder;
    training::Rig rig;

    void SetUp() override {
        rig.folder = folder.path;
        rig.file = (folder.path / "rig.json").string();
        for (uint32_t c = 0; c < 2; ++c) {
            training::RigCamera camera;
            camera.name = "cam" + std::to_string(c);
            camera.lens = {.fx = 20, .fy = 20, .cx = 8, .cy = 6, .width = kWidth, .height = kHeight};
            rig.cameras.push_back(camera);
            training::Shot shot;
            shot.camera = c;
            shot.name = camera.name + "_0";
            shot.place = "shots[" + std::to_string(c) + "]";
            shot.image.path = write(shot.name + ".png", plain(static_cast<uint8_t>(100 + 50 * c)));
            rig.shots.push_back(shot);
        }
    }
    std::filesystem::path write(const std::string& name, const media::Image& image) {
        std::filesystem::create_directories((folder.path / name).parent_path());
        media::write_png(folder.path / name, image);
        return folder.path / name;
    }
    training::Dataset load(bool mattes_needed = true) {
        return training::read_images(rig, {.mattes_needed = mattes_needed});
    }
    void mask_all(const media::Image& mask, training::MaskMeaning meaning) {
        rig.masks = meaning;
        for (training::Shot& shot : rig.shots) shot.mask.path = write("mask.png", mask);
    }
};

TEST_F(ImagesTest, WithoutMattesTheMendIsNamed) {
    expect_input_error([&] { load(); }, {folder.path.string(), "no image has a matte", "make mattes for"});
    const training::Dataset data = load(false);
    EXPECT_EQ(data.views.at(1).image.whole().rgba, plain(150).rgba);
    EXPECT_EQ(data.cameras.at(1).fx, 20);
    EXPECT_TRUE(data.views[0].ignored.empty());
}

// Only what the budget cannot hold goes to disk.
TEST_F(ImagesTest, BeyondTheBudgetPixelsWaitOnDisk) {
    const auto read = [&](uint64_t bytes) {
        return training::read_images(rig, {.mattes_needed = false, .memory_bytes = bytes});
    };
    const training::Dataset inside = read(1 << 20);
    EXPECT_EQ(inside.spool->bytes_on_disk(), 0u);
    const uint64_t all = training::image_bytes(inside), one = inside.views[0].image.bytes();
    EXPECT_EQ(all, 2 * one);
    for (const auto& [budget, on_disk] : {std::pair(all + 128, uint64_t{0}), {one + 128, one}, {uint64_t{1}, all}}) {
        const training::Dataset outside = read(budget);
        EXPECT_NEAR(static_cast<double>(outside.spool->bytes_on_disk()), static_cast<double>(on_disk), 128) << budget;
        ASSERT_EQ(outside.views.size(), 2u);
        for (size_t i = 0; i < 2; ++i) {
            EXPECT_EQ(outside.views[i].image.kept_rgba().get_allocator().resource(), outside.spool.get());
            EXPECT_EQ(outside.views[i].image, inside.views[i].image);
        }
    }
}

TEST_F(ImagesTest, BackgroundTakesNoMemory) {
    constexpr uint64_t kGroup = sizeof(training::TiledImage::Group);
    mask_all(half_mask(false), training::MaskMeaning::kMatte);
    for (const training::View& view : load().views) {  // 2×2 tiles, of which those on the left are foreground
        EXPECT_EQ(view.image.bytes(), 2 * training::TiledImage::kTileBytes + kGroup);
        EXPECT_EQ(view.image.at(9, 3)[0], 0);
    }
    mask_all(half_mask(false), training::MaskMeaning::kIgnore);
    for (const training::View& view : load(false).views)
        EXPECT_EQ(view.image.bytes(), 2 * training::TiledImage::kTileBytes + kGroup) << "nor do ignored pixels";
}

TEST_F(ImagesTest, ASpoolThatTheDiskCannotHoldIsRefused) {
    SpooledMemory large(0, folder.path, uint64_t{1} << 60), nowhere(0, folder.path / "nowhere", 64);
    EXPECT_THROW((void)large.allocate(uint64_t{1} << 59), RuntimeFailure);
    EXPECT_THROW((void)nowhere.allocate(64), RuntimeFailure);
    SpooledMemory memory(0, folder.path, 128);
    EXPECT_NE(memory.allocate(1), memory.allocate(64));
    EXPECT_THROW((void)memory.allocate(1), std::bad_alloc);
}

TEST_F(ImagesTest, ASpoolFillsMemoryFirst) {
    constexpr size_t kBytes = 20 << 20;  // more than the step in which the file grows
    SpooledMemory memory(2 * kBytes, folder.path, 2 * kBytes);
    std::vector<uint8_t*> parts;
    for (size_t i = 0; i < 4; ++i) {
        parts.push_back(static_cast<uint8_t*>(memory.allocate(kBytes)));
        std::fill_n(parts.back(), kBytes, static_cast<uint8_t>(1 + i));
        EXPECT_EQ(memory.bytes_on_disk(), i < 2 ? 0 : (i - 1) * kBytes);
    }
    EXPECT_THROW((void)memory.allocate(1), std::bad_alloc);
    for (size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(std::count(parts[i], parts[i] + kBytes, 1 + i), static_cast<ptrdiff_t>(kBytes));
        memory.deallocate(parts[i], kBytes);
    }
    memory.deallocate(memory.allocate(2 * kBytes), 2 * kBytes);  // plain memory is free again
    EXPECT_EQ(memory.bytes_on_disk(), 2 * kBytes);
}

TEST_F(ImagesTest, AMatteMaskBecomesAlpha) {
    for (const bool in_alpha : {false, true}) {
        mask_all(half_mask(in_alpha, 200), training::MaskMeaning::kMatte);
        const training::Dataset data = load();
        EXPECT_EQ(data.views[0].image.at(7, 3)[3], 200);
        EXPECT_EQ(data.views[0].image.at(7, 3)[0], 100);
        EXPECT_EQ(data.views[0].image.at(8, 3)[3], 0);
        EXPECT_TRUE(data.views[0].ignored.empty());
    }
}

TEST_F(ImagesTest, UsableAndIgnoredAreOpposites) {
    for (const training::MaskMeaning meaning : {training::MaskMeaning::kUsable, training::MaskMeaning::kIgnore}) {
        mask_all(half_mask(false, 1), meaning);  // some programs write 1 for white
        const training::Dataset data = load(false);
        const training::View& view = data.views[1];
        const uint32_t known = meaning == training::MaskMeaning::kUsable ? 7 : 8, unknown = 15 - known;
        EXPECT_FALSE(view.ignores(known, 3));
        EXPECT_EQ(view.image.at(known, 3)[0], 150);
        EXPECT_TRUE(view.ignores(unknown, 3));
        EXPECT_EQ(view.image.at(unknown, 3)[0], 0);
        EXPECT_EQ(view.image.at(unknown, 3)[3], 0);
        // Ignored pixels are no matte.
        expect_input_error([&] { load(); }, {"no image has a matte"});
    }
}

TEST_F(ImagesTest, MattesBesideTheDataSetWin) {
    mask_all(half_mask(false), training::MaskMeaning::kMatte);
    write("mattes/cam0_0.png", plain(77));
    EXPECT_EQ(load().views[0].image.at(12, 3)[3], 77);
    EXPECT_EQ(load().views[1].image.at(12, 3)[3], 0) << "the mask is a matte, too";
    rig.shots[1].mask.path.clear();
    expect_input_error([&] { load(); }, {"mattes/cam1_0.png", "missing", "make mattes for"});
    write("mattes/cam1_0.png", media::Image(kWidth, kHeight - 1));
    expect_input_error([&] { load(); }, {"cam1_0.png", "16×11", "cam1", "16×12"});
}

TEST_F(ImagesTest, SizesFollowTheCalibration) {
    write("cam1_0.png", media::Image(kWidth + 1, kHeight));
    expect_input_error([&] { load(); }, {"cam1_0.png", "17×12", "camera cam1", "rig.json", "16×12"});
    rig.cameras[1].lens.width = rig.cameras[1].lens.height = 0;
    EXPECT_EQ(load().cameras[1].width, kWidth + 1);
}

TEST_F(ImagesTest, ALensIsUndoneInImagePlateAndMasks) {
    rig.masks = training::MaskMeaning::kIgnore;
    rig.shots[1].mask.path = write("ignore.png", half_mask(false));
    rig.cameras[1].lens.model = interchange::LensModel::kBrown;
    rig.cameras[1].lens.k[0] = 0.6;  // pincushion distortion: the lens never saw the corners
    rig.cameras[1].plate.path = write("plate.png", plain(60));
    const training::Dataset data = load(false);
    const training::View& view = data.views[1];
    EXPECT_TRUE(view.ignores(0, 0));
    EXPECT_TRUE(view.ignores(15, 11));
    EXPECT_TRUE(view.ignores(6, 6));
    EXPECT_FALSE(view.ignores(10, 6));
    EXPECT_EQ(view.image.at(10, 6)[0], 150);
    EXPECT_EQ(view.image.at(15, 11)[3], 0);
    EXPECT_EQ(data.plates[1].at(10, 6)[0], 60);
    EXPECT_TRUE(data.views[0].ignored.empty());

    rig.cameras[1].lens.k[0] = -20;
    expect_input_error([&] { load(false); }, {"rig.json", "camera cam1", "folds over", "%"});
    rig.cameras[1].lens.k[0] = 500;
    expect_input_error([&] { load(false); }, {"rig.json", "camera cam1", "leaves only"});
}

TEST_F(ImagesTest, FramesOfVideosComeInAnyOrder) {
    for (uint32_t c = 0; c < 2; ++c) {
        media::VideoWriter video(folder.path / ("v" + std::to_string(c) + ".mp4"), kWidth, kHeight, 25);
        for (uint32_t i = 0; i < 9; ++i) video.add(plain(static_cast<uint8_t>(20 + 20 * i + 30 * c)));
        video.finish();
    }
    rig.shots.clear();
    for (const int frame : {4, 1, 1, 8})
        for (uint32_t c = 0; c < 2; ++c) {
            training::Shot shot;
            shot.camera = c;
            shot.image = {folder.path / ("v" + std::to_string(c) + ".mp4"), frame};
            shot.time = frame / 8.0;
            rig.shots.push_back(shot);
        }
    const training::Dataset data = load(false);
    for (size_t i = 0; i < data.views.size(); ++i) {
        const double expected =
            20 + 20 * static_cast<double>(rig.shots[i].image.video_frame) + 30.0 * static_cast<double>(i % 2);
        EXPECT_NEAR(data.views[i].image.at(5, 5)[1], expected, 3) << i;
        EXPECT_EQ(data.views[i].image.at(5, 5)[3], 255);
    }
    EXPECT_EQ(data.times, (std::vector<double>{0.125, 0.5, 1}));
    rig.shots[2].image.video_frame = 9;
    expect_input_error([&] { load(false); }, {"v0.mp4", "frame 9", "9 frames"});
}

}  // namespace
}  // namespace neuvv
