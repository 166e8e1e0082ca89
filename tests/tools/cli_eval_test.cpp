// `neuvv eval`: that a scene compared with itself is perfect, and the files that it writes.
#include <gtest/gtest.h>

#include "support/edit_image.h"
#include "tests/tools/cli_gpu.h"

namespace neuvv {
namespace {

TEST_F(CliGpu, ASceneMeasuredAgainstItselfIsPerfect) {
    write_own_data();
    const training::Dataset dataset = training::load_dataset(folder.path / "data", training::Split::kTest);
    size_t calls = 0;
    const training::Evaluation all =
        training::evaluate(device(), tree, dataset, {.samples = 1},
                           [&](size_t view, const media::Image&, const media::Image&, const training::Quality&) {
                               EXPECT_EQ(view, calls++);
                               return true;
                           });
    EXPECT_EQ(calls, 6u);
    EXPECT_GT(all.mean.psnr, 40);
    EXPECT_GT(all.mean.ssim, 0.999);
    EXPECT_LT(all.mean.mae, 0.001);
    ASSERT_EQ(all.cameras.size(), 2u);
    EXPECT_EQ(all.cameras[1].images, 3u);

    voctree::VOctree other = tree;  // proves that the comparison can fail
    for (float& weight : other.weights) weight = -weight;
    EXPECT_LT(training::evaluate(device(), other, dataset, {.samples = 1}).mean.psnr, 30);
    training::Dataset blind = dataset;  // pixels that are ignored do not count
    for (training::View& view : blind.views) {
        view.ignored.assign(size_t{view.image.width()} * view.image.height(), true);
        test::clear_image(view);
    }
    EXPECT_EQ(training::evaluate(device(), other, blind, {.samples = 1}).mean.psnr, 99);
    EXPECT_EQ(training::evaluate(device(), tree, dataset, {.samples = 1}, [](auto...) { return false; }).compared, 1u);
}

TEST_F(CliGpu, EvalWritesNumbersAndImages) {
    write_own_data();
    const ProgramResult result =
        run_neuvv({"eval", "--overwrite", scene, file("data"), "--samples", "1", "--json", file("m.json"), "--images",
                   file("images"), "--html", file("new/page.html")});
    ASSERT_EQ(result.code, 0) << result.err;
    const std::string page = read_text(file("new/page.html"));
    EXPECT_EQ(count_of(page, "<figure"), 6u);
    EXPECT_EQ(count_of(page, "src=\"data:image/png;base64,iVBORw0KGgo"), 4u * 6u);
    EXPECT_NE(page.find("c01_f1"), std::string::npos);
    EXPECT_NE(result.out.find("PSNR"), std::string::npos);
    const auto json = nlohmann::json::parse(read_text(file("m.json")));
    EXPECT_GT(json.at("psnr"), 40);
    EXPECT_GT(json.at("ssim"), 0.999);
    EXPECT_LT(json.at("mae"), 0.001);
    EXPECT_EQ(json.at("file"), scene);
    EXPECT_EQ(json.at("split"), "test");
    ASSERT_EQ(json.at("cameras").size(), 2u);
    EXPECT_EQ(json.at("cameras")[1].at("camera"), 1);
    EXPECT_EQ(json.at("cameras")[1].at("images"), 3);
    EXPECT_GT(json.at("cameras")[1].at("psnr"), 40);
    EXPECT_EQ(json.at("cameras")[1].at("name"), "c01");
    ASSERT_EQ(json.at("frames").size(), 3u);
    EXPECT_EQ(json.at("frames")[1].at("time"), 0.5);
    EXPECT_EQ(json.at("frames")[1].at("images"), 2);
    EXPECT_LT(json.at("frames")[1].at("flip"), 0.01);
    ASSERT_EQ(json.at("images").size(), 6u);
    EXPECT_EQ(json.at("images")[4].at("name"), "c01_f1");
    for (const char* name : {"c00_f0_truth.png", "c00_f0_render.png", "c01_f2_error.png"}) {
        const media::Image image = media::read_png(folder.path / "images" / name);
        EXPECT_EQ(image.width, 48u) << name;
        EXPECT_EQ(image.height, 40u) << name;
    }
    EXPECT_EQ(media::read_png(folder.path / "images" / "contact_sheet.png").width, 3 * 288u);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path / "images"), {}), 3 * 6 + 1);

    const ProgramResult piped =
        run_neuvv({"eval", "--overwrite", scene, file("data"), "--samples", "1", "--json", "-"});
    EXPECT_EQ(nlohmann::json::parse(piped.out).at("psnr"), json.at("psnr"));
}

TEST_F(CliGpu, EvalComparesAPartOverBlack) {
    write_own_data();
    tree.weights.clear();  // an empty scene is wrong where the performer is
    voctree::build_topology(tree, {});
    voctree::write_nvv(scene, tree);
    const auto eval = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments{"eval", scene, file("data"), "--samples", "1", "--json", "-"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return nlohmann::json::parse(run_neuvv(arguments).out);
    };
    const auto whole = eval({}), part = eval({"--crop", "rectangle"}), matte = eval({"--crop", "matte"});
    EXPECT_EQ(whole.at("crop"), "none");
    EXPECT_EQ(whole.at("background"), "white");
    EXPECT_LT(part.at("psnr"), whole.at("psnr")) << "less of the background, which is right";
    EXPECT_LT(matte.at("psnr"), part.at("psnr"));
    EXPECT_EQ(matte.at("ssim"), part.at("ssim"));
    const auto black = eval({"--background", "black", "--images", file("images")});
    EXPECT_EQ(black.at("background"), "black");
    EXPECT_NE(black.at("ssim"), whole.at("ssim"));
    for (const char* name : {"c00_f0_truth.png", "c00_f0_render.png"}) {
        const media::Image image = media::read_png(folder.path / "images" / name);
        EXPECT_EQ(image.at(0, 0)[0], 0) << name;
        EXPECT_EQ(image.width, 48u) << name;
    }
}

TEST_F(CliGpu, EvalAlignsCamerasThatFitAlready) {
    write_own_data();
    const ProgramResult table = run_neuvv({"eval", "--overwrite", scene, file("data"), "--samples", "1", "--align",
                                           "--json", file("m.json"), "--html", file("page.html")});
    ASSERT_EQ(table.code, 0) << table.err;
    const nlohmann::json facts = nlohmann::json::parse(read_text(file("m.json")));
    EXPECT_LT(facts.at("aligned").at("pixels"), 0.1);
    EXPECT_NEAR(facts.at("aligned").at("scale"), 1, 1e-3);
    EXPECT_GT(facts.at("psnr"), 40);
    EXPECT_NE(table.out.find("cameras moved as one by 0.0"), std::string::npos) << table.out;
    EXPECT_NE(read_text(file("page.html")).find("cameras moved as one"), std::string::npos);
}

TEST_F(CliGpu, EvalRefusesUnwritableOutputsBeforeItStarts) {
    write_own_data();
    write_text(file("wall"), "a file where a folder should be");
    for (const char* option : {"--json", "--html", "--images"})
        expect_refused({"eval", scene, file("data"), option, file("wall/out")}, 2, {option, "wall"});
    const ProgramResult per_frame =
        run_neuvv({"eval", "--overwrite", scene, file("data"), "--samples", "1", "--per", "frame"});
    EXPECT_EQ(count_of(per_frame.out, "\n"), 1u + 3u + 1u + 1u) << "frames, their mean, flicker: " << per_frame.out;
}

}  // namespace
}  // namespace neuvv
