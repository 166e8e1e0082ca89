// The state of a run is written and read back; damaged states are refused.
#include "training/run/checkpoint.h"
#include "gpu/host_copies.h"
#include "training/run/checkpoint_writer.h"
#include "training/run/schedule.h"

#include <gtest/gtest.h>

#include <bit>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/seconds.h"
#include "support/gpu_test.h"
#include "support/input_error.h"
#include "support/random_tree.h"
#include "support/sphere_capture.h"
#include "training/run/train.h"
#include "voctree/files/nvv.h"
#include "voctree/frames.h"

namespace neuvv::test {
namespace {

// A tree whose weights cannot be represented in half precision.
voctree::VOctree some_tree() {
    voctree::VOctree tree = random_tree({.seed = 5, .leaves = 200, .bases = 5, .hh_degree = 2, .frames = 6});
    Random random(6);
    for (float& weight : tree.weights) weight += static_cast<float>(1e-5 * random.bell());
    return tree;
}

training::RunState some_run() {
    return {.seed = 0xfedcba9876543210u,
            .step = 1234567890,
            .adam_step = 77,
            .phase = 2,
            .phase_rays = 1u << 31,
            .dataset_hash = 987654321,
            .max_depth = 4,
            .resolution_is_natural = true,
            .several_rays_from = 77,
            .max_leaves = 123456,
            .max_bytes = 60000000,
            .adaptive = false,
            .colour_choice = training::ColourChoice::kOpen,
            .left_out = 5,
            .elapsed_s = 12.5,
            .other_s = 3.25,
            .rays = 3e12,
            .squared_error = 0.0625,
            .minutes = 0.25,
            .steps = 0,
            .tiles_per_step = 300,
            .weights = {0.25f, 0.5f, 0.125f},
            .program = "NeuVV of the past"};
}

// Uploads recognisable numbers as moments and as use of the leaves; returns the first moments of the weights.
std::vector<float> fill_moments(const gpu::Device& device, const training::TrainingStep& step) {
    Random random(8);
    const auto put = [&](const gpu::Buffer& buffer, size_t count, double low) {
        std::vector<float> values(count);
        for (float& value : values) value = static_cast<float>(random.uniform(low, 1));
        gpu::upload(device, buffer, values.data(), count * sizeof(float));
        return values;
    };
    const training::Moments& moments = step.moments();
    const size_t numbers = size_t{4} * step.field().planes() * step.field().leaf_count;
    const size_t rows = size_t{2} * step.field().frames * step.field().bases;
    put(moments.second, numbers, 0);
    put(moments.rows_first, rows, -1);
    put(moments.rows_second, rows, 0);
    training::LeafUse use;
    for (uint32_t i = 0; i < step.field().leaf_count; ++i) {
        use.max_weight.push_back(static_cast<float>(random.uniform()));
        use.opacity_sensitivity.push_back(static_cast<float>(random.uniform()));
    }
    for (size_t i = 0; i < size_t{(step.field().frames + 31) / 32} * step.field().leaf_count; ++i)
        use.frames.push_back(static_cast<uint32_t>(random.below(1u << 31)));
    training::write_use(device, step.tally(), use);
    return put(moments.first, numbers, -1);
}

using CheckpointTest = GpuTest;

TEST_F(CheckpointTest, RoundTripKeepsWeightsMomentsAndRun) {
    const TemporaryFolder folder;
    const std::filesystem::path nvv = folder.path / "scene.nvv";
    const voctree::VOctree tree = some_tree();
    const training::TrainingStep step(device(), tree, 1, 1);
    const std::vector<float> first = fill_moments(device(), step);
    const training::Checkpoint saved = training::take_checkpoint(step, tree, some_run());
    EXPECT_EQ(saved.tree.weights, tree.weights);
    training::save_checkpoint(nvv, saved);
    const training::Checkpoint loaded = training::load_checkpoint(nvv);

    EXPECT_EQ(loaded.tree.weights, tree.weights);  // bit for bit
    EXPECT_EQ(loaded.tree.sigma_basis, tree.sigma_basis);
    EXPECT_EQ(loaded.tree.gamma_basis, tree.gamma_basis);
    EXPECT_EQ(loaded.tree.children, tree.children);
    ASSERT_EQ(loaded.first.size(), first.size());
    for (size_t i = 0; i < first.size(); ++i) {
        const float kept = std::bit_cast<float>(uint32_t{loaded.first[i]} << 16);
        ASSERT_NEAR(kept, first[i], std::abs(first[i]) / 256);  // bfloat16
    }
    const training::RunState run = some_run();
    EXPECT_EQ(loaded.run.seed, run.seed);
    EXPECT_EQ(loaded.run.step, run.step);
    EXPECT_EQ(loaded.run.adam_step, run.adam_step);
    EXPECT_EQ(loaded.run.phase, run.phase);
    EXPECT_EQ(loaded.run.phase_rays, run.phase_rays);
    EXPECT_EQ(loaded.run.dataset_hash, run.dataset_hash);
    EXPECT_EQ(loaded.run.max_depth, run.max_depth);
    EXPECT_EQ(loaded.run.several_rays_from, run.several_rays_from);
    EXPECT_EQ(loaded.run.max_leaves, run.max_leaves);
    EXPECT_EQ(loaded.run.max_bytes, run.max_bytes);
    EXPECT_EQ(loaded.run.adaptive, run.adaptive);
    EXPECT_EQ(loaded.run.colour_choice, run.colour_choice);
    EXPECT_EQ(loaded.run.resolution_is_natural, run.resolution_is_natural);
    EXPECT_EQ(loaded.run.left_out, run.left_out);
    EXPECT_EQ(loaded.run.elapsed_s, run.elapsed_s);
    EXPECT_EQ(loaded.run.other_s, run.other_s);
    EXPECT_EQ(loaded.run.rays, run.rays);
    EXPECT_EQ(loaded.run.squared_error, run.squared_error);
    EXPECT_EQ(loaded.run.minutes, run.minutes);
    EXPECT_EQ(loaded.run.steps, run.steps);
    EXPECT_EQ(loaded.run.tiles_per_step, run.tiles_per_step);
    EXPECT_EQ(loaded.run.weights.grad, run.weights.grad);
    EXPECT_EQ(loaded.run.weights.point, run.weights.point);
    EXPECT_EQ(loaded.run.weights.smoothness, run.weights.smoothness);
    EXPECT_EQ(loaded.run.program, run.program);
    EXPECT_EQ(folder.entries(), 2u) << "nothing lies about";
    voctree::VOctree written = tree;
    voctree::drop_empty_leaves(written);
    EXPECT_EQ(voctree::read_nvv(nvv).leaf_count, written.leaf_count);
}

TEST_F(CheckpointTest, ARestoredStepIsTheOldOne) {
    const TemporaryFolder folder;
    const std::filesystem::path nvv = folder.path / "scene.nvv";
    const voctree::VOctree tree = some_tree();
    const training::TrainingStep step(device(), tree, 1, 1);
    fill_moments(device(), step);
    const training::Checkpoint before = training::take_checkpoint(step, tree, some_run());
    training::save_checkpoint(nvv, before);
    const training::Checkpoint loaded = training::load_checkpoint(nvv);
    const training::TrainingStep resumed(device(), loaded.tree, 1, 1);
    training::restore_moments(device(), resumed, loaded);
    const training::Checkpoint after = training::take_checkpoint(resumed, loaded.tree, loaded.run);
    EXPECT_EQ(after.tree.weights, before.tree.weights);
    EXPECT_EQ(after.first, before.first);
    EXPECT_EQ(after.second, before.second);
    EXPECT_EQ(after.rows_first, before.rows_first);
    EXPECT_EQ(after.rows_second, before.rows_second);
    EXPECT_EQ(after.use.max_weight, before.use.max_weight);
    EXPECT_EQ(after.use.opacity_sensitivity, before.use.opacity_sensitivity);
    EXPECT_EQ(after.use.frames, before.use.frames);
}

// A checkpoint file on disk. Tests with it need no device.
struct StateFile {
    TemporaryFolder folder;
    std::filesystem::path nvv = folder.path / "scene.nvv", state = training::state_path(nvv);
    training::Checkpoint checkpoint{some_run(), some_tree(), {}, {}, {}, {}, {}};

    StateFile() {
        voctree::VOctree& tree = checkpoint.tree;
        checkpoint.first.resize(size_t{4} * tree.leaf_count * (4 + hh_count(tree.hh_degree)));
        checkpoint.second = checkpoint.first;
        checkpoint.rows_first.resize(size_t{2} * tree.frames * tree.bases);
        checkpoint.rows_second = checkpoint.rows_first;
        checkpoint.use.max_weight.resize(tree.leaf_count);
        checkpoint.use.opacity_sensitivity.resize(tree.leaf_count);
        checkpoint.use.frames.resize(size_t{(tree.frames + 31) / 32} * tree.leaf_count);
        checkpoint.colours = training::CameraColours(2, 6, {.colour = true, .exposure = true, .vignetting = true});
        checkpoint.colours.values[1].rows[0].r = 1.25f;
        checkpoint.colours.first[0].rows[2].a = -0.5f;
        checkpoint.colours.second[1].rows[1].g = 0.25f;
        checkpoint.colours.exposures.values[7] = 0.5f;
        checkpoint.colours.exposures.second[11] = 0.125f;
        checkpoint.colours.vignettes.values[3] = -0.25f;
        training::save_checkpoint(nvv, checkpoint);
    }
    // Writes the state again with one chunk replaced, or removed where `bytes` is null.
    void rewrite(const std::string& name, const std::vector<uint8_t>* bytes) const {
        std::vector<voctree::NvvChunk> chunks;
        const voctree::VOctree tree = voctree::read_nvv(state, &chunks);
        std::erase_if(chunks, [&](const voctree::NvvChunk& chunk) { return chunk.name == name; });
        if (bytes) chunks.push_back({name, *bytes});
        voctree::write_nvv(state, tree, {chunks.begin(), chunks.end()});
    }
    void refused(std::initializer_list<std::string> parts) const {
        expect_input_error([&] { training::load_checkpoint(nvv); }, parts);
    }
};

TEST(CheckpointFile, LoadsAsWritten) {
    const StateFile file;
    EXPECT_EQ(training::load_checkpoint(file.nvv).tree.weights, file.checkpoint.tree.weights);
}

TEST(CheckpointFile, RefusesAMissingState) {
    const StateFile file;
    std::filesystem::remove(file.state);
    file.refused({"scene.nvv.state"});
}

TEST(CheckpointFile, RefusesATruncatedState) {
    const StateFile file;
    const std::string whole = read_text(file.state);
    for (const size_t size : {size_t{0}, size_t{5}, size_t{40}, whole.size() / 2, whole.size() - 1}) {
        write_text(file.state, whole.substr(0, size));
        file.refused({"scene.nvv.state"});
    }
}

TEST(CheckpointFile, RefusesACorruptState) {
    const StateFile file;
    const std::string whole = read_text(file.state);
    for (size_t i = 1; i < 20; ++i) {
        std::string bad = whole;
        bad[i * (whole.size() - 1) / 20] ^= 0x10;
        write_text(file.state, bad);
        file.refused({"scene.nvv.state"});
    }
}

TEST(CheckpointFile, RefusesFilesOfAnotherKind) {
    const StateFile file;
    std::filesystem::copy_file(file.nvv, file.state, std::filesystem::copy_options::overwrite_existing);
    file.refused({"scene.nvv.state", "run0", "train anew"});
    write_text(file.state, "{\"step\": 3}");
    file.refused({"scene.nvv.state"});
}

TEST(CheckpointFile, RefusesChunksThatAreMissingOrDoNotFit) {
    for (const char* name :
         {"wf32", "mom1", "mom2", "row1", "row2", "rech", "cam1", "cam2", "exp1", "exp2", "vig1", "vig2"}) {
        const std::vector<uint8_t> short_bytes(12);
        const StateFile file;
        file.rewrite(name, &short_bytes);
        file.refused({"scene.nvv.state", name, "does not fit"});
        file.rewrite(name, nullptr);
        file.refused({"scene.nvv.state", name, "missing"});
    }
}

TEST(CheckpointFile, KeepsTheColoursOfCameras) {
    const StateFile file;
    const training::CameraColours read = training::load_checkpoint(file.nvv).colours;
    ASSERT_EQ(read.values.size(), 2u);
    EXPECT_EQ(read.values[1].rows[0], glm::vec4(1.25f, 0, 0, 0));
    EXPECT_EQ(read.first[0].rows[2], glm::vec4(0, 0, 0, -0.5f));
    EXPECT_EQ(read.second[1].rows[1], glm::vec4(0, 0.25f, 0, 0));
    EXPECT_EQ(read.frames(), 6u);
    EXPECT_EQ(read.exposures.values[7], 0.5f);
    EXPECT_EQ(read.exposures.second[11], 0.125f);
    EXPECT_EQ(read.vignettes.values[3], -0.25f);
}

TEST(CheckpointFile, RefusesColoursThatNoRunCanLearn) {
    for (const size_t bytes : {size_t{0}, size_t{12}, sizeof(CameraColour)}) {
        const StateFile file;
        const std::vector<uint8_t> zeros(bytes);
        file.rewrite("camc", &zeros);
        file.refused({"scene.nvv.state", "cam"});
    }
    const StateFile file;
    const std::vector<uint8_t> black(sizeof(CameraColour) * 2);
    file.rewrite("camc", &black);
    file.refused({"scene.nvv.state", "camc", "out of bounds"});
    const StateFile other;
    std::vector<uint8_t> negative(sizeof(CameraColour) * 2);
    negative[3] = 0xbf;  // −0.5
    other.rewrite("cam2", &negative);
    other.refused({"scene.nvv.state", "cam2", "below 0"});
}

TEST(CheckpointFile, RefusesExposuresAndVignettesThatNoRunCanLearn) {
    for (const auto& [name, numbers] : {std::pair{"expo", 12}, {"vign", 4}}) {
        const StateFile file;
        std::vector<float> bright(static_cast<size_t>(numbers), 0);
        bright[1] = 0.75f;
        std::vector<uint8_t> bytes(bright.size() * sizeof(float));
        std::memcpy(bytes.data(), bright.data(), bytes.size());
        file.rewrite(name, &bytes);
        file.refused({"scene.nvv.state", name, "out of bounds"});
        bytes.assign(bytes.size() - 4, 0);
        file.rewrite(name, &bytes);
        file.refused({"scene.nvv.state", "fit"});
    }
}

TEST(CheckpointFile, RefusesPosesThatNoRunCanFind) {
    const StateFile file;
    std::vector<uint8_t> poses(sizeof(training::PoseChange) * 2);
    poses[6] = 0xf0, poses[7] = 0x7f;  // infinity
    file.rewrite("pose", &poses);
    file.refused({"scene.nvv.state", "pose", "no run can find"});
    file.rewrite("late", &poses);
    file.refused({"scene.nvv.state", "pose", "no run can find"});
    file.rewrite("pose", nullptr);
    file.refused({"scene.nvv.state", "late", "no run can find"});
    file.rewrite("roll", &poses);
    file.rewrite("late", nullptr);
    file.refused({"scene.nvv.state", "roll", "no run can find"});
    file.rewrite("roll", nullptr);
    const double zoom = 1;  // a factor of 2.7
    poses.assign(poses.size(), 0);
    std::memcpy(poses.data() + 6 * sizeof(double), &zoom, sizeof(double));
    file.rewrite("late", nullptr);
    file.rewrite("pose", &poses);
    file.refused({"scene.nvv.state", "pose", "no run can find"});
    poses.resize(9);
    file.rewrite("late", nullptr);
    file.rewrite("pose", &poses);
    file.refused({"scene.nvv.state", "pose"});
}

TEST(CheckpointFile, RefusesNumbersThatAreNotFinite) {
    for (const char* name : {"wf32", "row1", "row2", "rech", "mom1", "mom2", "camc", "cam1", "cam2"}) {
        const StateFile file;
        std::vector<voctree::NvvChunk> chunks;
        voctree::read_nvv(file.state, &chunks);
        for (voctree::NvvChunk& chunk : chunks) {
            if (chunk.name != name) continue;
            std::fill_n(chunk.bytes.begin(), 4, uint8_t{0xff});  // NaN
            file.rewrite(name, &chunk.bytes);
        }
        file.refused({"scene.nvv.state", name, "finite"});
    }
}

TEST(CheckpointFile, NumbersThatAreNotFiniteDoNotReplaceTheLastState) {
    const StateFile file;
    training::Checkpoint checkpoint = file.checkpoint;
    checkpoint.tree.weights[17] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(training::save_checkpoint(file.nvv, checkpoint), RuntimeFailure);
    EXPECT_EQ(training::load_checkpoint(file.nvv).tree.weights, file.checkpoint.tree.weights);
}

TEST(CheckpointFile, AWriterTellsWhatFailedAndGoesOn) {
    const StateFile file;
    training::CheckpointWriter writer;
    EXPECT_EQ(writer.next_will_take_s(100), 0);
    writer.begin(file.folder.path / "nowhere" / "scene.nvv", file.checkpoint, seconds_now());
    EXPECT_THROW(writer.wait(), RuntimeFailure);
    EXPECT_EQ(writer.last().step, 0u);
    writer.begin(file.nvv, file.checkpoint, seconds_now() - 1);
    writer.wait();
    EXPECT_EQ(writer.last().step, file.checkpoint.run.step);
    EXPECT_EQ(writer.last().tree_leaves, file.checkpoint.tree.leaf_count);
    EXPECT_EQ(writer.last().bytes, std::filesystem::file_size(file.nvv));
    EXPECT_GE(writer.last().took_s, 1);
    EXPECT_GE(writer.next_will_take_s(2 * file.checkpoint.tree.leaf_count), 2);
    EXPECT_EQ(training::load_checkpoint(file.nvv).tree.weights, file.checkpoint.tree.weights);
}

TEST(CheckpointFile, RefusesARunOutOfRange) {
    const nlohmann::json good = {{"seed", 1},
                                 {"step", 1},
                                 {"adam_step", 1},
                                 {"stage", 0},
                                 {"stage_rays", 0},
                                 {"dataset_hash", 1},
                                 {"several_from", 9},
                                 {"max_leaves", 0},
                                 {"max_bytes", 0},
                                 {"adaptive", true},
                                 {"max_depth", 4},
                                 {"elapsed_s", 1.0},
                                 {"other_s", 0.5},
                                 {"rays", 1.0},
                                 {"minutes", 1.0},
                                 {"steps", 0},
                                 {"tiles_per_step", 512},
                                 {"lambda_grad", 0.1},
                                 {"lambda_point", 0.2},
                                 {"lambda_smooth", 0.0},
                                 {"program", "NeuVV"}};
    const StateFile file;
    const auto put = [&](const nlohmann::json& json) {
        const std::string text = json.dump();
        const std::vector<uint8_t> bytes(text.begin(), text.end());
        file.rewrite("run0", &bytes);
    };
    put(good);
    EXPECT_EQ(training::load_checkpoint(file.nvv).run.max_depth, 4u);
    nlohmann::json wrong_error = good;  // older programs did not write it
    wrong_error["squared_error"] = -1;
    put(wrong_error);
    file.refused({"scene.nvv.state", "run0"});
    const std::pair<const char*, nlohmann::json> kBad[] = {{"max_depth", 0},
                                                           {"max_depth", 5},  // the tree has four levels
                                                           {"max_depth", 999},
                                                           {"elapsed_s", -1},
                                                           {"other_s", -1},
                                                           {"other_s", 2},
                                                           {"minutes", -1},
                                                           {"step", "many"},
                                                           {"stage", training::kPhaseCount},
                                                           {"stage", 4294967297},
                                                           {"adam_step", 4294967295},
                                                           {"step", 1e300},
                                                           {"rays", -1},
                                                           {"adam_step", -1},
                                                           {"seed", nullptr},
                                                           {"tiles_per_step", 0},
                                                           {"tiles_per_step", 65537},
                                                           {"lambda_grad", -1},
                                                           {"lambda_point", 1e300},
                                                           {"lambda_smooth", "much"},
                                                           {"program", 7}};
    for (const auto& [key, value] : kBad) {
        SCOPED_TRACE(key);
        nlohmann::json bad = good;
        bad[key] = value;
        put(bad);
        file.refused({"scene.nvv.state", "run0"});
        bad.erase(key);
        put(bad);
        file.refused({"scene.nvv.state", "run0"});
    }
}

TEST_F(CheckpointTest, AnotherDataSetIsRefusedOnResume) {
    const StateFile file;  // six frames
    training::Dataset dataset = sphere_dataset({.cameras = 3, .frames = 2, .size = 16});
    training::TrainSettings settings;
    settings.resume = true;
    settings.steps = 1;
    expect_input_error(
        [&] {
            training::train(device(), dataset, settings, file.nvv, [](const training::TrainProgress&) { return true; });
        },
        {"scene.nvv.state", "frames", "data set"});
}

}  // namespace
}  // namespace neuvv::test
