#include "training/capture/capture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <thread>

#include "base/error.h"
#include "base/platform.h"
#include "base/threads/workers.h"
#include "media/jpeg.h"
#include "media/video.h"
#include "motion/skeleton/model_motion.h"
#include "motion/skeleton/skeleton_file.h"
#include "render/set/raster.h"
#include "stage/pose.h"
#include "training/capture/backdrop.h"
#include "training/capture/capture_files.h"
#include "training/capture/floor_shadow.h"
#include "training/capture/studio.h"

namespace neuvv::training {

namespace {

constexpr double kBoxMargin = 0.02;   // around the motion's box, as a share of its diagonal
constexpr double kMaxExtent_m = 1e5;  // transforms may have distances of up to 1e6 m
constexpr double kMinExtent_m = 1e-3;
constexpr uint64_t kMaxWaiting_bytes = uint64_t{1} << 29;  // of images that are rendered but not yet written
constexpr uint32_t kMaxCameras = 10000, kMaxFrames = 100000;

void check_settings(const CaptureSettings& s) {
    const auto expect = [](bool good, const char* setting, const std::string& problem, const Fix& fix) {
        if (!good) throw InputError(Setting{setting}, "", problem, fix);
    };
    const uint32_t side = media::kMaxImageSide / render::kSupersample;
    expect(s.cameras >= 1 && s.cameras <= kMaxCameras, "cameras", fmt::format("{} is out of range", s.cameras),
           "choose 1 to 10000");
    expect(s.frames >= 1 && s.frames <= kMaxFrames, "frames", fmt::format("{} is out of range", s.frames),
           "choose 1 to 100000");
    expect(s.fps > 0 && s.fps <= 1e6, "fps", fmt::format("{} is no number of frames a second", s.fps),
           "choose for instance 25");
    expect(std::min(s.width, s.height) >= 8 && std::max(s.width, s.height) <= side, "size",
           fmt::format("{}x{} is out of range", s.width, s.height), "choose 8 to 8192 a side");
    expect(s.holdout >= 0 && s.holdout < 1, "holdout", fmt::format("{} is not a share", s.holdout),
           "choose 0 to below 1");
    expect(s.holdout == 0 || s.cameras >= 2, "holdout", "one camera cannot be kept back and used too",
           Remedy::kMoreCameras);
    expect(!s.videos || (s.width % 2 == 0 && s.height % 2 == 0), "size",
           fmt::format("{}x{} has an odd side, which no video has", s.width, s.height), "choose even sides");
    const std::vector<bool> is_test = held_out(s.cameras, s.holdout);
    const auto train = std::count(is_test.begin(), is_test.end(), false);
    expect(s.holdout == 0 || train >= 2, "holdout",
           fmt::format("{} leaves one of {} cameras to train with, which shows no volume", s.holdout, s.cameras),
           Remedy::kMoreCameras);
    if (!s.studio) return;
    expect(train >= kMinStudioCameras, "cameras", fmt::format("{} that train are too few for a studio", train),
           fmt::format("choose more, so that {} train", kMinStudioCameras));
}

int32_t choose_animation(const stage::GltfScene& scene, const std::string& name) {
    if (!name.empty()) return static_cast<int32_t>(stage::find_animation(scene, name));
    return scene.animations.empty() ? stage::kNoAnimation : 0;
}

std::vector<double> frame_times(const stage::GltfScene& scene, int32_t animation, const CaptureSettings& settings) {
    std::vector<double> times;
    const double end =
        animation == stage::kNoAnimation ? 0 : scene.animations[static_cast<size_t>(animation)].duration_s;
    for (uint32_t f = 0; f < settings.frames; ++f) times.push_back(std::min(f / settings.fps, end));
    return times;
}

// The positions that triangles use.
void gather_points(const stage::GltfPrimitive& primitive, const stage::PosedVertices& vertices,
                   std::vector<glm::vec3>& points) {
    std::vector<bool> seen(vertices.positions.size(), false);
    points.clear();
    for (const uint32_t index : primitive.indices) {
        if (!seen[index]) points.push_back(vertices.positions[index]);
        seen[index] = true;
    }
}

// Calls `use_points` with the world positions of each primitive at each of these times.
void for_each_pose(const stage::GltfScene& scene, int32_t animation, const std::vector<double>& times,
                   const std::function<void(const std::vector<glm::vec3>&)>& use_points) {
    stage::PosedVertices vertices;
    std::vector<glm::vec3> points;
    for (size_t i = 0; i < times.size(); ++i) {
        if (i > 0 && times[i] == times[i - 1]) continue;
        const stage::PosedScene pose = stage::pose_scene(scene, animation, times[i]);
        for (uint32_t n = 0; n < scene.nodes.size(); ++n) {
            if (!scene.nodes[n].draws_mesh()) continue;
            for (const stage::GltfPrimitive& primitive :
                 scene.meshes[static_cast<size_t>(scene.nodes[n].mesh)].primitives) {
                stage::pose_vertices(scene, pose, n, primitive, vertices);
                gather_points(primitive, vertices, points);
                use_points(points);
            }
        }
    }
}

bool shows_room(const CaptureSettings& settings) {
    return settings.studio || settings.background == CaptureBackground::kChecker;
}

// Creates the folders and removes older transforms: where a new capture into the folder is interrupted, they would name
// images of two captures.
void prepare_folder(const std::filesystem::path& folder, const CaptureSettings& settings) {
    std::error_code error;
    for (const char* name : {"transforms_train.json", "transforms_test.json", kTrueSkeleton, kStudioTruth}) {
        std::filesystem::remove(folder / name, error);
        if (error)
            throw RuntimeFailure(fmt::format("{}: cannot remove: {}", (folder / name).string(), error.message()));
    }
    std::vector<const char*> names{"images"};
    if (shows_room(settings)) names.push_back("plates");
    if (settings.videos)
        names.push_back("videos");
    else if (settings.studio)
        names.push_back("mattes");
    for (const char* name : names) {
        std::filesystem::create_directories(folder / name, error);
        if (error)
            throw RuntimeFailure(fmt::format("{}: cannot create: {}", (folder / name).string(), error.message()));
    }
}

// What a camera would record: foreground + (1 − α) background, in linear light; alpha is the matte.
media::Image compose(std::span<const glm::vec4> premultiplied, const media::Image& plate) {
    media::Image image = plate;
    for (size_t i = 0; i < premultiplied.size(); ++i) {
        uint8_t* pixel = &image.rgba[4 * i];
        const glm::vec4 light = premultiplied[i];
        const auto alpha = static_cast<uint8_t>(std::lround(std::clamp(light.a, 0.0f, 1.0f) * 255));
        pixel[3] = alpha;
        if (light.a <= 0) continue;
        for (int c = 0; c < 3; ++c) {
            const double behind = media::linear_from_srgb(pixel[c] / 255.0);
            const double sum = static_cast<double>(light[c]) + (1 - static_cast<double>(light.a)) * behind;
            pixel[c] = static_cast<uint8_t>(std::lround(255 * media::srgb_from_linear(std::clamp(sum, 0.0, 1.0))));
        }
    }
    return image;
}

Backdrop backdrop_of(const CaptureStage& stage) {
    const glm::dvec3 centre = 0.5 * (stage.box.first + stage.box.second);
    Backdrop room{centre - 1.5 * stage.radius, centre + 1.5 * stage.radius, stage.radius / 6};
    room.low.y = stage.box.first.y;  // the performer stands on the floor
    return room;
}

// What the steps of a capture share.
struct Session {
    const CaptureSettings& settings;
    const std::filesystem::path& folder;
    const CaptureStage& stage;
    std::optional<Studio> studio;
    std::vector<media::Image> plates;  // by camera; empty with a clear background
    Workers workers;

    bool is_spoilt(size_t camera) const { return studio && !studio->cameras[camera].held_out; }
};

// Writes the plate that a camera of a studio has, right or wrong.
void write_studio_plate(const Session& session, size_t camera) {
    const StudioCamera& with = session.studio->cameras[camera];
    if (with.plate_fault == PlateFault::kMissing) return;
    const size_t shown = with.plate_fault == PlateFault::kOfAnotherCamera ? with.plate_of : camera;
    const media::Image plate = with.plate_fault == PlateFault::kGreen
                                   ? green_plate(session.settings.width, session.settings.height)
                                   : record(*session.studio, shown, kPlateFrame, session.plates[shown]);
    media::write_jpeg(session.folder / "plates" / (camera_name(with.filed_as) + ".jpg"), plate, kStudioJpegQuality);
}

void write_plates(Session& session) {
    if (!shows_room(session.settings)) return;
    session.plates.resize(session.stage.cameras.size());
    const Backdrop room = backdrop_of(session.stage);
    for (size_t c = 0; c < session.plates.size(); ++c)
        session.workers.add([&session, room, c] { session.plates[c] = clean_plate(room, session.stage.cameras[c]); });
    session.workers.finish();
    for (size_t c = 0; c < session.plates.size(); ++c)
        session.workers.add([&session, c] {
            if (session.is_spoilt(c))
                write_studio_plate(session, c);
            else
                media::write_png(session.folder / "plates" / (camera_name(c) + ".png"), session.plates[c]);
        });
    session.workers.finish();
}

// What lies behind the performer: in a studio with a shadow, but not where nothing is done to the camera.
media::Image background_of(const Session& session, size_t camera, const FloorShadow* shadow) {
    const media::Image& plate = session.plates[camera];
    if (!session.is_spoilt(camera)) return plate;
    return shaded(plate, backdrop_of(session.stage), session.stage.cameras[camera], *shadow);
}

void write_image(const Session& session, size_t camera, size_t frame, const render::RasterImage& image,
                 const FloorShadow* shadow) {
    const uint32_t width = session.settings.width, height = session.settings.height;
    const std::vector<glm::vec4> light = render::box_down(image, width, height);
    const std::filesystem::path images = session.folder / "images";
    const media::Image scene = session.plates.empty() ? render::encode_straight(light, width, height)
                                                      : compose(light, background_of(session, camera, shadow));
    if (!session.is_spoilt(camera)) {
        media::write_png(images / (image_name(camera, frame) + ".png"), scene);
        return;
    }
    const Studio& studio = *session.studio;
    const auto number = static_cast<uint32_t>(frame);
    const std::string name = image_name(studio.cameras[camera].filed_as, frame);
    if (session.settings.videos)
        return media::write_png(images / (name + ".png"), record(studio, camera, number, scene));
    media::write_jpeg(images / (name + ".jpg"), record(studio, camera, number, scene), kStudioJpegQuality);
    media::write_png(session.folder / "mattes" / (name + ".png"), studio_matte(studio, camera, number, scene));
}

// Writes the model's own joints. Returns why there is none, empty where there is: not every model is a person.
std::string write_true_skeleton(const std::filesystem::path& folder, const stage::GltfScene& scene, int32_t animation,
                                const CaptureSettings& settings) {
    motion::SkeletonClip clip;
    try {
        clip = motion::model_motion(scene, animation, frame_times(scene, animation, settings), settings.fps);
    } catch (const InputError& error) {
        return error.what();
    }
    motion::write_skeleton(folder / kTrueSkeleton, clip);
    return "";
}

void write_video(const Session& session, size_t camera) {
    const CaptureSettings& settings = session.settings;
    media::VideoWriter video(session.folder / video_file(camera), settings.width, settings.height, settings.fps);
    for (uint32_t f = 0; f < settings.frames; ++f)
        video.add(media::read_png(session.folder / "images" / (image_name(camera, f) + ".png")));
    video.finish();
}

// Makes each camera's images into a video, as many at a time as there are workers, and removes them.
void write_videos(Session& session) {
    for (size_t c = 0; c < session.stage.cameras.size(); ++c)
        session.workers.add([&session, c] { write_video(session, c); });
    session.workers.finish();
    std::error_code error;
    std::filesystem::remove_all(session.folder / "images", error);
    if (error)
        throw RuntimeFailure(
            fmt::format("{}: cannot remove: {}", (session.folder / "images").string(), error.message()));
}

// Last, so that a folder with transforms is complete.
void write_cameras(const Session& session, const std::vector<bool>& is_test) {
    const CaptureSettings& settings = session.settings;
    CapturedClip clip{session.stage.cameras, is_test, settings.frames, settings.fps, session.stage.box};
    clip.videos = settings.videos;
    if (!session.plates.empty()) clip.plates.assign(settings.cameras, true);
    if (std::ranges::find(is_test, true) != is_test.end())
        write_transforms(session.folder / "transforms_test.json", clip);
    clip.written.flip();
    if (session.studio) {
        clip.ending = ".jpg";
        for (const StudioCamera& camera : session.studio->cameras)
            clip.plates[camera.filed_as] = camera.plate_fault != PlateFault::kMissing;
        write_studio_truth(session.folder / kStudioTruth, *session.studio);
    }
    write_transforms(session.folder / "transforms_train.json", clip);
}

// Of the pose that the rasterizer has; null outside of a studio.
std::shared_ptr<const FloorShadow> shadow_of(const Session& session, render::Rasterizer& rasterizer) {
    if (!session.studio) return nullptr;
    const CaptureStage& stage = session.stage;
    const stage::Camera lamp =
        lamp_above(stage.cameras.front(), 0.5 * (stage.box.first + stage.box.second), stage.radius);
    return std::make_shared<const FloorShadow>(
        lamp, render::box_down(rasterizer.draw(lamp, 1e-3 * stage.radius), lamp.width, lamp.height));
}

// Returns false where the caller stopped it.
bool render_images(Session& session, const gpu::Device& device, const stage::GltfScene& scene, int32_t animation,
                   const CaptureProgress& progress) {
    const CaptureSettings& settings = session.settings;
    render::Rasterizer rasterizer(device, scene, settings.width, settings.height);
    const std::vector<double> times = frame_times(scene, animation, settings);
    const uint64_t total = uint64_t{settings.frames} * settings.cameras, before = session.workers.finished();
    for (size_t f = 0; f < times.size(); ++f) {
        rasterizer.pose(stage::pose_scene(scene, animation, times[f]));
        const std::shared_ptr<const FloorShadow> shadow = shadow_of(session, rasterizer);
        for (size_t c = 0; c < session.stage.cameras.size(); ++c) {
            if (progress && !progress(session.workers.finished() - before, total)) return false;
            const render::RasterImage drawn = rasterizer.draw(session.stage.cameras[c], 1e-3 * session.stage.radius);
            session.workers.add(
                [&session, c, f, shadow, drawn, halves = std::vector(drawn.halves.begin(), drawn.halves.end())] {
                    render::RasterImage image = drawn;
                    image.halves = halves;
                    write_image(session, c, f, image, shadow.get());
                });
        }
    }
    session.workers.finish();
    return !progress || progress(total, total);
}

}  // namespace

CaptureStage make_stage(const stage::GltfScene& scene, int32_t animation, const CaptureSettings& settings) {
    const std::vector<double> times = frame_times(scene, animation, settings);
    CaptureStage stage;
    stage.dome = dome_cameras(settings.cameras);
    stage.box = stage::bounds_over(scene, animation, times);
    const double extent = glm::length(stage.box.second - stage.box.first);
    const glm::dvec3 farthest = glm::max(glm::abs(stage.box.first), glm::abs(stage.box.second));
    if (!(extent >= kMinExtent_m) || !(std::max({farthest.x, farthest.y, farthest.z}) <= kMaxExtent_m))
        throw InputError(scene.file, "", fmt::format("the motion's box has a diagonal of {:.3g} m", extent),
                         "scale the model to metres and put it near the origin");
    DomeFit fit = dome_fit(0.5 * (stage.box.first + stage.box.second), settings.width, settings.height);
    for_each_pose(scene, animation, times,
                  [&](const std::vector<glm::vec3>& points) { include_points(fit, stage.dome, points); });
    stage.radius = fit.radius;
    for (const DomeCamera& camera : stage.dome)
        stage.cameras.push_back(make_camera(camera, fit, settings.width, settings.height));
    stage.box.first -= kBoxMargin * extent;
    stage.box.second += kBoxMargin * extent;
    return stage;
}

CaptureResult capture(const gpu::Device& device, const std::filesystem::path& model,
                      const std::filesystem::path& folder, const CaptureSettings& settings,
                      const CaptureProgress& progress) {
    check_settings(settings);
    const stage::GltfScene scene = stage::load_gltf(model);
    const int32_t animation = choose_animation(scene, settings.animation);
    const CaptureStage stage = make_stage(scene, animation, settings);
    const std::vector<bool> is_test = held_out(settings.cameras, settings.holdout);
    prepare_folder(folder, settings);

    CaptureResult result;
    result.notes = scene.notes;
    if (settings.animation.empty() && scene.animations.size() > 1)
        result.notes.push_back(fmt::format("has {} animations, of which the first is shown: {} \"{}\"",
                                           scene.animations.size(), 0, scene.animations[0].name));
    result.images = uint64_t{settings.frames} * settings.cameras;
    result.test_cameras = static_cast<uint32_t>(std::count(is_test.begin(), is_test.end(), true));
    result.train_cameras = settings.cameras - result.test_cameras;
    const uint32_t threads = std::max(1u, std::thread::hardware_concurrency());
    const uint64_t image_bytes =
        uint64_t{8} * render::kSupersample * render::kSupersample * settings.width * settings.height;
    const uint64_t waiting = std::clamp<uint64_t>(kMaxWaiting_bytes / image_bytes, 1, 2 * threads);
    std::optional<Studio> studio;
    if (settings.studio) studio = make_studio(*settings.studio, is_test, settings.frames);
    if (studio && settings.videos) studio->wrong_mattes.clear();  // there are none
    Session session{settings, folder, stage, std::move(studio), {}, Workers(threads, waiting)};
    write_plates(session);
    if (!render_images(session, device, scene, animation, progress)) return result;
    if (settings.videos) write_videos(session);
    result.no_skeleton = write_true_skeleton(folder, scene, animation, settings);
    write_cameras(session, is_test);
    result.complete = true;
    return result;
}

}  // namespace neuvv::training
