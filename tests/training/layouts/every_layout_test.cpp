// What holds in every layout, shown by the small data sets of the fuzzer: cameras held out by the user, and plates.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "support/input_error.h"
#include "support/rig_pixel.h"
#include "support/temporary_folder.h"
#include "training/data/dataset.h"
#include "training/data/layouts/formats.h"

namespace neuvv {
namespace {

using training::Split;

const std::filesystem::path kCorpus = NEUVV_SOURCE_DIR "/tests/fuzz/corpus";

// The data sets, by their layout and their folder in the corpus.
std::multimap<std::string, std::filesystem::path> samples() {
    std::multimap<std::string, std::filesystem::path> found;
    for (const auto& layout : std::filesystem::directory_iterator(kCorpus))
        for (const auto& sample : std::filesystem::directory_iterator(layout)) try {
                found.emplace(training::read_rig(sample, Split::kTrain, "auto", "0").format, sample);
            } catch (const InputError&) {  // a clip, a stage, a skeleton
            }
    return found;
}

std::set<std::string> names_of(const training::Rig& rig) {
    std::set<std::string> names;
    for (const training::RigCamera& camera : rig.cameras) names.insert(camera.name);
    return names;
}

struct EveryLayout : testing::Test {
    TemporaryFolder folder;

    // A copy of the sample, to which files may be added.
    std::filesystem::path copy_of(const std::filesystem::path& sample) const {
        const std::filesystem::path copy = folder.path / sample.parent_path().filename() / sample.filename();
        std::filesystem::create_directories(copy.parent_path());
        std::filesystem::copy(sample, copy, std::filesystem::copy_options::recursive);
        return copy;
    }
};

TEST_F(EveryLayout, HasASample) {
    const auto found = samples();
    for (const std::string& format : training::format_names())
        if (format != training::kAnyFormat) {
            EXPECT_TRUE(found.contains(format)) << "tests/fuzz/corpus has none of " << format;
        }
}

// As the program does that calibrates, or that reads these files otherwise.
TEST_F(EveryLayout, ExifTurnsImagesOfThese) {
    std::set<std::string> turned;
    for (const auto& [format, sample] : samples())
        if (!training::read_rig(sample, Split::kTrain, "auto", "0").images_as_stored) turned.insert(format);
    turned.erase("n3v");  // which has only videos
    EXPECT_EQ(turned, (std::set<std::string>{"actorshq", "easymocap", "opencv", "pose2sim", "qualisys"}));
}

TEST_F(EveryLayout, TheUserHoldsOutCameras) {
    for (const auto& [format, sample] : samples()) {
        const auto read = [&, from = sample](Split split, const std::string& holdout) {
            return training::read_rig(from, split, "auto", holdout);
        };
        const std::set<std::string> all = names_of(read(Split::kTrain, "0"));
        ASSERT_GE(all.size(), 2u) << sample;
        for (const std::string& name : all) {
            std::set<std::string> others = all;
            others.erase(name);
            EXPECT_EQ(names_of(read(Split::kTest, name + ",")), std::set{name}) << sample;
            EXPECT_EQ(names_of(read(Split::kTrain, name + ",")), others) << sample;
        }
        EXPECT_EQ(names_of(read(Split::kTest, "1")).size(), 1u) << sample;
        expect_input_error([&] { read(Split::kTest, "0"); }, {"holds out no camera"});
        expect_input_error([&] { read(Split::kTrain, "nobody"); }, {"nobody", "is no camera"});
    }
}

TEST_F(EveryLayout, PlatesAreFound) {
    for (const auto& [format, sample] : samples()) {
        const std::filesystem::path data = copy_of(sample);
        const training::Rig before = training::read_rig(data, Split::kTrain, "auto", "0");
        const training::Dataset images =
            training::load_dataset(data, Split::kTrain, {.holdout = "0", .mattes_needed = false});
        std::map<std::string, std::filesystem::path> own;  // plates that the files name, which count
        for (size_t c = 0; c < before.cameras.size(); ++c) {
            const training::RigCamera& camera = before.cameras[c];
            if (!camera.plate.path.empty()) own[camera.name] = camera.plate.path;
            test::write_grey_png(data / "plates" / (camera.name + ".png"), images.cameras[c].width,
                                 images.cameras[c].height, 90);
        }
        const training::Rig rig = training::read_rig(data, Split::kTrain, "auto", "0");
        ASSERT_EQ(rig.cameras.size(), before.cameras.size()) << sample;
        EXPECT_EQ(rig.format, format);
        for (const training::RigCamera& camera : rig.cameras)
            EXPECT_EQ(camera.plate.path,
                      own.contains(camera.name) ? own.at(camera.name) : data / "plates" / (camera.name + ".png"))
                << sample;
        const training::Dataset read =
            training::load_dataset(data, Split::kTrain, {.holdout = "0", .mattes_needed = false});
        for (const media::Image& plate : read.plates) EXPECT_GT(plate.width, 0u) << sample;
    }
}

}  // namespace
}  // namespace neuvv
