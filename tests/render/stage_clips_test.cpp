// Long clips on a stage: a few segments at a time are on the device, and what is drawn does not depend on which.
#include "render/clips/stage_clips.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <thread>

#include "render/clips/stage_renderer.h"
#include "stream/transport/nvs_writer.h"
#include "support/gpu_test.h"
#include "support/input_error.h"
#include "support/look_at.h"
#include "support/random_tree.h"
#include "support/segmented_copy.h"
#include "support/stage_on_disk.h"
#include "support/temporary_folder.h"
#include "voctree/coarse.h"
#include "voctree/files/clip.h"
#include "voctree/files/nvpaint.h"
#include "voctree/tree_slice.h"

namespace neuvv::test::stage_clips_test {
namespace {

using render::MissingSegments;

constexpr uint32_t kSegments = 12;
constexpr double kSegment_s = 0.5;

// A clip of 12 segments of two frames, which take half a second each, on a stage.
struct StageClipsTest : GpuTest {
    TemporaryFolder folder;
    std::filesystem::path clip = folder.path / "long.nvv";
    std::unique_ptr<stage::Stage> stage;

    void SetUp() override {
        GpuTest::SetUp();
        write_clip(0);
    }
    void write_clip(uint32_t overlap,
                    const RandomTreeOptions& options = {.leaves = 300, .bases = 24, .frames = 2 * kSegments}) {
        voctree::VOctree tree = random_tree(options);
        tree.fps = 4;
        std::filesystem::remove_all(clip);
        write_segmented_copy(tree, std::vector<uint32_t>(kSegments, 2), clip, overlap);
        write_stage(folder.path / "show.gltf", clip, "anna");
        stage = std::make_unique<stage::Stage>(stage::load_stage(folder.path / "show.gltf"));
    }
    std::filesystem::path segment(uint32_t number) const { return clip / voctree::segment_file_name(2 * number); }
    static double middle_of(uint32_t number) { return (number + 0.25) * kSegment_s; }

    // A follower of the stage without a renderer.
    struct Follower {
        StageClipsTest& test;
        render::StageClips clips{render::StageLoader(device()).load(*test.stage)};

        // Where the performer is at a time, after the clips have followed the stage to it.
        std::optional<render::StageClips::Place> at(double time_s, MissingSegments missing) {
            const stage::EvaluatedStage evaluated = stage::stage_at(*test.stage, time_s);
            clips.follow(*test.stage, evaluated, missing);
            if (missing == MissingSegments::kWait) clips.read_missing(evaluated);
            clips.free_dropped();
            const auto places = clips.places_of(evaluated.performers[0]);
            return places.empty() ? std::nullopt : std::optional(places[0]);
        }
        const render::Field* field_of(uint32_t number) const {
            const auto& loaded = clips.clips()[0].segments[number].loaded;
            return loaded ? &loaded->field : nullptr;
        }
        // Follows the stage at a time that does not change until `done`; false after a minute.
        bool until(double time_s, const std::function<bool()>& done) {
            for (int i = 0; i < 60'000 && !done(); ++i) {
                at(time_s, MissingSegments::kHold);
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
            return done();
        }
    };
};

media::Image image_at(render::StageRenderer& renderer, const stage::Stage& stage, double time_s) {
    const stage::EvaluatedStage evaluated = stage::stage_at(stage, time_s);
    renderer.show(evaluated);
    return renderer.frames().render(look_at({0, 0.4, 4}, {0, 0.5, 0}, 48, 36, 1), renderer.settings_at(evaluated));
}

TEST_F(StageClipsTest, ASegmentFadesIntoTheNext) {
    write_clip(1);
    constexpr double kFirstOfThird_s = 2 * kSegment_s;
    render::StageRenderer renderer(device(), *stage, render::StageLoader(device()).load(*stage), {48, 36});
    stage::EvaluatedStage evaluated = stage::stage_at(*stage, kFirstOfThird_s);
    renderer.show(evaluated);
    const auto instances = [&] { return renderer.settings_at(evaluated).instances; };
    ASSERT_EQ(instances().size(), 2u);
    EXPECT_NE(instances()[0].field, instances()[1].field);
    EXPECT_EQ(instances()[0].frame, 0);
    EXPECT_EQ(instances()[1].frame, 2) << "the frame that it has more";
    for (const render::Instance& instance : instances()) EXPECT_EQ(instance.density, 0.5f);
    ASSERT_TRUE(renderer.instance_of(evaluated.performers[0]));
    EXPECT_EQ(renderer.instance_of(evaluated.performers[0])->density, 1) << "what is picked is whole";

    evaluated.performers[0].opacity = 0.5f;
    ASSERT_EQ(instances().size(), 1u) << "two translucent ones let less light through than one";
    EXPECT_EQ(instances()[0].density, 1);

    // Where the next one is missing, this one is shown as long as it goes.
    std::filesystem::remove(segment(2));
    Follower follower{*this};
    const auto alone = follower.at(kFirstOfThird_s, MissingSegments::kWait);
    ASSERT_TRUE(alone);
    EXPECT_EQ(alone->field, follower.field_of(1));
    EXPECT_EQ(alone->frame, 2);
    EXPECT_EQ(alone->share, 1);
    EXPECT_FALSE(follower.at(kFirstOfThird_s + 0.25, MissingSegments::kWait)) << "a frame behind the overlap";
}

TEST_F(StageClipsTest, ImagesDoNotDependOnWhatWasShownBefore) {
    render::StageRenderer renderer(device(), *stage, render::StageLoader(device()).load(*stage), {48, 36});
    media::Image last;
    for (const uint32_t number : {0u, 1u, 2u, 3u, 11u, 4u, 3u, 0u}) {
        const media::Image image = image_at(renderer, *stage, middle_of(number));
        render::StageRenderer fresh(device(), *stage, render::StageLoader(device()).load(*stage), {48, 36});
        EXPECT_EQ(image.rgba, image_at(fresh, *stage, middle_of(number)).rgba) << number;
        EXPECT_NE(image.rgba, last.rgba) << number;
        last = image;
    }
}

TEST_F(StageClipsTest, MemoryDoesNotGrowWithTheClip) {
    render::StageRenderer renderer(device(), *stage, render::StageLoader(device()).load(*stage), {48, 36});
    uint64_t early = 0, late = 0;
    for (double time_s = 0; time_s < kSegments * kSegment_s; time_s += 0.1) {
        image_at(renderer, *stage, time_s);
        uint64_t& most = time_s < 2.5 * kSegment_s ? early : late;
        most = std::max(most, device().buffer_bytes());
    }
    EXPECT_LE(late, early * 23 / 20) << "some slices have room for more entries";
    Follower follower{*this};
    for (uint32_t number = 0; number < kSegments; ++number) {
        follower.at(middle_of(number), MissingSegments::kWait);
        EXPECT_LE(follower.clips.fields().size(), render::kSegmentsOnDevice);
        EXPECT_NE(follower.field_of(number), nullptr);
    }
}

// With less and less memory, until a segment is read only because slices go.
TEST_F(StageClipsTest, SegmentsTakeTheMemoryOfSlicesWhereThereIsNoOther) {
    write_clip(0, {.node_levels = 3, .leaves = 3000, .bases = 4, .hh_degree = 2, .frames = 2 * kSegments});
    const double time_s = middle_of(kSegments - 1);
    const stage::EvaluatedStage evaluated = stage::stage_at(*stage, time_s);
    for (const MissingSegments missing : {MissingSegments::kWait, MissingSegments::kHold}) {
        media::Image expected;
        // Less and less memory, until slices have to go. Below 0 it is that which segments had that are gone by then.
        constexpr int64_t kStep = 100'000;
        for (int64_t more_bytes = 20 * kStep;; more_bytes -= more_bytes > 5 * kStep ? more_bytes / 5 : kStep) {
            render::StageRenderer renderer(device(), *stage, render::StageLoader(device()).load(*stage), {48, 36});
            if (expected.rgba.empty()) expected = image_at(renderer, *stage, time_s);
            // As many segments as are kept, so that no thread reads one while the memory that they take is counted.
            for (uint32_t number = render::kSegmentsOnDevice; number-- > 0;)
                image_at(renderer, *stage, middle_of(number));
            const uint64_t budget = renderer.frames().slices().budget();
            device().memory_pool().clear(device().handle());
            device().limit_memory(
                static_cast<uint64_t>(static_cast<int64_t>(device().memory_pool().allocated()) + more_bytes));
            const auto shown_within = [&](int steps) {
                renderer.show(evaluated, true, missing);
                for (int i = 0; i < steps && !renderer.shows_all(evaluated); ++i) {
                    std::this_thread::sleep_for(std::chrono::milliseconds(5));
                    renderer.show(evaluated, true, missing);
                }
                return renderer.shows_all(evaluated);
            };
            EXPECT_NO_THROW(EXPECT_TRUE(shown_within(12'000)));
            EXPECT_TRUE(renderer.take_problems().empty());
            device().limit_memory(std::nullopt);
            EXPECT_EQ(image_at(renderer, *stage, time_s).rgba, expected.rgba);
            if (renderer.frames().slices().budget() < budget || HasFailure()) break;
            ASSERT_GT(more_bytes, -50 * kStep);
        }
    }
}

// As a paused window does, which shows again and again and draws nothing.
TEST_F(StageClipsTest, ASegmentForWhichThereIsNoMemoryIsReportedOnce) {
    write_clip(0, {.node_levels = 3, .leaves = 3000, .bases = 4, .hh_degree = 2, .frames = 2 * kSegments});
    const stage::EvaluatedStage evaluated = stage::stage_at(*stage, middle_of(kSegments - 1));
    render::StageRenderer renderer(device(), *stage, render::StageLoader(device()).load(*stage), {48, 36});
    image_at(renderer, *stage, middle_of(0));
    device().memory_pool().clear(device().handle());
    device().limit_memory(1);  // what slices had is not enough, either
    std::vector<Note> problems;
    // Within a minute it is told; what is told again would be so at once.
    constexpr int kMore = 200;
    for (int i = 0, last = 12'000; i < last && problems.size() < 2; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        renderer.show(evaluated, true, MissingSegments::kHold);
        for (Note& problem : renderer.take_problems()) {
            problems.push_back(std::move(problem));
            last = i + kMore;
        }
    }
    device().limit_memory(std::nullopt);
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_NE(problems[0].words().find("no memory left"), std::string::npos) << problems[0].words();
}

TEST_F(StageClipsTest, AfterASeekThePerformerStaysUntilTheSegmentIsRead) {
    Follower follower{*this};
    const auto before = follower.at(middle_of(0), MissingSegments::kHold);
    ASSERT_TRUE(before);
    EXPECT_EQ(before->field, follower.field_of(0));
    const auto held = follower.at(middle_of(9), MissingSegments::kHold);
    ASSERT_TRUE(held);
    EXPECT_EQ(held->field, before->field);
    EXPECT_EQ(held->frame, before->frame);
    ASSERT_TRUE(follower.until(middle_of(9), [&] { return follower.field_of(9) != nullptr; }));
    const auto there = follower.at(middle_of(9), MissingSegments::kHold);
    ASSERT_TRUE(there);
    EXPECT_EQ(there->field, follower.field_of(9));
    EXPECT_FLOAT_EQ(there->frame, 0.5f);
}

TEST_F(StageClipsTest, SegmentsAreReadAheadInTheClocksDirection) {
    Follower follower{*this};
    ASSERT_TRUE(follower.until(middle_of(0), [&] { return follower.field_of(4) != nullptr; }));
    for (const uint32_t number : {1u, 2u, 3u}) EXPECT_NE(follower.field_of(number), nullptr) << number;
    follower.at(middle_of(9), MissingSegments::kWait);
    follower.at(middle_of(9) - 0.1, MissingSegments::kHold);
    EXPECT_TRUE(follower.until(middle_of(9) - 0.1, [&] { return follower.field_of(6) != nullptr; }));
    EXPECT_EQ(follower.field_of(10), nullptr);
}

TEST_F(StageClipsTest, TheCoarseTreeOfAnUrgentSegmentIsReadFirst) {
    const voctree::VOctree whole = voctree::read_nvv(segment(9)), coarse = voctree::cut_tree(whole, 1);
    voctree::write_nvv(segment(9), whole, {}, 3, coarse);
    render::ClipFiles files(device());
    files.read_ahead({{{segment(9), 18, 2}, true}, {{segment(8), 16, 2}, false}});
    std::vector<render::ClipFiles::Result> results;
    for (int i = 0; i < 60'000 && results.size() < 3; ++i) {
        for (render::ClipFiles::Result& result : files.take_results()) results.push_back(std::move(result));
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ASSERT_EQ(results.size(), 3u);
    EXPECT_TRUE(results[0].is_coarse);
    ASSERT_TRUE(results[0].clip && results[1].clip && results[2].clip);
    EXPECT_EQ(results[0].clip->field.leaf_count, coarse.leaf_count);
    EXPECT_FALSE(results[1].is_coarse);
    EXPECT_EQ(results[1].file, segment(9));
    EXPECT_EQ(results[1].clip->field.leaf_count, whole.leaf_count);
    EXPECT_EQ(results[2].file, segment(8));
}

// An edit of the stage changes nothing of what is on the device or is held.
TEST_F(StageClipsTest, AnEditKeepsWhatIsShown) {
    render::StageLoader loader(device());
    render::StageClips before(loader.load(*stage));
    for (const double time_s : {5.9, 5.8}) {  // backwards
        const stage::EvaluatedStage evaluated = stage::stage_at(*stage, time_s);
        before.follow(*stage, evaluated, MissingSegments::kHold);
        before.read_missing(evaluated);
    }
    render::StageClips after(loader.load(*stage));
    after.go_on_from(before);
    const stage::EvaluatedStage far = stage::stage_at(*stage, middle_of(4));
    after.follow(*stage, far, MissingSegments::kHold);
    EXPECT_TRUE(after.holds(far));
    const auto places = after.places_of(far.performers[0]);
    ASSERT_EQ(places.size(), 1u);
    EXPECT_EQ(places[0].field, &before.clips()[0].segments[11].loaded->field);
    for (int i = 0; i < 60'000 && !after.clips()[0].segments[3].loaded; ++i) {
        after.follow(*stage, far, MissingSegments::kHold);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_TRUE(after.clips()[0].segments[3].loaded) << "the clock still runs backwards";
}

TEST_F(StageClipsTest, AFileThatWasWrittenAgainIsReadAgain) {
    render::StageLoader loader(device());
    render::StageClips clips(loader.load(*stage));
    const stage::EvaluatedStage evaluated = stage::stage_at(*stage, middle_of(9));
    clips.follow(*stage, evaluated, MissingSegments::kHold);
    clips.read_missing(evaluated);
    const auto first = clips.clips()[0].segments[9].loaded;
    ASSERT_TRUE(first);
    voctree::VOctree tree = voctree::read_nvv(segment(9));
    tree.leaf(0)[0] += 1;
    voctree::write_nvv(segment(9), tree, {{"note", std::vector<uint8_t>{1, 2, 3}}});
    render::StageClips again(loader.load(*stage));
    // A thread that reads ahead for `clips` may have read the new file.
    EXPECT_NE(again.clips()[0].segments[9].loaded, first);
    again.follow(*stage, evaluated, MissingSegments::kHold);
    again.read_missing(evaluated);
    ASSERT_TRUE(again.clips()[0].segments[9].loaded);
    EXPECT_NE(again.clips()[0].segments[9].loaded, first);
}

TEST_F(StageClipsTest, PaintComesAndGoesWithItsSegment) {
    const std::filesystem::path layer = folder.path / "look.nvpaint";
    std::filesystem::create_directory(layer);
    for (const uint32_t number : {0u, 9u}) {
        const voctree::VOctree tree = voctree::read_nvv(segment(number));
        voctree::EditLayer paint{voctree::painted_field(tree), {}};
        for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
            paint.edits.push_back({.leaf = leaf, .first = 0, .last = 1, .colour = {0, 1, 0}, .alpha = 1});
        voctree::write_paint(voctree::paint_file(layer, {segment(number), 2 * number, 2}), paint);
    }
    stage::StageFile file = stage->file;
    edit::add_paint_layer(file, stage->performers[0].node, layer, {});
    const stage::Stage painted = stage::make_stage(file);
    const auto fresh = [](const stage::Stage& shown, uint32_t number) {
        render::StageRenderer renderer(device(), shown, render::StageLoader(device()).load(shown), {48, 36});
        return image_at(renderer, shown, middle_of(number));
    };
    render::StageLoader loader(device());
    render::StageRenderer renderer(device(), painted, loader.load(painted), {48, 36});
    for (const uint32_t number : {0u, 9u, 5u, 0u, 11u, 3u, 9u}) {
        const media::Image image = image_at(renderer, painted, middle_of(number));
        EXPECT_EQ(image.rgba, fresh(painted, number).rgba) << number;
        EXPECT_EQ(image.rgba == fresh(*stage, number).rgba, number != 0 && number != 9) << number;
    }
    // Edits of the stage, while segments stay on the device.
    renderer.change(*stage, loader.load(*stage));
    EXPECT_EQ(image_at(renderer, *stage, middle_of(9)).rgba, fresh(*stage, 9).rgba);
    renderer.change(painted, loader.load(painted));
    EXPECT_EQ(image_at(renderer, painted, middle_of(9)).rgba, fresh(painted, 9).rgba);
    // By the thread that reads ahead.
    render::StageRenderer ahead(device(), painted, loader.load(painted), {48, 36});
    image_at(ahead, painted, middle_of(0));
    const stage::EvaluatedStage evaluated = stage::stage_at(painted, middle_of(9));
    for (int i = 0; i < 60'000; ++i) {
        ahead.show(evaluated, true, MissingSegments::kHold);
        if (!ahead.holds(evaluated) && ahead.instance_of(evaluated.performers[0])->frame == 0.5f) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_NE(ahead.instance_of(evaluated.performers[0])->paint, 0u);
    EXPECT_EQ(ahead.frames().render(look_at({0, 0.4, 4}, {0, 0.5, 0}, 48, 36, 1), ahead.settings_at(evaluated)).rgba,
              fresh(painted, 9).rgba);
    // What was asked for with other paint is asked for again.
    render::StageRenderer edited(device(), *stage, loader.load(*stage), {48, 36});
    edited.show(stage::stage_at(*stage, middle_of(9)), true, MissingSegments::kHold);
    edited.change(painted, loader.load(painted));
    EXPECT_EQ(image_at(edited, painted, middle_of(9)).rgba, fresh(painted, 9).rgba);
    std::filesystem::remove_all(layer);
    expect_input_error([&] { render::StageLoader(device()).load(painted); }, {"look.nvpaint", "no such folder"});
}

// Files of a layer that are edited, as in an open document, show in place of those on the disk, which need not be
// there.
TEST_F(StageClipsTest, EditedPaintOfASegmentShowsAtOnce) {
    const std::filesystem::path layer = folder.path / "look.nvpaint";
    stage::StageFile file = stage->file;
    edit::add_paint_layer(file, stage->performers[0].node, layer, {});
    const stage::Stage painted = stage::make_stage(file);
    voctree::PaintLayers edited;
    const auto paint = [&](uint32_t number, const glm::vec3& colour) {
        const voctree::VOctree tree = voctree::read_nvv(segment(number));
        voctree::EditLayer one{voctree::painted_field(tree), {}};
        for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
            one.edits.push_back({.leaf = leaf, .first = 0, .last = 1, .colour = colour, .alpha = 1});
        edited[voctree::paint_file(layer, {segment(number), 2 * number, 2})] =
            std::make_shared<const voctree::EditLayer>(one);
        return one;
    };
    const auto saved = [&](uint32_t number) {  // as a program shows it that reads the files
        std::filesystem::create_directory(layer);
        for (const auto& [name, one] : edited) voctree::write_paint(name, *one);
        render::StageRenderer renderer(device(), painted, render::StageLoader(device()).load(painted), {48, 36});
        auto rgba = image_at(renderer, painted, middle_of(number)).rgba;
        std::filesystem::remove_all(layer);
        return rgba;
    };
    paint(9, {0, 1, 0});
    const auto green = saved(9);
    render::StageLoader loader(device(),
                               [&](const std::filesystem::path& of) { return voctree::files_of_layer(edited, of); });
    render::StageRenderer renderer(device(), painted, loader.load(painted), {48, 36});
    EXPECT_EQ(image_at(renderer, painted, middle_of(9)).rgba, green);
    EXPECT_EQ(image_at(renderer, painted, middle_of(2)).rgba, saved(2));
    paint(9, {1, 0, 0});
    renderer.change(painted, loader.load(painted));
    EXPECT_EQ(image_at(renderer, painted, middle_of(9)).rgba, saved(9));
    EXPECT_NE(image_at(renderer, painted, middle_of(9)).rgba, green);
    // While the clip plays, too; and a segment keeps its paint while another one is painted.
    image_at(renderer, painted, middle_of(2));
    const auto known = loader.load(painted);
    paint(2, {0, 0, 1});
    const auto changed = loader.load(painted);
    EXPECT_NE(known.clips[0].segments[2].paints, changed.clips[0].segments[2].paints);
    EXPECT_EQ(known.clips[0].segments[9].paints, changed.clips[0].segments[9].paints);
    // Paint of another field is named, and costs the segment's paint alone.
    edited.begin()->second = std::make_shared<const voctree::EditLayer>(
        voctree::EditLayer{voctree::painted_field(voctree::read_nvv(segment(3))), {}});
    renderer.change(painted, loader.load(painted));
    image_at(renderer, painted, middle_of(2));
    const std::vector<Note> problems = renderer.take_problems();
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_NE(problems[0].words().find("is paint for another clip"), std::string::npos) << problems[0].words();
    edited.clear();
    expect_input_error([&] { loader.load(painted); }, {"look.nvpaint", "no such folder"});
}

// Each frame of a stream is a segment. They are read ahead one after the other, and only some stay on the device.
TEST_F(StageClipsTest, AStreamPlaysFrameByFrame) {
    const voctree::ClipIndex index = voctree::read_clip_index(clip);
    const std::filesystem::path path = folder.path / "long.nvs";
    stream::Writer writer(path, index.fps, index.frames(), kSegments);
    stream::Steps steps;
    steps.fill(30);
    for (const voctree::ClipSegment& one : index.segments) {
        const voctree::VOctree tree = voctree::read_segment(one);
        const stream::QuantisedSlice slices[2] = {slice::quantised(voctree::slice_of(tree, 0)),
                                                  slice::quantised(voctree::slice_of(tree, 1))};
        std::vector<stream::FrameSymbols> frames;
        stream::QuantisedSlice first, second;
        frames.push_back(stream::encode(slices[0], steps, {}, first));
        frames.push_back(stream::encode(slices[1], steps, stream::FrameBefore{slices[0], first}, second));
        stream::Group group;
        group.format = {2 * tree.node_levels, tree.hh_degree, tree.leaf_count};
        group.box_min = {tree.box_min.x, tree.box_min.y, tree.box_min.z};
        group.box_size = {tree.box_size.x, tree.box_size.y, tree.box_size.z};
        writer.add(group, frames);
    }
    writer.finish();
    write_stage(folder.path / "stream.gltf", path, "anna");
    *stage = stage::load_stage(folder.path / "stream.gltf");
    const double frame_s = 0.5 * kSegment_s;
    Follower follower{*this};
    ASSERT_TRUE(follower.until(0, [&] {
        uint32_t there = 0;  // two threads read them, so that a later one may come first
        for (uint32_t frame = 0; frame < 8; ++frame) there += follower.field_of(frame) ? 1 : 0;
        return there == 8;
    }));
    const render::Field* first = follower.field_of(0);
    ASSERT_EQ(follower.at(0, MissingSegments::kHold)->field, first);
    const auto late = follower.at(11 * frame_s, MissingSegments::kHold);
    ASSERT_TRUE(late);
    EXPECT_NE(late->field, first) << "what is nearer to its time was there";
    for (uint32_t frame = 0; frame < 2 * kSegments; ++frame) {
        const auto place = follower.at(frame * frame_s, MissingSegments::kWait);
        ASSERT_TRUE(place);
        EXPECT_EQ(place->field, follower.field_of(frame)) << frame;
        EXPECT_LE(follower.clips.fields().size(), render::kMostStreamFrames);
    }
    EXPECT_EQ(follower.clips.problems().size(), 0u);
    EXPECT_FALSE(follower.field_of(0)) << "the first frame goes, as others do";
    const auto fields = follower.clips.fields();
    EXPECT_EQ(std::ranges::count(fields, &follower.clips.clips()[0].first->field), 1) << "it is one that is there";
    render::StageRenderer renderer(device(), *stage, render::StageLoader(device()).load(*stage), {48, 36});
    EXPECT_NE(image_at(renderer, *stage, 0).rgba, image_at(renderer, *stage, 7 * frame_s).rgba);
}

// Until the whole segment is there, the performer is at its time in one way or the other.
TEST_F(StageClipsTest, AfterASeekTheCoarseTreeIsShown) {
    const voctree::VOctree whole = voctree::read_nvv(segment(9));
    voctree::write_nvv(segment(9), whole, {}, 3, voctree::cut_tree(whole, 1));
    render::StageRenderer renderer(device(), *stage, render::StageLoader(device()).load(*stage), {48, 36});
    image_at(renderer, *stage, middle_of(0));
    const stage::EvaluatedStage evaluated = stage::stage_at(*stage, middle_of(9));
    const stage::Camera camera = look_at({0, 0.4, 4}, {0, 0.5, 0}, 48, 36, 1);
    media::Image image;
    for (int i = 0; i < 60'000; ++i) {
        renderer.show(evaluated, true, MissingSegments::kHold);
        image = renderer.frames().render(camera, renderer.settings_at(evaluated));
        if (!renderer.holds(evaluated) && renderer.instance_of(evaluated.performers[0])->frame == 0.5f) break;
    }
    EXPECT_FALSE(renderer.holds(evaluated));
    render::StageRenderer fresh(device(), *stage, render::StageLoader(device()).load(*stage), {48, 36});
    EXPECT_EQ(image_at(renderer, *stage, middle_of(9)).rgba, image_at(fresh, *stage, middle_of(9)).rgba)
        << "whoever waits gets the whole one";
}

void damage_leaves(const std::filesystem::path& file) {
    std::fstream bytes(file, std::ios::binary | std::ios::in | std::ios::out);
    bytes.seekp(static_cast<std::streamoff>(std::filesystem::file_size(file) / 2));
    bytes.write("damaged", 7);
}

// The head of the file is whole, so that the damage is found only when the segment is read.
TEST_F(StageClipsTest, ADamagedSegmentCostsItselfAlone) {
    damage_leaves(segment(3));
    std::filesystem::remove(segment(5));
    Follower follower{*this};
    ASSERT_EQ(follower.clips.problems().size(), 1u);
    EXPECT_NE(follower.clips.problems()[0].words().find(segment(5).filename().string()), std::string::npos);
    EXPECT_TRUE(follower.at(middle_of(2), MissingSegments::kWait));
    EXPECT_FALSE(follower.at(middle_of(3), MissingSegments::kWait)) << "nobody is there";
    ASSERT_EQ(follower.clips.problems().size(), 2u);
    EXPECT_NE(follower.clips.problems()[1].words().find(segment(3).filename().string()), std::string::npos);
    EXPECT_TRUE(follower.at(middle_of(4), MissingSegments::kWait));
    EXPECT_FALSE(follower.at(middle_of(5), MissingSegments::kWait));
    EXPECT_TRUE(follower.at(middle_of(6), MissingSegments::kWait));
}

}  // namespace
}  // namespace neuvv::test::stage_clips_test
