// Devices on the command line: their list and choice, how they bind long arrays, the limit of their memory, and their
// loss.
#include <gtest/gtest.h>

#include <regex>

#include "support/losable_device.h"
#include "support/random_tree.h"
#include "tests/tools/cli_gpu.h"
#include "voctree/files/nvv.h"

namespace neuvv {
namespace {

using CliDevice = CliGpu;

TEST_F(CliDevice, DevicesAreListed) {
    const ProgramResult result = run_neuvv({"devices", "--json"});
    ASSERT_EQ(result.code, 0) << result.err;
    const auto devices = nlohmann::json::parse(result.out);
    ASSERT_GE(devices.size(), 1u);
    bool usable = false;
    for (const auto& device : devices) {
        EXPECT_FALSE(device.at("name").get<std::string>().empty());
        EXPECT_EQ(device.at("usable").get<bool>(), device.at("missing").empty());
        EXPECT_GT(device.at("memory_bytes"), 0);
        EXPECT_TRUE(device.at("memory_budget_bytes").is_null() || device.at("memory_budget_bytes") > 0);
        EXPECT_GE(device.at("memory_used_bytes"), 0);
        usable |= device.at("usable").get<bool>();
        EXPECT_EQ(device.at("buffers").at("profiles").at(0), "texel");
        EXPECT_GE(device.at("buffers").at("max_texels").get<uint64_t>(), 65536u);
    }
    EXPECT_TRUE(usable);
    EXPECT_NE(run_neuvv({"devices"}).out.find(devices[0].at("name").get<std::string>()), std::string::npos);
}

TEST_F(CliDevice, DeviceChoiceThatFitsNoneIsBadInput) {
    expect_refused({"render", scene, "-o", file("x.mp4"), "--device", "no such card"}, 2,
                   {"no such card", "neuvv devices"});
}

// Texel buffers of fp16 convert as unpackHalf2x16 does, so not a bit may differ.
TEST_F(CliDevice, ArraysInStorageBuffersGiveTheSameImages) {
    const auto image = [&](const std::string& profile, const std::vector<std::string>& options) {
        const std::string out = file(options.empty() ? "out.exr" : "out.png");
        std::vector<std::string> arguments = {"render", "--overwrite", scene,      "-o", out,
                                              "--size", "64x48",       "--frames", "1.5"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        const ProgramResult result = run_neuvv(arguments, "NEUVV_BUFFERS=" + profile);
        EXPECT_EQ(result.code, 0) << result.err;
        return read_text(out);
    };
    for (const std::vector<std::string>& options : std::vector<std::vector<std::string>>{
             {}, {"--direct"}, {"--slice-budget", "0"}, {"--scale", "0.5"}, {"--level"}})
        EXPECT_TRUE(image("texel", options) == image("storage", options)) << (options.empty() ? "" : options[0]);
    const ProgramResult listed = run_neuvv({"devices"}, "NEUVV_BUFFERS=storage");
    EXPECT_NE(listed.out.find("arrays in storage buffers"), std::string::npos) << listed.out;
    const ProgramResult refused = run_neuvv({"devices"}, "NEUVV_BUFFERS=neither");
    EXPECT_EQ(refused.code, 2);
    EXPECT_NE(refused.err.find("give texel, storage or fastest"), std::string::npos) << refused.err;
}

TEST_F(CliDevice, UploadsByAQueueOfTheirOwnGiveTheSameImage) {
    const std::string layer =
        "VK_INSTANCE_LAYERS=VK_LAYER_NEUVV_transfer_queue VK_LAYER_PATH=" NEUVV_TRANSFER_QUEUE_LAYER;
    const auto uploads_aside = [](const std::string& environment) {
        const ProgramResult listed = run_neuvv({"devices", "--json"}, environment);
        EXPECT_EQ(listed.code, 0) << listed.err;
        return nlohmann::json::parse(listed.out).at(0).at("transfer_queue").get<bool>();
    };
    EXPECT_TRUE(uploads_aside(layer));
    const auto image = [&](const std::string& environment) {
        const ProgramResult result = run_neuvv(
            {"render", "--overwrite", scene, "-o", file("out.exr"), "--size", "64x48", "--frames", "1.5"}, environment);
        EXPECT_EQ(result.code, 0) << result.err;
        return read_text(file("out.exr"));
    };
    EXPECT_TRUE(image(layer) == image(""));
}

// As Vulkan guarantees texel buffers, arrays go to storage buffers; where these are too small, too, an error says what
// to do.
TEST_F(CliDevice, SmallLimitsGiveTheSameImageOrAnErrorThatHelps) {
    const std::string layer = "VK_INSTANCE_LAYERS=VK_LAYER_NEUVV_lower_limits VK_LAYER_PATH=" NEUVV_LOWER_LIMITS_LAYER
                              " XDG_CACHE_HOME=" +
                              shell_quoted((folder.path / "cache").string()) + " ";
    const auto render = [&](const std::string& environment) {
        return run_neuvv({"render", "--overwrite", scene, "-o", file("out.exr"), "--size", "64x48", "--frames", "1.5"},
                         environment);
    };
    ASSERT_EQ(render("NEUVV_BUFFERS=texel").code, 0);
    const std::string expected = read_text(file("out.exr"));
    const std::string guaranteed = layer + "NEUVV_MOST_TEXELS=65536 NEUVV_MOST_STORAGE_BYTES=134217728";
    const ProgramResult listed = run_neuvv({"devices", "--json"}, guaranteed);
    ASSERT_EQ(listed.code, 0) << listed.err;
    const auto buffers = nlohmann::json::parse(listed.out).at(0).at("buffers");
    EXPECT_EQ(buffers.at("max_texels"), 65536);
    EXPECT_EQ(buffers.at("reason"), "limits");
    const ProgramResult small = render(guaranteed);
    ASSERT_EQ(small.code, 0) << small.err;
    EXPECT_TRUE(read_text(file("out.exr")) == expected);
    const ProgramResult rays = render(layer + "NEUVV_MOST_TEXELS=2048 NEUVV_MOST_STORAGE_BYTES=32768");
    EXPECT_EQ(rays.code, 1);
    EXPECT_NE(rays.err.find("too many for this device; choose a smaller --size"), std::string::npos) << rays.err;
    const ProgramResult leaves = render(layer + "NEUVV_MOST_TEXELS=512 NEUVV_MOST_STORAGE_BYTES=8192");
    EXPECT_EQ(leaves.code, 1);
    EXPECT_NE(leaves.err.find("choose a clip of fewer leaves"), std::string::npos) << leaves.err;
}

// Where a device neither binds nor allocates as much at once as the weights of a field take, these are several buffers
// that shaders read by their addresses.
TEST_F(CliDevice, WeightsMayBeLongerThanWhatADeviceBindsOrAllocates) {
    constexpr uint64_t kMost = 256 << 10;
    const voctree::VOctree large =
        test::random_tree({.seed = 3, .node_levels = 3, .leaves = 6000, .bases = 24, .hh_degree = 1, .frames = 3});
    ASSERT_GT(2 * large.weights.size(), 2 * kMost) << "bytes in fp16: three parts or more";
    voctree::write_nvv(scene, large);
    const std::string small = "XDG_CACHE_HOME=" + shell_quoted((folder.path / "cache").string()) +
                              " VK_INSTANCE_LAYERS=VK_LAYER_NEUVV_lower_limits VK_LAYER_PATH=" NEUVV_LOWER_LIMITS_LAYER
                              " NEUVV_BUFFERS=storage NEUVV_MOST_STORAGE_BYTES=" +
                              std::to_string(kMost) + " NEUVV_MOST_ALLOCATION=" + std::to_string(kMost);
    const auto image = [&](const std::string& environment, const std::vector<std::string>& options) {
        std::vector<std::string> arguments = {"render", "--overwrite", scene,      "-o", file("out.exr"),
                                              "--size", "64x48",       "--frames", "1.5"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        const ProgramResult result = run_neuvv(arguments, environment);
        EXPECT_EQ(result.code, 0) << result.err;
        return read_text(file("out.exr"));
    };
    for (const std::vector<std::string>& options :
         std::vector<std::vector<std::string>>{{}, {"--direct"}, {"--slice-budget", "0"}})
        EXPECT_TRUE(image("NEUVV_BUFFERS=texel", options) == image(small, options))
            << (options.empty() ? "" : options[0]);
}

// A texel buffer of the device holds other arrays of the tree, but not its weights.
TEST_F(CliDevice, WeightsBeyondATexelBufferAreRefusedWithWhatHelps) {
    voctree::write_nvv(scene, test::random_tree({.seed = 3, .node_levels = 3, .leaves = 6000, .bases = 24}));
    const ProgramResult result =
        run_neuvv({"render", "--overwrite", scene, "-o", file("out.exr"), "--size", "64x48", "--frames", "1.5"},
                  "VK_INSTANCE_LAYERS=VK_LAYER_NEUVV_lower_limits VK_LAYER_PATH=" NEUVV_LOWER_LIMITS_LAYER
                  " NEUVV_BUFFERS=texel NEUVV_MOST_TEXELS=65536");
    EXPECT_EQ(result.code, 1);
    EXPECT_NE(result.err.find("NEUVV_BUFFERS=storage reads them otherwise"), std::string::npos) << result.err;
}

// A tree whose weights do not fit into a texel buffer of the device is trained as it is elsewhere.
TEST_F(CliDevice, SmallLimitsTrainTheSameTree) {
    write_own_data();
    std::filesystem::rename(folder.path / "data/transforms_test.json", folder.path / "data/transforms_train.json");
    const auto train = [&](const char* name, const char* steps, const std::string& environment) {
        const ProgramResult result =
            run_neuvv({"train", file("data"), "-o", file(name), "--steps", steps, "--resolution", "64"}, environment);
        EXPECT_EQ(result.code, 0) << result.err;
        return voctree::read_nvv(file(name));
    };
    const voctree::VOctree expected = train("texel.nvv", "8", "NEUVV_BUFFERS=texel");
    const voctree::VOctree small =
        train("small.nvv", "8",
              "XDG_CACHE_HOME=" + shell_quoted((folder.path / "cache").string()) +
                  " VK_INSTANCE_LAYERS=VK_LAYER_NEUVV_lower_limits VK_LAYER_PATH=" NEUVV_LOWER_LIMITS_LAYER
                  " NEUVV_MOST_TEXELS=4096 NEUVV_MOST_STORAGE_BYTES=134217728");
    EXPECT_GT(small.weights.size(), 4u * 4096);  // a texel has four at most
    ASSERT_EQ(small.weights.size(), expected.weights.size());
    double all = 0, differs = 0;
    for (size_t i = 0; i < small.weights.size(); ++i) {
        all += std::abs(expected.weights[i]);
        differs += std::abs(expected.weights[i] - small.weights[i]);
    }
    EXPECT_GT(all, 0);
    EXPECT_LT(differs, 1e-3 * all);
}

// The first start times both ways to bind arrays, and the next ones go by what it found.
TEST_F(CliDevice, TheFasterBuffersAreKeptInTheCacheFolder) {
    const std::filesystem::path cache = folder.path / "cache";
    const std::string environment = "NEUVV_BUFFERS=fastest XDG_CACHE_HOME=" + shell_quoted(cache.string());
    const auto buffers = [&] {
        const ProgramResult result = run_neuvv({"devices", "--json"}, environment);
        EXPECT_EQ(result.code, 0) << result.err;
        const auto devices = nlohmann::json::parse(result.out);
        for (const auto& one : devices)
            if (one.at("name") == device().summary().name) return one.at("buffers");
        ADD_FAILURE() << result.out;
        return nlohmann::json();
    };
    const auto image = [&] {
        const ProgramResult result =
            run_neuvv({"render", "--overwrite", scene, "-o", file("timed.exr"), "--size", "64x48", "--frames", "1.5"},
                      environment);
        EXPECT_EQ(result.code, 0) << result.err;
        return read_text(file("timed.exr"));
    };
    EXPECT_EQ(buffers().at("reason"), "speed");
    EXPECT_TRUE(buffers().at("texel_ms").is_null()) << "the list of devices times nothing";
    const std::string first = image();
    EXPECT_GT(buffers().at("texel_ms"), 0);
    EXPECT_GT(buffers().at("storage_ms"), 0);

    std::filesystem::path times;
    for (const auto& entry : std::filesystem::directory_iterator(cache / "neuvv"))
        if (entry.path().filename().string().starts_with("buffers-")) times = entry.path();
    ASSERT_FALSE(times.empty());
    const auto with = [&](double texel_ms, double storage_ms) {
        auto json = nlohmann::json::parse(read_text(times));
        json["texel_ms"] = texel_ms;
        json["storage_ms"] = storage_ms;
        write_text(times, json.dump());
        EXPECT_TRUE(image() == first) << "either way";
        EXPECT_EQ(buffers().at("texel_ms"), texel_ms) << "it was timed again";
        return buffers().at("profile");
    };
    EXPECT_EQ(with(3, 1), "storage");
    EXPECT_EQ(with(1, 3), "texel");
    EXPECT_NE(run_neuvv({"devices"}, environment).out.find("delete " + times.string()), std::string::npos);
}

// With less and less memory: the same images, and in the end one line.
TEST_F(CliDevice, RenderTakesNoMoreMemoryThanItMay) {
    voctree::write_nvv(file("many.nvv"),
                       test::random_tree({.node_levels = 3, .leaves = 8000, .hh_degree = 2, .frames = 3}));
    const auto rendered = [&](const std::string& environment) {
        const ProgramResult result = run_neuvv(
            {"render", "--overwrite", file("many.nvv"), "-o", file("many_%d.png"), "--size", "40x24"}, environment);
        return std::pair(result, result.code == 0 ? read_text(file("many_1.png")) : "");
    };
    const std::string image = rendered("").second;
    ASSERT_FALSE(image.empty());
    uint32_t mebibytes = 64, same = 0;
    for (; mebibytes > 0; mebibytes /= 2) {
        std::filesystem::remove(file("many_1.png"));
        const auto [result, found] = rendered("NEUVV_DEVICE_MEMORY=" + std::to_string(mebibytes));
        if (result.code == 0) {
            same += found == image;
            EXPECT_EQ(found, image) << mebibytes;
            continue;
        }
        EXPECT_EQ(result.code, 1);
        const size_t found_at = result.err.find("has no memory left for");
        EXPECT_NE(found_at, std::string::npos) << result.err;
        EXPECT_EQ(found_at, result.err.rfind("has no memory left for")) << "it is said once: " << result.err;
        EXPECT_NE(result.err.find("of " + std::to_string(mebibytes) + " MiB"), std::string::npos) << result.err;
        EXPECT_NE(result.err.find("choose a smaller --size or --slice-budget"), std::string::npos) << result.err;
        break;
    }
    EXPECT_GE(same, 1u);
    EXPECT_GT(mebibytes, 0u) << "there is a limit below which it cannot be drawn";
    EXPECT_EQ(rendered("NEUVV_DEVICE_MEMORY=much").first.code, 2);
}

TEST_F(CliDevice, RenderSaysAtWhichImageTheDeviceWasLost) {
    const test::LosableDevice losable(folder.path);
    losable.lose();
    const ProgramResult result = run_neuvv({"render", "--overwrite", scene, "-o", file("turn_%d.png"), "--frames",
                                            "0:3", "--size", "16x16", "--fps", "30"},
                                           "NEUVV_LOSE_DEVICE_AFTER=12");
    EXPECT_EQ(result.code, 1);
    const std::regex line("neuvv: image [0-9]+: vkQueueSubmit2 failed for .*: device lost; .*--device\n");
    EXPECT_TRUE(std::regex_search(result.err, line)) << result.err;
}

// Training makes a lost device anew, once, and goes on from what is on disk; a clip in segments, too.
TEST_F(CliDevice, TrainingGoesOnOnADeviceThatIsMadeAnew) {
    write_own_data();
    std::filesystem::rename(folder.path / "data/transforms_test.json", folder.path / "data/transforms_train.json");
    const test::LosableDevice losable(folder.path);
    const auto train = [&](int losses, std::vector<std::string> more) {
        losable.lose(losses);
        std::vector<std::string> words = {"train",   file("data"), "-o",           file("lost.nvv"),
                                          "--steps", "12",         "--resolution", "32"};
        words.insert(words.end(), more.begin(), more.end());
        return run_neuvv(words, "NEUVV_LOSE_DEVICE_AFTER=9");
    };
    for (const std::vector<std::string>& segments : {std::vector<std::string>{}, {"--segment", "2"}}) {
        const ProgramResult once = train(1, segments);
        EXPECT_EQ(once.code, 0) << once.err;
        EXPECT_NE(once.err.find("device lost; the device is made anew"), std::string::npos) << once.err;
        EXPECT_NE(once.out.find("wrote"), std::string::npos) << once.out;
        std::filesystem::remove_all(file("lost.nvv"));
        std::filesystem::remove(file("lost.nvv.state"));
        const ProgramResult twice = train(2, segments);
        EXPECT_EQ(twice.code, 1) << twice.err;
        const std::regex line("neuvv: .*lost.nvv: .*device lost; .*--device; --resume goes on .*\n");
        EXPECT_TRUE(std::regex_search(twice.err, line)) << twice.err;
        std::filesystem::remove_all(file("lost.nvv"));
        std::filesystem::remove(file("lost.nvv.state"));
    }
}

// The loss comes after the first checkpoint of the part's second segment.
TEST_F(CliDevice, APartGoesOnOnADeviceThatIsMadeAnew) {
    write_own_data();
    std::filesystem::rename(folder.path / "data/transforms_test.json", folder.path / "data/transforms_train.json");
    const auto train = [&](std::vector<std::string> more, const std::string& environment) {
        std::vector<std::string> words = {"train",   file("data"), "-o",           file("lost.nvv"),
                                          "--steps", "12",         "--resolution", "32"};
        words.insert(words.end(), more.begin(), more.end());
        return run_neuvv(words, environment);
    };
    ASSERT_EQ(train({"--segment", "1"}, "").code, 0);
    const test::LosableDevice losable(folder.path);
    losable.lose();
    const ProgramResult part = train({"--from", "1", "--overwrite"}, "NEUVV_LOSE_DEVICE_AFTER=40");
    EXPECT_EQ(part.code, 0) << part.err;
    EXPECT_NE(part.err.find("device lost; the device is made anew"), std::string::npos) << part.err;
}

}  // namespace
}  // namespace neuvv
