// neuvv publish: writes a clip, or a performer of a stage, as a stream: alone, or with a page that plays it.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.h"
#include "base/formats/json.h"
#include "base/platform.h"
#include "tools/commands.h"
#include "tools/publish/encode_scene.h"
#include "tools/publish/published_files.h"
#include "tools/publish/published_scene.h"
#include "tools/publish/web_page.h"
#include "tools/report.h"
#include "tools/results.h"
#include "tools/say.h"
#include "voctree/files/clip.h"
#include "voctree/files/clip_sound.h"

namespace neuvv::tools {

namespace {

struct PublishOptions {
    std::string scene, performer, output, web;  // either `output` or `web`
    bool json = false;
    std::optional<voctree::UpAxis> up;
    EncodingOptions encoding;
    std::string given_encoding;  // one of the options of the encoding that was given
    bool is_one_file() const { return web.ends_with(".html"); }
    // Where the stream and the page are when all is done.
    std::filesystem::path stream() const {
        if (is_one_file()) return web;
        return web.empty() ? std::filesystem::path(output) : std::filesystem::path(web) / kPageStream;
    }
    std::filesystem::path page() const {
        return is_one_file() ? std::filesystem::path(web) : std::filesystem::path(web) / "index.html";
    }
};

// The sound that goes along with the clip; nothing where it has none, or where it is that of the output already.
std::optional<std::filesystem::path> sound_to_copy(const std::filesystem::path& clip,
                                                   const std::filesystem::path& output) {
    const auto sound = voctree::sound_beside(clip);
    std::error_code error;
    if (!sound || std::filesystem::equivalent(*sound, voctree::sound_file(output), error)) return std::nullopt;
    prepare_result("--output", voctree::sound_file(output));
    return sound;
}

// Writes the stream, and its sound beside it.
EncodedStream publish_stream(const PublishOptions& options, const PublishedScene& scene, const CommonOptions& common,
                             const std::filesystem::path& output) {
    const auto sound = sound_to_copy(scene.clip, output);
    const EncodedStream published = encode_scene(options.encoding, scene, common, output);
    if (sound) copy_sound(*sound, voctree::sound_file(output));
    return published;
}

// A folder beside the output of one file, for what goes into that.
struct PrivateFolder {
    const std::filesystem::path path;
    explicit PrivateFolder(const std::filesystem::path& output) : path(make_private_folder(output.string() + ".")) {}
    PrivateFolder(const PrivateFolder&) = delete;
    PrivateFolder& operator=(const PrivateFolder&) = delete;
    ~PrivateFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
};

// Writes the stream that a page plays, and beside it its sound.
EncodedStream write_for_page(const PublishOptions& options, const PublishedScene& scene, const CommonOptions& common,
                             const std::optional<std::filesystem::path>& sound, const std::filesystem::path& stream) {
    const EncodedStream published = is_stream_to_copy(scene.clip)
                                        ? EncodedStream{copy_stream(scene.clip, stream)}
                                        : encode_scene(options.encoding, scene, common, stream);
    if (sound) copy_sound(*sound, voctree::sound_file(stream));
    return published;
}

EncodedStream publish_page(const PublishOptions& options, const PublishedScene& scene, const CommonOptions& common) {
    if (is_stream_to_copy(scene.clip) && !options.given_encoding.empty())
        throw InputError(options.given_encoding, scene.clip.string(), "is a stream, which is copied as it is",
                         "leave the option out");
    const std::string name = scene.stage ? scene.stage->performers[scene.performer].name : "";
    const std::string title = name.empty() ? scene.clip.stem().string() : name;
    const auto sound = voctree::sound_beside(scene.clip);
    const std::filesystem::path page_sound = voctree::sound_file(kPageStream);
    if (options.is_one_file()) {
        const WebPlayer player = find_one_file_player();
        prepare_result("--web", options.web);
        const PrivateFolder folder(options.web);
        const EncodedStream published = write_for_page(options, scene, common, sound, folder.path / kPageStream);
        write_one_file_page(options.web, player, title, folder.path / kPageStream,
                            sound ? std::optional(folder.path / page_sound) : std::nullopt);
        return published;
    }
    std::vector<std::string> own{kPageStream};
    if (sound) own.push_back(page_sound.string());
    const UnfinishedWebPage page("--web", options.web, find_web_player(), own);
    const EncodedStream published = write_for_page(options, scene, common, sound, page.path() / kPageStream);
    if (const std::string note = page.finish(title); !note.empty()) say("{}\n", note);
    return published;
}

void report(const PublishOptions& options, const PublishedScene& scene, const EncodedStream& published) {
    const std::string stream = options.stream().string(), page = options.page().string();
    const uint32_t frames = scene.index.frames();
    const double bytes_per_frame = static_cast<double>(published.bytes) / frames;
    const double mbps = 8e-6 * bytes_per_frame * double{scene.index.fps};
    if (options.encoding.rate_mbps && published.most_mbps > *options.encoding.rate_mbps)
        say("{}: --rate {:g} is not reached: a group takes up to {:.3g} Mbit/s, though rounded as coarsely as is "
            "possible; fewer leaves take less (--max-leaves of `neuvv train`)\n",
            stream, *options.encoding.rate_mbps, published.most_mbps);
    if (options.json) {
        nlohmann::ordered_json json = {{"input", options.scene}, {"output", stream}};
        if (!options.web.empty()) json.update({{"web", options.web}, {"page", page}});
        json.update(
            {{"bytes", published.bytes}, {"frames", frames}, {"bytes_per_frame", bytes_per_frame}, {"mbps", mbps}});
        if (options.is_one_file()) json["page_bytes"] = std::filesystem::file_size(page);
        if (!scene.layers.empty()) json["paint_layers"] = scene.layers.size();
        if (options.encoding.rate_mbps) json["most_mbps"] = published.most_mbps;
        if (published.psnr) json["psnr_db"] = *published.psnr;
        tell("{}", json_text(json));
        return;
    }
    const std::string quality = published.psnr ? fmt::format("; the worst image has {:.1f} dB", *published.psnr) : "";
    const std::string paint =
        scene.layers.empty() ? "" : fmt::format("; visible layers of paint: {}", scene.layers.size());
    tell("{}: {} for {} frames, {:.0f} KB each, {:.1f} Mbit/s{}{}\n", stream, size_text(published.bytes), frames,
         bytes_per_frame / 1000, mbps, quality, paint);
    if (scene.stage && !options.web.empty())
        say("{}: only the clip is in the page; with all of the stage: neuvv export {} --as web\n", page, options.scene);
    if (options.is_one_file())
        tell("{}: {} as one page, which browsers open from the disk, too\n", page,
             size_text(std::filesystem::file_size(page)));
    else if (!options.web.empty())
        tell("{} plays it from any file server that answers ranges: tools/serve {}\n", page, options.web);
}

void run(const PublishOptions& options, const CommonOptions& common) {
    const bool alone = options.web.empty();
    if (alone && std::filesystem::path(options.output).extension() != ".nvs")
        throw InputError("--output", options.output, "does not end with .nvs", "name it so");
    if (alone) prepare_result("--output", options.output);
    const PublishedScene scene = read_published_scene(options.scene, options.performer, options.up);
    if (alone) voctree::expect_no_stream(scene.clip);
    report(options, scene,
           alone ? publish_stream(options, scene, common, options.output) : publish_page(options, scene, common));
}

}  // namespace

void add_publish(Command app, CommonOptions& common) {
    Command verb = app.add_verb("publish", "Write a clip as a stream: a quarter of the bytes or less, to be played");
    const auto options = std::make_shared<PublishOptions>();
    verb.add_option("scene", options->scene,
                    "The .nvv, in segments or not, the .npz of a PlenOctree, or a stage, .gltf or .glb; for --web "
                    "also a .nvs")
        .required();
    verb.add_option("--performer", options->performer,
                    "Of a stage: which, by its name or index; may be left out where there is one");
    Command result = verb.add_group("What is written");
    result.add_option("-o,--output", options->output, "The .nvs to write");
    result.add_option("--web", options->web,
                      "A folder to write for any file server that answers ranges: the stream, and a page that plays "
                      "it in browsers; or a .html of at most 20 MB that has all of it, which browsers open from the "
                      "disk, too");
    result.require_options(1, 1);
    add_up_option(verb, options->up);
    add_encoding_options(verb, options->encoding);
    verb.add_option("--views", options->encoding.views, "Images that are compared, over one orbit as the clip plays")
        .in_range(1, 100)
        .show_default();
    verb.add_option("--size", options->encoding.size, "WIDTHxHEIGHT of them").show_default();
    verb.add_flag("--json", options->json,
                  "Print JSON: output, page, bytes (of the stream), page_bytes (of a page of one file), frames,\n"
                  "bytes_per_frame, mbps, most_mbps (of a group), psnr_db, paint_layers");
    verb.footer(
        {"A stream has every frame as it is shown. It is played as the clip is, but it cannot be trained on or "
         "painted,\nand between two frames it shows the nearer one. Segments that overlap do not fade into each other "
         "there.\n--quality is measured on frames by themselves; that frames repeat what stays is not.\n"
         "Of a stage, a performer's clip is written with the visible layers of its paint in it. Nothing else of the "
         "stage\ngoes along: neither transform, time map, lights nor opacity, nor the performer's own sound; the "
         "clip's sound does.\n"
         "--web takes the player for browsers that tools/web/build has made (`tools/install-packages web` installs "
         "what that\nneeds), and copies a .nvs as it is.\n",
         kDeviceHelp, kExamplesHead,
         "  neuvv publish work/performer.nvv -o work/performer.nvs\n"
         "  neuvv publish work/performer.nvv -o work/phone.nvs --rate 10\n"
         "  neuvv publish work/phone.nvs --web work/web\n"
         "  neuvv publish work/phone.nvs --web work/phone.html\n"
         "  neuvv render work/performer.nvs -o work/turn.mp4\n"
         "  neuvv info https://example.com/performer.nvs\n"
         "  neuvv stage new work/show.gltf\n"
         "  neuvv stage add work/show.gltf work/performer.nvv --name anna\n"
         "  neuvv paint region work/show.gltf work/anna.nvpaint --node anna --box -1,0,-1,1,0.9,1 --hue 120\n"
         "  neuvv publish work/show.gltf --performer anna -o work/anna.nvs"});
    verb.callback([options, verb, &common] {
        for (const char* name : {"--rate", "--quality", "--group", "--views", "--size"})
            if (verb.count(name) > 0) options->given_encoding = name;
        run(*options, common);
    });
}

}  // namespace neuvv::tools
