// Gives a loader damaged data sets, stages, clips, layers of paint or packets. It is built with AddressSanitizer and
// UndefinedBehaviorSanitizer, whose limits are set here, too. Where it fails, it keeps the damaged data set.
//
//     fuzz CORPUS [SECONDS [SEED]]      CORPUS/*: valid data sets of one layout, images included
//     fuzz --replay FOLDER              one data set, without further damage

#include <sanitizer/asan_interface.h>
#include <sanitizer/common_interface_defs.h>
#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "base/platform.h"
#include "fuzz/mutate.h"
#include "fuzz/verdict.h"
#include "motion/live/vmc.h"
#include "motion/skeleton/skeleton_file.h"
#include "motion/video/key_points.h"
#include "voctree/files/clip.h"
#include "voctree/files/nvpaint.h"

// The sanitizer's runtime calls this before main. An allocation of more than a gibibyte is a failure.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
    return "max_allocation_size_mb=1024:hard_rss_limit_mb=3072:detect_leaks=0:abort_on_error=0:"
           "allocator_may_return_null=0";
}

namespace {

namespace fs = std::filesystem;
using namespace neuvv;

constexpr int kSecondsPerInput = 5;
constexpr size_t kMaxFile = size_t{1} << 16;

std::string g_kept;  // the folder of the current data set, for the report of a crash

void say_where() {
    std::fprintf(stderr, "fuzz: FAILED; again with: fuzz --replay %s\n", g_kept.c_str());
}

void on_alarm(int) {
    std::fprintf(stderr, "fuzz: more than %d s for one input\n", kSecondsPerInput);
    say_where();
    _exit(1);
}

void set_alarm(int seconds) {
    const itimerval timer{{0, 0}, {seconds, 0}};
    setitimer(ITIMER_REAL, &timer, nullptr);
}

std::string read(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void write(const fs::path& path, const std::string& bytes) {
    std::ofstream file(path, std::ios::binary);
    file << bytes;
    if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
}

// Images and videos are not damaged: the libraries that read them have their own fuzzers.
bool is_calibration(const fs::path& path) {
    static const std::set<std::string> kImages = {".png", ".jpg", ".mp4"};
    return !kImages.contains(path.extension().string());
}

struct Sample {
    fs::path folder;              // the copy that is damaged
    std::vector<fs::path> files;  // the files of the copy that may be damaged
    std::vector<std::string> bytes;
};

std::vector<Sample> copy_samples(const fs::path& corpus, const fs::path& work) {
    std::vector<Sample> samples;
    std::set<fs::path> folders;  // sorted, so that the order is the same on every system
    for (const auto& entry : fs::directory_iterator(corpus)) folders.insert(entry.path());
    for (const fs::path& from : folders) {
        Sample sample;
        sample.folder = work / from.filename();
        fs::copy(from, sample.folder, fs::copy_options::recursive);
        std::set<fs::path> files;
        for (const auto& entry : fs::recursive_directory_iterator(sample.folder))
            if (entry.is_regular_file() && is_calibration(entry.path())) files.insert(entry.path());
        sample.files.assign(files.begin(), files.end());
        for (const fs::path& file : sample.files) sample.bytes.push_back(read(file));
        samples.push_back(std::move(sample));
    }
    if (samples.empty()) throw std::runtime_error("no data set in " + corpus.string());
    return samples;
}

// What a folder contains decides what it is: a stage, a skeleton, a detector's key points or a packet of the VMC
// protocol, a layer of paint on a clip, a clip, else a data set.
fs::path stage_in(const fs::path& folder) {
    for (const char* name : {"stage.gltf", "stage.glb"})
        if (fs::exists(folder / name)) return folder / name;
    return {};
}

fs::path skeleton_in(const fs::path& folder) {
    for (const char* name : {"skeleton.glb", "skeleton.bvh", "skeleton.trc", "key_points.json", "packet.osc"})
        if (fs::exists(folder / name)) return folder / name;
    return {};
}

// Key points of one image, and the body of a packet, are a clip of one frame.
motion::SkeletonClip read_motion(const fs::path& file) {
    if (file.extension() != ".json" && file.extension() != ".osc") return motion::read_skeleton(file);
    motion::SkeletonClip clip;
    clip.frames.resize(1);
    if (file.extension() == ".osc") {
        motion::VmcBody body;
        body.read(read_file(file), file.string());
        if (const auto poses = body.take(file.string())) clip.frames[0] = poses->newest;
        return clip;
    }
    const motion::KeyPointFile read = motion::read_key_points(file);
    const motion::KeyPointLayout* const layout = motion::layout_of(read.images);
    if (!layout) return clip;
    const motion::ImagePeople& image =
        *std::ranges::find_if(read.images, [](auto& one) { return !one.people.empty(); });
    if (image.people[0].size() != layout->points) return clip;
    const motion::KeyPoints joints = motion::joints_of(image.people[0], *layout);
    for (size_t j = 0; j < motion::kJoints; ++j) clip.frames[0][j] = {{joints[j].pixel, 0}, joints[j].confidence, true};
    return clip;
}

fs::path clip_name(const fs::path& folder) {
    for (const char* name : {"scene.nvv", "scene.npz"})
        if (fs::exists(folder / name)) return folder / name;
    return {};
}

voctree::VOctree clip_in(const fs::path& folder) {
    return voctree::read_clip(clip_name(folder));
}

voctree::EditLayer paint_in(const fs::path& folder) {
    return voctree::read_paint(folder / "layer.nvpaint", voctree::painted_field(clip_in(folder)));
}

training::Dataset dataset_in(const fs::path& folder, training::Split split) {
    return training::load_dataset(folder, split, {.mattes_needed = false});
}

// Loads a folder that must be valid; throws where it is not.
void load(const fs::path& folder) {
    if (const fs::path stage = stage_in(folder); !stage.empty())
        stage::load_stage(stage);
    else if (const fs::path skeleton = skeleton_in(folder); !skeleton.empty())
        read_motion(skeleton);
    else if (fs::exists(folder / "layer.nvpaint"))
        paint_in(folder);
    else if (!clip_name(folder).empty())
        clip_in(folder);
    else
        for (const training::Split split : {training::Split::kTrain, training::Split::kTest}) dataset_in(folder, split);
}

std::string complaint_about_folder(const fs::path& folder) {
    if (const fs::path stage = stage_in(folder); !stage.empty())
        return fuzz::complaint_about_stage([&] { return stage::load_stage(stage); });
    if (const fs::path skeleton = skeleton_in(folder); !skeleton.empty())
        return fuzz::complaint_about_skeleton([&] { return read_motion(skeleton); });
    if (fs::exists(folder / "layer.nvpaint")) return fuzz::complaint_about_paint([&] { return paint_in(folder); });
    if (!clip_name(folder).empty()) return fuzz::complaint_about_clip([&] { return clip_in(folder); });
    for (const training::Split split : {training::Split::kTrain, training::Split::kTest})
        if (const std::string complaint = fuzz::complaint_about([&] { return dataset_in(folder, split); });
            !complaint.empty())
            return complaint;
    return {};
}

// Empty where loading ends in a permitted way, else what is wrong.
std::string try_folder(const fs::path& folder) {
    g_kept = folder.string();
    set_alarm(kSecondsPerInput);
    const std::string complaint = complaint_about_folder(folder);
    set_alarm(0);
    return complaint;
}

// Half of the damage to .nvv and .nvpaint files is made before their checksums are computed.
std::string damaged(const Sample& sample, size_t file, const std::vector<std::string>& pool, fuzz::Random& random) {
    const bool container = sample.bytes[file].starts_with("\x89NVV");
    if (container && random() % 2) return fuzz::mutate_chunks(sample.files[file], pool, kMaxFile, random);
    return fuzz::mutate(sample.bytes[file], pool, kMaxFile, random);
}

int fail(const std::string& complaint) {
    std::fprintf(stderr, "fuzz: %s\n", complaint.c_str());
    say_where();
    return 1;
}

int run(const fs::path& corpus, double seconds, uint64_t seed) {
    const fs::path work =
        fs::temp_directory_path() / ("neuvv-fuzz-" + corpus.filename().string() + "-" + std::to_string(getpid()));
    fs::create_directories(work);
    const std::vector<Sample> samples = copy_samples(corpus, work);
    std::vector<std::string> pool;
    for (const Sample& sample : samples) {
        g_kept = sample.folder.string();
        load(sample.folder);  // throws where the corpus itself is not valid
        pool.insert(pool.end(), sample.bytes.begin(), sample.bytes.end());
    }
    fuzz::Random random(seed);
    uint64_t inputs = 0;
    const auto start = std::chrono::steady_clock::now();
    const auto elapsed = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    for (; elapsed() < seconds; ++inputs) {
        const Sample& sample = samples[random() % samples.size()];
        const size_t file = random() % sample.files.size();
        write(sample.files[file], damaged(sample, file, pool, random));
        if (const std::string complaint = try_folder(sample.folder); !complaint.empty()) return fail(complaint);
        write(sample.files[file], sample.bytes[file]);
    }
    fs::remove_all(work);
    std::printf("fuzz: %s: %llu inputs in %.0f s, seed %llu\n", corpus.filename().c_str(),
                static_cast<unsigned long long>(inputs), elapsed(), static_cast<unsigned long long>(seed));
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> arguments(argv + 1, argv + argc);
    const bool replay = arguments.size() == 2 && arguments[0] == "--replay";
    if (arguments.empty() || arguments.size() > 3 || (arguments[0] == "--replay" && !replay)) {
        std::fprintf(stderr, "fuzz CORPUS [SECONDS [SEED]] | fuzz --replay FOLDER\n");
        return 2;
    }
    signal(SIGALRM, on_alarm);
    __sanitizer_set_death_callback(say_where);
    try {
        if (replay) {
            const std::string complaint = try_folder(arguments[1]);
            return complaint.empty() ? 0 : fail(complaint);
        }
        const double seconds = arguments.size() > 1 ? std::stod(arguments[1]) : 60;
        return run(arguments[0], seconds, arguments.size() > 2 ? std::stoull(arguments[2]) : 1);
    } catch (const std::exception& error) {
        return fail(error.what());
    }
}
