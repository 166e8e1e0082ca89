// What the verbs print alike: the progress of a long task, JSON for scripts, durations, sizes and pass times for
// people.
#pragma once

#include <chrono>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "gpu/commands.h"
#include "training/tree/doubtful_mattes.h"

namespace neuvv::tools {

// A line on stderr: on a terminal it is redrawn up to five times a second, in a log it is a new line every 10 s, or
// as often as NEUVV_STATUS_MS says.
class StatusLine {
  public:
    // `at_once`: the first line of a log does not wait for 10 s.
    explicit StatusLine(bool at_once);
    ~StatusLine() { end(); }
    StatusLine(const StatusLine&) = delete;
    StatusLine& operator=(const StatusLine&) = delete;

    // Whether the line is due again; true once for each time. Cheap to call often.
    bool is_due();
    void print(const std::string& text);
    // Ends the line on a terminal, so that other text can follow.
    void end();

  private:
    using Clock = std::chrono::steady_clock;
    bool terminal_;
    std::chrono::milliseconds period_;
    size_t printed_ = 0;  // characters of the line on the terminal
    Clock::time_point next_;
};

// A status line that says how far a long task is, and how long it will still take.
class Progress {
  public:
    explicit Progress(std::string label, uint64_t total = 0);
    ~Progress() { finish(); }
    // For a task whose length is not known when it begins. Call it before update().
    void set_total(uint64_t total) { total_ = total; }

    // Cheap to call often. `detail` follows the figures.
    void update(uint64_t done, std::string detail = "");
    // Prints the last state and ends the line; the destructor does so too.
    void finish();

  private:
    void print();

    std::string label_, detail_;
    uint64_t total_, done_ = 0;
    bool unprinted_ = false;  // whether the last state has yet to be printed
    std::chrono::steady_clock::time_point start_;
    StatusLine line_;
};

// "4.2 s", "3:07", "1:02:30"; "?" for a negative or endless duration.
std::string format_duration(double seconds);

// "12.3 MB".
std::string size_text(uint64_t bytes);

// "texel", "storage".
const char* profile_name(gpu::BufferProfile profile);
// "texel buffers (1.02 ms, storage buffers 1.20 ms)": how passes of the device bind long arrays, and why.
std::string profile_text(const gpu::BufferLimits& limits);

// Whether NEUVV_TRACE asks for the times of passes.
bool trace_wanted();
// "slice 1.20 ms, trace 20.10 ms, together 21.30 ms".
std::string pass_times_text(const std::vector<gpu::PassTime>& times);

// The part of a --help that verbs on the GPU share.
constexpr const char* kDeviceHelp =
    "--device NAME or NEUVV_DEVICE=NAME chooses the Vulkan device; `neuvv devices` lists them.";

// Before the examples of verbs that need a trained scene.
constexpr const char* kExamplesHead =
    "\n\nExamples, after `neuvv capture tools/performer/performer.glb -o work/performer` and\n"
    "`neuvv train work/performer -o work/performer.nvv`:\n";

// A line for each doubtful matte, at most ten, and what to do about them; empty where there are none.
std::string doubtful_mattes_text(const training::Dataset& dataset, const std::vector<training::DoubtfulMatte>& mattes);

// Where a clip's origin and metre are in the coordinates of its capture; null where those are the same.
nlohmann::ordered_json capture_json(const std::filesystem::path& clip);
// The same as a line for people; empty where the coordinates are the same.
std::string capture_line(const std::filesystem::path& clip);

// Says on stderr what of a file is not shown (GltfScene::notes), a line each.
void say_notes(const std::string& file, const std::vector<std::string>& notes);

// Says which segments of clips cannot be read, and so are not shown (StageRenderer::take_problems).
void say_not_shown(const std::vector<Note>& problems);

// Says on stderr what the loader of a data set decided by itself.
void say_remarks(const std::vector<std::string>& remarks);

}  // namespace neuvv::tools
