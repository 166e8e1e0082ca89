// Trace file: what each thread and the device did when, as JSON in Chrome's trace event format, which
// https://ui.perfetto.dev and chrome://tracing show. A program has one at most.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

namespace neuvv {

using TraceClock = std::chrono::steady_clock;

// From now on, spans are kept, kMostSpans of them; later ones are left out.
constexpr size_t kMostSpans = 2'000'000;
void begin_trace();
// Cheap to ask often.
bool is_tracing();
// Writes the spans that are kept, and says how many were left out. Throws RuntimeFailure.
void write_trace(const std::filesystem::path& file);

// How the thread that calls it is named in the trace.
void name_trace_thread(const std::string& name);

// A span that no thread of this process did: `lane` says who, for instance the device.
void add_trace_span(const std::string& lane, const std::string& name, TraceClock::time_point begin,
                    TraceClock::time_point end);

// What this thread does for as long as the object lives. Spans of a thread may lie within each other. It costs nothing
// to speak of where nobody traces.
class TraceSpan {
  public:
    static constexpr int64_t kNoNumber = -1;
    // `name` must outlive the span. The number, of a frame for instance, is shown behind it.
    explicit TraceSpan(const char* name, int64_t number = kNoNumber);
    // The same with a word in place of the number.
    TraceSpan(const char* name, const std::string& word);
    ~TraceSpan();
    TraceSpan(const TraceSpan&) = delete;
    TraceSpan& operator=(const TraceSpan&) = delete;

  private:
    const char* name_;  // null: nobody traces
    int64_t number_ = kNoNumber;
    std::string word_;
    TraceClock::time_point begin_;
};

}  // namespace neuvv
