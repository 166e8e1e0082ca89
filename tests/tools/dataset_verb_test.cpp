// `neuvv dataset`: its report on data sets, and its drawings.
#include <gtest/gtest.h>

#include <cmath>

#include "support/armed_figure.h"
#include "support/colmap_files.h"
#include "support/matte_networks.h"
#include "support/rig_pixel.h"
#include "support/sphere_capture.h"
#include "tests/tools/run_neuvv.h"
#include "tools/data/rig_drawing.h"
#include "tools/image_drawing.h"
#include "tools/report.h"
#include "training/data/empty_mattes.h"
#include "training/data/layouts/formats.h"

namespace neuvv {
namespace {

struct DatasetVerb : testing::Test {
    TemporaryFolder folder;

    std::string say(const std::vector<std::string>& more = {}) const {
        std::vector<std::string> arguments = {"dataset", (folder.path / "data").string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const ProgramResult result = run_neuvv(arguments);
        EXPECT_EQ(result.code, 0) << result.err;
        EXPECT_EQ(result.err, "");
        return result.out;
    }
    // The rest of the line that begins with this word.
    static std::string field(const std::string& text, const std::string& word) {
        const size_t begin = text.find("\n" + word + " ");
        if (begin == std::string::npos) return "no " + word;
        const size_t value = text.find_first_not_of(' ', begin + 1 + word.size());
        return text.substr(value, text.find('\n', value) - value);
    }

    // A matte with a performer in the middle.
    static void write_matte(const std::filesystem::path& path, uint32_t width, uint8_t border, uint8_t middle) {
        media::Image matte(width, 48);
        for (uint32_t y = 0; y < matte.height; ++y)
            for (uint32_t x = 0; x < matte.width; ++x) {
                const bool inside = x > 20 && x < 44 && y > 8 && y < 40;
                std::fill_n(matte.at(x, y), 3, inside ? middle : border);
                matte.at(x, y)[3] = 255;
            }
        std::filesystem::create_directories(path.parent_path());
        media::write_png(path, matte);
    }
    // Nine cameras without mattes, the first and the last held out.
    void write_colmap_capture() const {
        test::ColmapSample sample;
        sample.cameras = {{1, 1, "PINHOLE", 64, 48, {60, 61, 32, 24}},
                          {2, 4, "OPENCV", 64, 48, {70, 70, 32, 24, 0.01, 0, 0, 0}}};
        for (int i = 0; i < 9; ++i) {
            const double half = 0.3 * i;
            sample.images.push_back(
                {i, {std::cos(half), 0, std::sin(half), 0, 0, 0, 3}, 1 + i % 2, fmt::format("eye{}.png", i)});
            test::write_grey_png(folder.path / "data" / "images" / sample.images.back().name, 64, 48);
        }
        test::write_colmap(folder.path / "data" / "sparse" / "0", sample, true);
    }
};

TEST_F(DatasetVerb, ACaptureWithMattes) {
    const test::SphereCapture capture;
    std::filesystem::create_directories(folder.path / "data");
    test::write_capture(folder.path / "data", test::sphere_dataset(capture));
    const std::string text = say();
    EXPECT_NE(text.find("data: nerf, calibrated by "), std::string::npos) << text;
    EXPECT_EQ(field(text, "train"), "12 cameras: c00 c01 c02 c03 c04 c05 c06 c07 c08 c09 c10 c11");
    EXPECT_EQ(field(text, "test").find("none: "), 0u) << text;
    EXPECT_NE(field(text, "test").find("transforms_test.json"), std::string::npos) << text;
    EXPECT_EQ(field(text, "lenses"), "pinhole; focal length 62.4 pixels, 42.1° wide");
    EXPECT_EQ(field(text, "size"), "48×48");
    EXPECT_EQ(field(text, "frames"), "3, frame rate not given");
    EXPECT_EQ(field(text, "images"), "36, every camera at every time");
    EXPECT_EQ(field(text, "masks"), "none");
    EXPECT_EQ(field(text, "plates"), "none");
    EXPECT_EQ(field(text, "mattes").find("yes; the performer fills "), 0u) << text;
    EXPECT_EQ(field(text, "box"), "not given");
    const std::string memory = field(text, "memory");
    EXPECT_NE(memory.find("(" + tools::size_text(36 * 48 * 48 * 4) + " with all background)"), std::string::npos)
        << text;
    double kept_kb = 0, estimated_kb = 0;
    for (const training::View& view : test::sphere_dataset(capture).views)
        kept_kb += static_cast<double>(view.image.bytes()) / 1000;
    ASSERT_EQ(std::sscanf(memory.c_str(), "about %lf kB for", &estimated_kb), 1) << text;
    EXPECT_NEAR(estimated_kb, kept_kb, 0.1 * kept_kb) << "estimated from a sample of the images";
    double a[3], b[3];
    ASSERT_EQ(std::sscanf(field(text, "hull").c_str(), "(%lf, %lf, %lf) to (%lf, %lf, %lf)", &a[0], &a[1], &a[2], &b[0],
                          &b[1], &b[2]),
              6)
        << text;
    const double reach[3] = {capture.travel_m + capture.radius_m, capture.radius_m, capture.radius_m};
    for (int axis = 0; axis < 3; ++axis) {
        const double centre = axis == 1 ? 0.05 : 0;
        EXPECT_LE(a[axis], centre - reach[axis] + 0.02) << "the hull holds the sphere's whole way";
        EXPECT_GE(b[axis], centre + reach[axis] - 0.02);
        EXPECT_GT(a[axis], centre - reach[axis] - 0.3);
        EXPECT_LT(b[axis], centre + reach[axis] + 0.3);
    }
}

// At a time that is not among those whose images are read.
TEST_F(DatasetVerb, EmptyMattesAreNamedAtAnyTime) {
    std::filesystem::create_directories(folder.path / "data");
    const training::Dataset dataset = test::sphere_dataset({.frames = 8});
    test::write_capture(folder.path / "data", dataset);
    EXPECT_EQ(say().find("empty matte"), std::string::npos) << say();
    const auto blacken = [&](const char* name) {
        media::write_png(folder.path / "data" / (std::string(name) + ".png"), media::Image(48, 48));
    };
    blacken("c03_f002");
    blacken("c07_f005");
    const std::string text = say();
    EXPECT_NE(text.find("\nempty matte: c03_f002 shows nothing"), std::string::npos) << text;
    EXPECT_NE(text.find("\nempty matte: c07_f005 shows nothing"), std::string::npos) << text;
    EXPECT_EQ(text.find("empty mattes"), std::string::npos) << "no more, and all times were looked at\n" << text;
    // A file of mattes/ overrules the image's alpha. Where all are black, the performer is away.
    for (const training::View& view : dataset.views) {
        const bool black = view.name.ends_with("f004") || view.name == "c00_f001";
        test::write_grey_png(folder.path / "data" / "mattes" / (view.name + ".png"), 48, 48, black ? 0 : 128);
    }
    const std::string overruled = say();
    EXPECT_NE(overruled.find("\nempty matte: c00_f001 shows nothing"), std::string::npos) << overruled;
    EXPECT_EQ(overruled.find("f004 shows nothing"), std::string::npos) << overruled;
    EXPECT_EQ(overruled.find("f002 shows nothing"), std::string::npos) << overruled;

    const training::Rig rig = training::read_rig(folder.path / "data", training::Split::kTrain);
    const training::EmptyMattes some = training::find_empty_mattes(rig, 30, {});
    EXPECT_EQ(some.times, 8u);
    EXPECT_EQ(some.looked_at, 2u) << "30 images of twelve cameras";
    EXPECT_TRUE(some.shots.empty()) << "those of times 0 and 4";
}

TEST_F(DatasetVerb, SwappedCamerasAreNamed) {
    std::filesystem::create_directories(folder.path / "data");
    training::Dataset dataset = test::armed_figure(9);
    for (training::View& view : dataset.views)
        if (view.camera == 2 || view.camera == 7) view.camera = 9 - view.camera;
    test::write_capture(folder.path / "data", dataset);
    const std::string text = say();
    EXPECT_EQ(field(text, "note").find("the images of cameras c02 and c07 seem to be swapped: "), 0u) << text;
    EXPECT_EQ(text.find("doubtful matte"), std::string::npos) << "they are used where they belong\n" << text;

    const std::string data = (folder.path / "data").string(), copy = (folder.path / "copy").string();
    const ProgramResult wrote = run_neuvv({"dataset", data, "-o", copy, "--as", "transforms"});
    ASSERT_EQ(wrote.code, 0) << wrote.err;
    EXPECT_NE(wrote.err.find("c02 and c07 seem to be swapped"), std::string::npos) << wrote.err;
    const ProgramResult again = run_neuvv({"dataset", copy});
    EXPECT_EQ((again.out + again.err).find("swapped"), std::string::npos) << "the copy is right\n" << again.out;
}

// By `neuvv dataset` and, before it trains, by `neuvv train`.
TEST_F(DatasetVerb, FewCamerasAreWarnedOf) {
    std::filesystem::create_directories(folder.path / "data");
    const std::string data = (folder.path / "data").string();
    for (const uint32_t cameras : {4u, 9u, 10u}) {
        SCOPED_TRACE(cameras);
        test::write_capture(folder.path / "data", test::armed_figure(cameras));
        const std::string warning = fmt::format("{} cameras are few: their hull is larger than the performer", cameras);
        const bool few = cameras < 10;
        EXPECT_EQ(field(say(), "note").find(warning) == 0, few) << say();
        EXPECT_EQ(say().find("are few") != std::string::npos, few);
        const std::string clip = (folder.path / fmt::format("{}.nvv", cameras)).string();
        const ProgramResult trained = run_neuvv({"train", data, "-o", clip, "--segment", "2", "--plan"});
        ASSERT_EQ(trained.code, 0) << trained.err;
        EXPECT_EQ(trained.err.find("note: " + warning) != std::string::npos, few) << trained.err;
        EXPECT_EQ(trained.err.find("are few") != std::string::npos, few) << trained.err;
    }
}

TEST_F(DatasetVerb, ACaptureWithoutMattesNamesTheMend) {
    write_colmap_capture();
    const std::string text = say();
    EXPECT_NE(text.find("data: colmap, calibrated by "), std::string::npos) << text;
    EXPECT_EQ(field(text, "train"), "7 cameras: eye1 eye2 eye3 eye4 eye5 eye6 eye7");
    EXPECT_EQ(field(text, "test"), "2 cameras: eye0 eye8");
    EXPECT_EQ(field(text, "world"), "COLMAP's own unit and axes, not turned");
    EXPECT_EQ(field(text, "lenses").find("pinhole, radial and tangential distortion; focal length 60.0 to 70.0"), 0u)
        << text;
    EXPECT_NE(field(text, "mattes").find("none"), std::string::npos);
    EXPECT_NE(field(text, "mattes").find("neuvv matte "), std::string::npos) << text;
    EXPECT_EQ(field(text, "hull"), "not known without mattes");
    EXPECT_NE(say({"--split", "test"}).find("of the test split"), std::string::npos);

    for (int i = 0; i < 9; ++i)
        test::write_grey_png(folder.path / "data" / "masks" / fmt::format("eye{}.png", i), 64, 48, i == 4 ? 0 : 255);
    const std::string masked = say();
    EXPECT_EQ(field(masked, "masks").find("7; white is the performer, black the background"), 0u) << masked;
    EXPECT_EQ(field(masked, "mattes").find("yes"), 0u) << masked;
}

TEST_F(DatasetVerb, SaysWhichMattesCountAndMatteLeavesThem) {
    write_colmap_capture();
    const std::string data = (folder.path / "data").string();
    for (int i = 0; i < 9; ++i)
        test::write_grey_png(folder.path / "data" / "masks" / fmt::format("eye{}.png", i), 64, 48, i == 4 ? 0 : 255);
    EXPECT_NE(field(say(), "mattes").find("; from masks/"), std::string::npos);
    expect_refused({"matte", data}, 2, {data, "has mattes already, masks/", "--overrule"});
    EXPECT_FALSE(std::filesystem::exists(folder.path / "data" / "mattes"));
    for (int i = 0; i < 9; ++i)
        test::write_grey_png(folder.path / "data" / "mattes" / fmt::format("eye{}_0.png", i), 64, 48, i % 2 ? 0 : 255);
    EXPECT_NE(field(say(), "mattes").find("; from mattes/, which overrules masks/"), std::string::npos) << say();
    EXPECT_EQ(field(say({"--holdout", "eye3"}), "test"), "1 cameras: eye3");
    EXPECT_EQ(field(say({"--holdout", "0"}), "train"), "9 cameras: eye0 eye1 eye2 eye3 eye4 eye5 eye6 eye7 eye8");
}

// What other programs are to read is written whole, and nothing of anybody else is replaced.
TEST_F(DatasetVerb, WritesTransformsForOtherPrograms) {
    write_colmap_capture();
    const std::filesystem::path data = folder.path / "data", out = folder.path / "out";
    const std::vector<std::string> command{"dataset", data.string(), "-o", out.string(), "--as", "transforms"};
    const auto again = [&](std::vector<std::string> more) {
        more.insert(more.begin(), command.begin(), command.end());
        return more;
    };
    expect_refused({"dataset", data.string(), "--as", "transforms"}, 2, {"--as", "--output"});
    const ProgramResult wrote = run_neuvv(command);
    ASSERT_EQ(wrote.code, 0) << wrote.err;
    EXPECT_NE(wrote.out.find("out: 9 images of 7 train and 2 test cameras, without mattes, no plates"),
              std::string::npos)
        << wrote.out;
    EXPECT_NE(wrote.err.find("dataset 9/9"), std::string::npos) << "progress: " << wrote.err;
    EXPECT_FALSE(std::filesystem::exists(out / "unfinished"));
    const ProgramResult read = run_neuvv({"dataset", out.string()});
    EXPECT_EQ(read.code, 0) << read.err;
    EXPECT_NE(read.out.find("train     7 cameras: eye1_0"), std::string::npos) << read.out;
    expect_refused(command, 2, {"out", "is there already", "--overwrite"});

    test::write_grey_png(out / "mattes" / "eye1_0.png", 64, 48);
    const std::string before = read_text(out / "transforms_train.json");
    std::filesystem::resize_file(data / "images" / "eye8.png", 20);
    EXPECT_EQ(run_neuvv(again({"--overwrite"})).code, 2);
    EXPECT_EQ(read_text(out / "transforms_train.json"), before) << "a failure leaves all as it was";
    EXPECT_TRUE(std::filesystem::exists(out / "mattes" / "eye1_0.png"));
    test::write_grey_png(data / "images" / "eye8.png", 64, 48);
    EXPECT_EQ(run_neuvv(again({"--overwrite", "--holdout", "eye3"})).code, 0);
    EXPECT_FALSE(std::filesystem::exists(out / "mattes")) << "of the images that were replaced";
    EXPECT_NE(read_text(out / "transforms_test.json").find("eye3_0.png"), std::string::npos);
    EXPECT_EQ(run_neuvv(again({"--overwrite", "--reduce", "4", "--frames", "0:0"})).code, 0);
    EXPECT_EQ(media::read_png(out / "images" / "eye8_0.png").width, 16u);
    for (const char* frames : {"0:1", "0.5", "2"})
        expect_refused(again({"--overwrite", "--frames", frames}), 2, {"--frames", frames});
    expect_refused(again({"--overwrite", "--reduce", "17"}), 2, {"--reduce"});
    expect_refused({"dataset", data.string(), "--frames", "0:0"}, 2, {"--frames", "--as"});

    const std::string other = (folder.path / "other").string();
    write_text(folder.path / "other" / "images" / "mine.png", "");
    expect_refused({"dataset", data.string(), "-o", other, "--as", "transforms", "--overwrite"}, 2,
                   {"other", "holds other files"});
    for (const std::string& holder : {data.string(), folder.path.string()})
        expect_refused({"dataset", data.string(), "-o", holder, "--as", "transforms", "--overwrite"}, 2,
                       {"holds the data set that is read"});
    expect_refused({"dataset", out.string(), "-o", out.string(), "--as", "transforms", "--overwrite"}, 2,
                   {"holds the data set that is read"});
}

// Mattes that are corrected by hand are the work of hours.
TEST_F(DatasetVerb, MattesAreReplacedAllOrNone) {
    write_colmap_capture();
    const std::filesystem::path data = folder.path / "data", mattes = data / "mattes", from = folder.path / "from";
    const auto bring = [&](int i, uint32_t width, uint8_t value) {
        write_matte(from / fmt::format("eye{}.png", i), width, 0, value);
    };
    const std::vector<std::string> command{"matte", data.string(), "--from", from.string()};
    const auto has_none = [&] { return !std::filesystem::exists(mattes) || std::filesystem::is_empty(mattes); };
    const auto expect_failure = [](const std::vector<std::string>& arguments) {
        const ProgramResult result = run_neuvv(arguments);  // after some progress
        EXPECT_EQ(result.code, 2) << result.err;
        EXPECT_NE(result.err.find("eye8.png: is 63×48"), std::string::npos) << result.err;
    };
    for (int i = 0; i < 9; ++i) bring(i, i == 8 ? 63 : 64, 255);
    expect_failure(command);
    EXPECT_TRUE(has_none()) << "no half of a set";
    for (int i = 0; i < 9; ++i) bring(i, 64, 0);
    const ProgramResult black = run_neuvv(command);
    EXPECT_EQ(black.code, 2);
    EXPECT_NE(black.err.find("no matte shows anything"), std::string::npos) << black.err;
    EXPECT_TRUE(has_none());
    for (int i = 0; i < 9; ++i) bring(i, 64, 255);
    ASSERT_EQ(run_neuvv(command).code, 0) << "the same command begins anew";
    for (int i = 0; i < 9; ++i) bring(i, i == 8 ? 63 : 64, 0);
    std::vector<std::string> again = command;
    again.push_back("--overwrite");
    expect_failure(again);
    size_t white = 0;
    for (const auto& entry : std::filesystem::directory_iterator(mattes)) {
        EXPECT_TRUE(entry.is_regular_file()) << entry.path();
        if (entry.path().stem() != "contact_sheet") white += media::read_png(entry.path()).at(32, 24)[0] == 255;
    }
    EXPECT_EQ(white, 9u) << "those of before";
}

// The images are of one grey, which a network takes for the performer or for nothing.
TEST_F(DatasetVerb, MattesAreMadeByANetwork) {
    write_colmap_capture();
    const std::filesystem::path data = folder.path / "data", mattes = data / "mattes";
    const std::string onnx = (folder.path / "grey.onnx").string();
    const std::vector<std::string> command{"matte", data.string(), "--model", onnx};
    const auto with = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words = command;
        words.insert(words.end(), more.begin(), more.end());
        return words;
    };
    expect_refused(command, 2, {"grey.onnx"});
    const auto one_matte = [&] { return int{*media::read_png(mattes / "eye0_0.png").at(9, 9)}; };
    // MODNet's networks see 0.004 of the grey 128.
    write_text(onnx, test::onnx_of({.size = {1, 3, 48, 64}, .image = "input", .alpha = "output", .bias = 0.8f}));
    const ProgramResult made = run_neuvv(command);
    ASSERT_EQ(made.code, 0) << made.err;
    EXPECT_NE(made.err.find("grey.onnx: MODNet"), std::string::npos) << made.err;
    EXPECT_NE(made.out.find("wrote 9 mattes of 9 cameras"), std::string::npos) << made.out;
    EXPECT_EQ(one_matte(), 205);
    expect_refused(command, 2, {"holds mattes", "--overwrite"});

    write_text(onnx, test::onnx_of({.size = {1, 3, 48, 64}, .weight = 0}));
    const ProgramResult none = run_neuvv(with({"--overwrite"}));
    EXPECT_EQ(none.code, 2);
    EXPECT_NE(none.err.find("grey.onnx: no network that is known"), std::string::npos) << none.err;
    EXPECT_NE(none.err.find("no matte shows anything"), std::string::npos) << none.err;
    EXPECT_EQ(none.err.find("--threshold"), std::string::npos) << none.err;
    EXPECT_EQ(one_matte(), 205) << "those of before";

    write_text(onnx, test::onnx_of({.size = {1, 4, 48, 64}}));
    expect_refused(with({"--overwrite"}), 2, {"grey.onnx", "picture 1×4×48×64", "Robust Video Matting"});
    expect_refused(with({"--from", data.string()}), 2, {"--from", "--model"});
    expect_refused(with({"--threshold", "9"}), 2, {"--threshold", "--model"});
    expect_refused(with({"--alone"}), 2, {"--alone", "--model"});
    expect_refused(with({"--invert"}), 2, {"--invert", "--from"});
}

// Whoever takes black for white learns it before hours of training, and loses no mattes by it.
TEST_F(DatasetVerb, InvertedMattesAreNotWritten) {
    write_colmap_capture();
    const std::filesystem::path data = folder.path / "data", from = folder.path / "from";
    const auto bring = [&](uint8_t border, uint8_t middle) {
        for (int i = 0; i < 9; ++i) write_matte(from / fmt::format("eye{}.png", i), 64, border, middle);
    };
    const std::vector<std::string> command{"matte", data.string(), "--from", from.string()};
    std::vector<std::string> inverted = command;
    inverted.push_back("--invert");
    const auto expect_refusal = [&](const std::vector<std::string>& arguments, const std::string& fix) {
        const ProgramResult result = run_neuvv(arguments);
        EXPECT_EQ(result.code, 2) << result.err;
        EXPECT_NE(result.err.find("100 % of the images' borders would be white"), std::string::npos) << result.err;
        EXPECT_NE(result.err.find(fix), std::string::npos) << result.err;
        EXPECT_FALSE(std::filesystem::exists(data / "mattes" / "eye1_0.png"));
    };
    bring(255, 0);
    expect_refusal(command, "give --invert");
    std::vector<std::string> close_up = command;
    close_up.push_back("--overrule");
    EXPECT_EQ(run_neuvv(close_up).code, 0) << "whose borders may be white";
    std::filesystem::remove_all(data / "mattes");
    bring(0, 255);
    expect_refusal(inverted, "leave --invert out");
    bring(255, 0);
    ASSERT_EQ(run_neuvv(inverted).code, 0);
    EXPECT_EQ(media::read_png(data / "mattes" / "eye1_0.png").at(32, 24)[0], 255);
}

TEST_F(DatasetVerb, TheImagesOfAPhoneAreSaidToBeAStill) {
    for (int i = 0; i < 2; ++i) {
        const auto keyframes = folder.path / "data" / "keyframes";
        write_text(keyframes / "cameras" / fmt::format("{}.json", i),
                   fmt::format(R"({{"fx": 90, "fy": 90, "cx": 32, "cy": 24, "width": 64, "height": 48,
                                    "t_00": 1, "t_01": 0, "t_02": 0, "t_03": {}, "t_10": 0, "t_11": 1, "t_12": 0,
                                    "t_13": 0, "t_20": 0, "t_21": 0, "t_22": 1, "t_23": 0}})",
                               i));
        test::write_grey_png(keyframes / "images" / fmt::format("{}.png", i), 64, 48);
    }
    const std::string text = say();
    EXPECT_EQ(field(text, "world"), "metres, +Y up");
    EXPECT_EQ(field(text, "frames").find('1'), 0u) << text;
    EXPECT_NE(field(text, "note").find("needs several cameras at each moment"), std::string::npos) << text;
}

TEST_F(DatasetVerb, DrawsTheRigAndTheSheet) {
    write_colmap_capture();
    const auto look = folder.path / "look";
    const std::string text = say({"-o", look.string()});
    EXPECT_NE(text.find("wrote " + (look / "rig.png").string()), std::string::npos) << text;
    const media::Image rig = media::read_png(look / "rig.png"), sheet = media::read_png(look / "contact_sheet.png");
    EXPECT_EQ(rig.width, 1280u);
    EXPECT_EQ(sheet.width, 3 * 192u) << "seven images of 64×48 in three columns";
    EXPECT_EQ(sheet.height, 3 * 144u);
    EXPECT_EQ(sheet.at(100, 100)[0], 128) << "the images are grey";
}

TEST_F(DatasetVerb, WrongUseIsBadInput) {
    expect_refused({"dataset"}, 2, {"neuvv dataset --help"});
    expect_refused({"dataset", (folder.path / "none").string()}, 2, {"none", "there is no such folder"});
    expect_refused({"dataset", folder.path.string(), "--format", "vhs"}, 2, {"vhs"});
    expect_refused({"dataset", folder.path.string(), "--split", "both"}, 2, {"both"});
    expect_refused({"dataset", folder.path.string(), "--format", "colmap"}, 2, {"sparse/0"});
}

// Two cameras face each other along x; the box lies between them.
TEST(RigDrawing, CamerasStandWhereTheyDo) {
    std::vector<training::RigCamera> cameras(2);
    for (int i = 0; i < 2; ++i) {
        const stage::Camera from = test::look_at({i == 0 ? -2.0 : 2.0, 0, 0}, {0, 0, 0}, 10, 10);
        cameras[static_cast<size_t>(i)].world_from_camera = from.world_from_camera;
        interchange::Lens& lens = cameras[static_cast<size_t>(i)].lens;
        lens.fx = lens.fy = 10;
        lens.cx = lens.cy = 5;
        lens.width = lens.height = 10;
    }
    cameras[0].name = "left";
    cameras[1].name = "right";
    const media::Image image =
        tools::draw_rig({cameras[0]}, {cameras[1]}, std::pair(glm::dvec3(-0.5), glm::dvec3(0.5)));
    const auto count = [&](uint32_t begin, uint32_t end, auto wanted) {
        size_t found = 0;
        for (uint32_t y = 25; y < 600; ++y)
            for (uint32_t x = begin; x < end; ++x) found += wanted(image.at(x, y)) ? 1 : 0;
        return found;
    };
    const auto blue = [](const uint8_t* p) { return p[2] > 150 && p[0] < 100; };
    const auto orange = [](const uint8_t* p) { return p[0] > 150 && p[2] < 100; };
    const auto black = [](const uint8_t* p) { return p[0] + p[1] + p[2] == 0; };
    for (const uint32_t panel : {0u, 640u}) {
        EXPECT_GT(count(panel, panel + 200, blue), 50u) << "its frustum and its name";
        EXPECT_EQ(count(panel + 200, panel + 639, blue), 0u);
        EXPECT_GT(count(panel + 440, panel + 639, orange), 50u);
        EXPECT_EQ(count(panel, panel + 440, orange), 0u);
        const double side = (640 - 120) / (4 * 1.08);  // pixels of the box's side
        EXPECT_NEAR(static_cast<double>(count(panel + 200, panel + 440, black)), 4 * side, 8);
    }
}

}  // namespace
}  // namespace neuvv
