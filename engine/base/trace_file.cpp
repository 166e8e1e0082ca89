#include "base/trace_file.h"

#include <fmt/format.h>

#include <atomic>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/platform.h"

namespace neuvv {

namespace {

struct Span {
    uint32_t lane = 0;
    std::string name;
    TraceClock::time_point begin, end;
};

// All of the process.
struct Trace {
    std::atomic<bool> is_on = false;
    std::mutex mutex;  // guards what follows
    TraceClock::time_point begin;
    std::vector<Span> spans;
    size_t left_out = 0;
    std::vector<std::string> lanes;  // their names
    std::map<std::string, uint32_t> lanes_by_name;
};

Trace& trace() {
    static Trace one;
    return one;
}

thread_local std::string this_thread;          // as it was named
thread_local uint32_t this_lane = UINT32_MAX;  // not known yet

uint32_t lane_of_this_thread_locked(Trace& all) {
    if (this_lane == UINT32_MAX) {
        this_lane = static_cast<uint32_t>(all.lanes.size());
        all.lanes.push_back(this_thread.empty() ? fmt::format("thread {}", this_lane) : this_thread);
    }
    return this_lane;
}

void keep_locked(Trace& all, Span span) {
    if (all.spans.size() < kMostSpans)
        all.spans.push_back(std::move(span));
    else
        ++all.left_out;
}

double microseconds(TraceClock::duration duration) {
    return std::chrono::duration<double, std::micro>(duration).count();
}

}  // namespace

void begin_trace() {
    Trace& all = trace();
    const std::lock_guard lock(all.mutex);
    all.begin = TraceClock::now();
    all.is_on = true;
}

bool is_tracing() {
    return trace().is_on.load(std::memory_order_relaxed);
}

void name_trace_thread(const std::string& name) {
    this_thread = name;
}

void add_trace_span(const std::string& lane, const std::string& name, TraceClock::time_point begin,
                    TraceClock::time_point end) {
    if (!is_tracing()) return;
    Trace& all = trace();
    const std::lock_guard lock(all.mutex);
    const auto [found, is_new] = all.lanes_by_name.emplace(lane, static_cast<uint32_t>(all.lanes.size()));
    if (is_new) all.lanes.push_back(lane);
    keep_locked(all, {found->second, name, begin, end});
}

TraceSpan::TraceSpan(const char* name, int64_t number) : name_(is_tracing() ? name : nullptr), number_(number) {
    if (name_) begin_ = TraceClock::now();
}

TraceSpan::TraceSpan(const char* name, const std::string& word) : TraceSpan(name) {
    if (name_) word_ = word;
}

TraceSpan::~TraceSpan() {
    if (!name_) return;
    const TraceClock::time_point end = TraceClock::now();
    Trace& all = trace();
    const std::string shown = number_ != kNoNumber ? fmt::format("{} {}", name_, number_)
                              : word_.empty()      ? std::string(name_)
                                                   : fmt::format("{}: {}", name_, word_);
    const std::lock_guard lock(all.mutex);
    keep_locked(all, {lane_of_this_thread_locked(all), shown, begin_, end});
}

// The format: https://docs.google.com/document/d/1CvAClvFfyA5R-PhYUmn5OOQtYMH4h6I0nSsKchNAySU, "complete" events.
void write_trace(const std::filesystem::path& file) {
    Trace& all = trace();
    const std::lock_guard lock(all.mutex);
    write_file_atomically(file, [&](const ByteSink& sink) {
        const auto put = [&](const std::string& text) { sink(text.data(), text.size()); };
        put(fmt::format("{{\"otherData\": {{\"spans left out\": {}}}, \"traceEvents\": [\n", all.left_out));
        for (size_t lane = 0; lane < all.lanes.size(); ++lane)
            put(fmt::format(
                "{}{{\"ph\": \"M\", \"name\": \"thread_name\", \"pid\": 1, \"tid\": {}, \"args\": {{\"name\": {}}}}}",
                lane == 0 ? "" : ",\n", lane, nlohmann::json(all.lanes[lane]).dump()));
        for (const Span& span : all.spans)
            put(fmt::format(
                ",\n{{\"ph\": \"X\", \"name\": {}, \"pid\": 1, \"tid\": {}, \"ts\": {:.3f}, \"dur\": {:.3f}}}",
                nlohmann::json(span.name).dump(), span.lane, microseconds(span.begin - all.begin),
                microseconds(span.end - span.begin)));
        put("\n]}\n");
    });
}

}  // namespace neuvv
