#include "training/run/claim.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/platform.h"
#include "training/run/checkpoint.h"

namespace neuvv::training {

namespace {

constexpr uint64_t kMaxClaimBytes = 4096;
constexpr size_t kMaxHostLength = 255;

std::filesystem::path claim_file(const std::filesystem::path& nvv) {
    return nvv.string() + ".lock";
}

// What people should read of a host's name, which may be anybody's bytes.
std::string printable(const std::string& name) {
    std::string text = name.substr(0, kMaxHostLength);
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c < 0x21 || c > 0x7e; }, '?');
    return text;
}

}  // namespace

std::optional<RunClaim> RunClaim::take(const std::filesystem::path& nvv) {
    std::optional<FileLock> lock = FileLock::try_lock(claim_file(nvv));
    if (!lock) return std::nullopt;
    RunClaim claim(claim_file(nvv), std::move(*lock));
    claim.report(0);
    return claim;
}

RunClaim::RunClaim(std::filesystem::path file, FileLock lock) : file_(std::move(file)), lock_(std::move(lock)) {}

RunClaim::RunClaim(RunClaim&& other) noexcept : file_(std::exchange(other.file_, {})), lock_(std::move(other.lock_)) {}

RunClaim& RunClaim::operator=(RunClaim&& other) noexcept {
    std::swap(file_, other.file_);
    std::swap(lock_, other.lock_);
    return *this;
}

// The file is removed while it is locked, so that nobody's lock on a file that is gone counts (FileLock).
RunClaim::~RunClaim() {
    std::error_code ignored;
    if (!file_.empty()) std::filesystem::remove(file_, ignored);
}

void RunClaim::report(double fraction) const {
    const nlohmann::json state = {{"host", printable(host_name())}, {"process", process_id()}, {"fraction", fraction}};
    lock_.write(state.dump() + "\n");  // whoever reads it while it is written, or on a full disk, does without
}

std::optional<ClaimState> claim_of(const std::filesystem::path& nvv) {
    const std::filesystem::path file = claim_file(nvv);
    if (!is_file_locked(file)) return std::nullopt;
    ClaimState state{"another process", 0};
    try {
        const std::vector<uint8_t> bytes = read_file(file, kMaxClaimBytes);
        const nlohmann::json read = nlohmann::json::parse(bytes.begin(), bytes.end());
        state.fraction = std::clamp(read.at("fraction").get<double>(), 0.0, 1.0);
        state.owner = fmt::format("process {} of {}", read.at("process").get<int64_t>(),
                                  printable(read.at("host").get<std::string>()));
    } catch (const std::exception&) {
        return state;  // it is being written
    }
    return state;
}

std::string unfinished_training(const std::filesystem::path& segment) {
    if (const auto claim = claim_of(segment))
        return fmt::format("{} trains it, {:.0f} % done", claim->owner, 100 * claim->fraction);
    std::error_code ignored;
    return std::filesystem::exists(state_path(segment), ignored) ? "its training was interrupted" : "";
}

}  // namespace neuvv::training
