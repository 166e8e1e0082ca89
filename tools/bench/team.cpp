// neuvv-bench team: a step of several processes that train one tree together, predicted for a network from what each of
// them computes here, one after the other.
#include <fmt/format.h>

#include <bit>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/error.h"
#include "base/platform.h"
#include "base/seconds.h"
#include "tools/bench/measure.h"
#include "tools/commands.h"
#include "tools/options.h"
#include "tools/report.h"
#include "training/data/layouts/formats.h"
#include "training/run/schedule.h"
#include "training/run/train.h"
#include "training/step/batch.h"
#include "voctree/files/clip.h"

namespace neuvv::bench {

namespace {

using training::Bytes;

struct TeamOptions : BenchOptions {
    std::string dataset, format = training::kAnyFormat;
    std::vector<uint32_t> members{2, 8, 64};
    uint32_t tiles = 512;
    double gigabytes_per_s = 12.5, latency_us = 5;
};

// Stands in for all members of a team: steps of theirs run one after the other, and what each would send is kept.
struct StandIn {
    explicit StandIn(uint32_t given_members) : members(given_members) {}

    training::Team team() {
        return {0, members, [this](std::span<const uint8_t> own) { return gather(own); },
                [this](const std::vector<Bytes>& to) {
                    sent.push_back(to);
                    return std::vector<Bytes>(to.size());  // there is nothing to add up during the step
                }};
    }

    uint32_t members;
    std::vector<std::vector<Bytes>> sent;  // by sender, then by receiver
    std::vector<Bytes> sums;               // what the members' shares add up to; empty: one member's records alone

  private:
    // A step gathers its members' results first, then their sums.
    std::vector<Bytes> gather(std::span<const uint8_t> own) {
        if (std::exchange(is_result_, !is_result_)) return std::vector(members, Bytes(own.begin(), own.end()));
        return sums.empty() ? sent.back() : sums;
    }
    bool is_result_ = true;
};

// Collective calls of a step: agreeing to go on, results, exchanging records and gathering sums, each with a call for
// the sizes before it.
constexpr uint32_t kCallsAStep = 8;

// A step of a team, in milliseconds.
struct Cost {
    double device = 0, host = 0, network = 0;
    double sum() const { return device + host + network; }
};

struct TeamStep {
    uint32_t members = 1;
    double rays = 0, touched = 0, touched_by_all = 0;  // rays of all members; leaves by a member, and by all
    double megabytes = 0;                              // that a member receives
    Cost shared, everything;  // each member adds up its share of the leaves; each one adds up everything
};

struct Bench {
    const gpu::Device& device;
    const voctree::VOctree& tree;
    const training::Dataset& dataset;
    const TeamOptions& options;
    uint32_t words = record_words(tree.hh_degree);

    // The step of one member's share of a batch. Learning rates are 0, so weights stay as they are.
    training::StepResult run(training::TrainingStep& step, uint32_t member, uint32_t members) const {
        training::BatchSampler sampler(dataset, options.tiles * members, 1);
        const training::Batch batch = sampler.next(1, member, members);
        training::StepSettings settings;
        settings.frame = static_cast<float>(training::frame_of_time(batch.time, tree.frames));
        settings.tiles = static_cast<uint32_t>(batch.tiles.size());
        settings.stop = training::kTrainingStop;
        settings.adam.step = 1;
        settings.weights.smoothness = training::kDefaultLossWeights.smoothness;
        training::load_batch(dataset, batch, step.rays(), step.batch());
        step.submit(settings);
        return step.wait();
    }

    // The median time of some work on the host that can be repeated.
    double host_ms(const std::function<void()>& work) const {
        std::vector<double> ms;
        for (uint32_t i = 0; i < options.repeats; ++i) {
            const double start = seconds_now();
            work();
            ms.push_back(1000 * (seconds_now() - start));
        }
        return median(ms);
    }

    // The device's time of a step whose slice is there already, as it is of most steps.
    double device_ms(training::TrainingStep& step, uint32_t members) const {
        std::vector<double> ms;
        for (uint32_t i = 0; i < options.repeats; ++i) {
            run(step, 0, members);
            ms.push_back(milliseconds(step.pass_times()));
        }
        return median(ms);
    }

    // Of so many collective calls, each of which takes as many rounds of messages as halves leave one member.
    double network_ms(double bytes, uint32_t calls, uint32_t members) const {
        const uint32_t rounds = calls * static_cast<uint32_t>(std::bit_width(members - 1));
        return 1000 * (bytes / (1e9 * options.gigabytes_per_s) + 1e-6 * options.latency_us * rounds);
    }

    TeamStep alone() const;
    TeamStep together(uint32_t members) const;
    void cost_of_shares(StandIn& stand_in, const std::vector<Bytes>& records, TeamStep& result) const;
    void cost_of_everything(const std::vector<Bytes>& records, TeamStep& result) const;
};

TeamStep Bench::alone() const {
    training::TrainingStep step(device, tree, static_cast<uint32_t>(dataset.cameras.size()), options.tiles);
    const training::StepResult result = run(step, 0, 1);
    TeamStep alone{.rays = static_cast<double>(result.pixels)};
    alone.touched = alone.touched_by_all = result.touched;
    alone.shared.device = alone.everything.device = device_ms(step, 1);
    return alone;
}

// The records that each member took from its device.
std::vector<Bytes> whole_records(const std::vector<std::vector<Bytes>>& sent) {
    std::vector<Bytes> records;
    for (const std::vector<Bytes>& to : sent) {
        Bytes& all = records.emplace_back();
        for (const Bytes& part : to) all.insert(all.end(), part.begin(), part.end());
    }
    return records;
}

TeamStep Bench::together(uint32_t members) const {
    StandIn stand_in(members);
    const uint32_t tiles = options.tiles + 1;  // shares of a batch differ by a tile
    training::TrainingStep step(device, tree, static_cast<uint32_t>(dataset.cameras.size()), tiles, stand_in.team());
    TeamStep result{.members = members};
    for (uint32_t member = 0; member < members; ++member) {
        expect_not_stopped();
        result.rays += static_cast<double>(run(step, member, members).pixels) / members;  // results are sums of members
    }
    const std::vector<Bytes> records = whole_records(stand_in.sent);
    for (const Bytes& own : records) result.touched += static_cast<double>(own.size() / (4 * words)) / members;
    cost_of_shares(stand_in, records, result);
    cost_of_everything(records, result);
    stand_in.sent.clear();
    result.shared.device = result.everything.device = device_ms(step, members);
    return result;
}

// Each member divides its records, adds up those of its share of the leaves, and takes the sums of all. Leaves the sums
// in `stand_in`.
void Bench::cost_of_shares(StandIn& stand_in, const std::vector<Bytes>& records, TeamStep& result) const {
    const uint32_t members = result.members;
    const std::span<const uint32_t> own(reinterpret_cast<const uint32_t*>(records[0].data()), records[0].size() / 4);
    std::vector<Bytes> divided;
    result.shared.host += host_ms([&] { divided = training::divide_records(own, words, members); });
    training::RecordSum adder(tree.leaf_count, words);
    stand_in.sums.resize(members);
    double bytes = 0;
    for (uint32_t receiver = 0; receiver < members; ++receiver) {
        std::vector<Bytes> received;
        for (const std::vector<Bytes>& to : stand_in.sent) received.push_back(to[receiver]);
        std::span<const uint32_t> sums;
        result.shared.host += host_ms([&] { sums = adder.add_up(received); }) / members;
        const auto* first = reinterpret_cast<const uint8_t*>(sums.data());
        stand_in.sums[receiver].assign(first, first + sums.size_bytes());
        bytes += static_cast<double>(sums.size_bytes());
    }
    result.touched_by_all = bytes / (4 * words);
    const gpu::Buffer summed(device, "summed", static_cast<uint64_t>(bytes) + 4, gpu::MemoryKind::kUpload);
    const std::span<uint32_t> room(summed.as<uint32_t>(), static_cast<size_t>(bytes) / 4);
    result.shared.host += host_ms([&] { training::take_sums(stand_in.sums, tree.leaf_count, words, room); });
    const double of_others = (members - 1.0) / members * (bytes + 4 * words * result.touched);
    result.megabytes = 1e-6 * of_others;
    result.shared.network = network_ms(of_others, kCallsAStep, members);
}

// Each member gets the records of all others and adds up everything.
void Bench::cost_of_everything(const std::vector<Bytes>& records, TeamStep& result) const {
    training::RecordSum adder(tree.leaf_count, words);
    result.everything.host = host_ms([&] { adder.add_up(records); });
    result.everything.network =
        network_ms(4 * words * result.touched * (result.members - 1), kCallsAStep - 2, result.members);
}

// How many times as many rays a second as one process has.
double times_one(const TeamStep& step, const Cost& cost, const TeamStep& one) {
    return step.rays / cost.sum() / (one.rays / one.shared.sum());
}

nlohmann::ordered_json json_of(const std::vector<TeamStep>& steps) {
    auto rows = nlohmann::ordered_json::array();
    for (const TeamStep& step : steps)
        rows.push_back({{"members", step.members},
                        {"rays", step.rays},
                        {"touched", step.touched},
                        {"touched_by_all", step.touched_by_all},
                        {"received_mb", step.megabytes},
                        {"device_ms", step.shared.device},
                        {"host_ms", step.shared.host},
                        {"network_ms", step.shared.network},
                        {"times_one", times_one(step, step.shared, steps[0])},
                        {"everything_host_ms", step.everything.host},
                        {"everything_network_ms", step.everything.network},
                        {"everything_times_one", times_one(step, step.everything, steps[0])}});
    return {{"steps", rows}};
}

void print(const std::vector<TeamStep>& steps, const gpu::Device& device, const TeamOptions& options) {
    fmt::print("{}: a step of a team, each member on a device like this one; {} GB/s and {} us between them\n",
               device.summary().name, options.gigabytes_per_s, options.latency_us);
    fmt::print("{:>7} {:>9} {:>18} {:>11} {:>9} {:>7} {:>10} {:>9} {:>24}\n", "members", "rays", "leaves of one, all",
               "MB received", "device ms", "host ms", "network ms", "times one", "if each adds up all");
    for (const TeamStep& step : steps)
        fmt::print("{:>7} {:>9.0f} {:>18} {:>11.1f} {:>9} {:>7} {:>10} {:>9.1f} {:>24}\n", step.members, step.rays,
                   fmt::format("{:.0f}, {:.0f}", step.touched, step.touched_by_all), step.megabytes,
                   ms_text(step.shared.device), ms_text(step.shared.host), ms_text(step.shared.network),
                   times_one(step, step.shared, steps[0]),
                   fmt::format("{} + {} ms, {:.1f}", ms_text(step.everything.host), ms_text(step.everything.network),
                               times_one(step, step.everything, steps[0])));
}

void run_team(const TeamOptions& options, const tools::CommonOptions& common) {
    catch_stop_signals();
    const voctree::VOctree tree = voctree::read_clip(options.scene);
    const training::Dataset dataset =
        training::load_dataset(options.dataset, training::Split::kTrain, {.format = options.format});
    const gpu::Device device(common.device);
    const Bench bench{device, tree, dataset, options};
    tools::Progress progress("bench", options.members.size() + 1);
    std::vector<TeamStep> steps{bench.alone()};
    for (const uint32_t members : options.members) {
        progress.update(steps.size());
        steps.push_back(bench.together(members));
    }
    progress.update(steps.size());
    report(options, device, json_of(steps), [&] { print(steps, device, options); });
}

}  // namespace

void add_team(tools::Command app, const tools::CommonOptions& common) {
    auto [verb, options] =
        add_verb(app, common,
                 {"team",
                  "A training step of several processes on one tree",
                  "Predicts a step of a team (`mpirun -n N neuvv train` without --segment). The parts of each member "
                  "are computed on this\n"
                  "device, one after the other, with the rays of a real batch: passes of the device, and the sums of "
                  "gradients on the\n"
                  "host. The network is a bandwidth and a latency that you give; copies that MPI makes are left out. "
                  "Beside it stands\n"
                  "what it would take if each member added up the gradients of all. Weights stay as they are. ",
                  {"work/performer.nvv work/performer --members 2,8,64"}},
                 run_team);
    verb.add_option("dataset", options.dataset, "The data set's folder").required();
    tools::add_format_option(verb, options.format);
    verb.add_option("--members", options.members, "Processes, several numbers after commas")
        .delimiter(',')
        .in_range(2u, 1024u)
        .show_default();
    verb.add_option("--tiles", options.tiles, "Tiles of 8x8 rays a step of each").in_range(1, 65536).show_default();
    verb.add_option("--gb-s", options.gigabytes_per_s, "Bytes that a member receives, in GB/s")
        .number_between(0.001, 10000)
        .show_default();
    verb.add_option("--latency-us", options.latency_us, "Of a message between two members, in microseconds")
        .number_between(0, 1e6)
        .show_default();
    add_repeats_option(verb, options, "What the medians are over");
    add_json_flag(verb, options);
}

}  // namespace neuvv::bench
