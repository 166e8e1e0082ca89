#include "training/tree/misfits.h"

#include <algorithm>
#include <optional>

#include "base/trace_file.h"
#include "training/tree/camera_evidence.h"

namespace neuvv::training {

namespace {

// A camera agrees with the others below both of these.
constexpr double kAgreedUnexplained = 0.01, kAgreedDenied = 0.002;
// A camera is a misfit above one of these, if all others are below those of the next line. Poses that are off by 2°, as
// far as a search corrects them (rig_search.h), give up to a fifth.
constexpr double kMisfitUnexplained = 0.25, kMisfitDenied = 0.1;
constexpr double kSettledUnexplained = 0.03, kSettledDenied = 0.01;
constexpr size_t kMinMisfitTimes = 2;  // of one time, a camera's matte may be wrong: doubtful_mattes.h repairs more
// Two cameras are swapped if this divides what is unexplained in all images, at least.
constexpr double kSwapGain = 4;
// Of so many cameras, all pairs are left out, or swapped, for a try.
constexpr size_t kMostTriedPairs = 12, kMostSwappedPairs = 64;

bool agrees(const CameraFit& fit) {
    return fit.unexplained < kAgreedUnexplained && fit.denied < kAgreedDenied;
}

bool is_settled(const CameraFit& fit) {
    return fit.unexplained < kSettledUnexplained && fit.denied < kSettledDenied;
}

double lower_median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);  // of two, the lower
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// All mattes, and what they say of the cameras.
class CameraJudge {
  public:
    // `mattes` are small; `cameras`, which must outlive it, have the sizes of the images.
    CameraJudge(Dataset mattes, const std::vector<stage::Camera>& cameras, size_t most_wrong)
        : dataset_(std::move(mattes)), cameras_(cameras), most_wrong_(most_wrong) {
        const auto box = judged_box(dataset_);
        for (const double time : dataset_.times) times_.emplace_back(dataset_, time, box, most_wrong);
    }
    CameraJudge(const CameraJudge&) = delete;
    CameraJudge& operator=(const CameraJudge&) = delete;

    // By camera; those that are not trusted agree with everything.
    std::vector<CameraFit> judge(const std::vector<bool>& trusted, bool blame = true) const;
    // Of a camera that joins the trusted ones.
    CameraFit judge_joining(uint32_t camera, std::vector<bool> trusted) const;
    // The cameras that are left when those that contradict the others most have been taken away.
    std::vector<bool> find_agreeing() const;
    // A pair of cameras, of which one at least does not agree with the others, and both do once they are swapped.
    std::optional<SwappedCameras> find_swapped(const std::vector<bool>& agreeing) const;
    Dataset with_swapped(uint32_t a, uint32_t b) const;

  private:
    std::vector<bool> without_best_pair() const;
    bool may_be_swapped(uint32_t a, uint32_t b, std::vector<bool> agreeing) const;
    std::optional<SwappedCameras> judge_swap(uint32_t a, uint32_t b, std::vector<bool> agreeing) const;
    double unexplained_sum(const std::vector<bool>& trusted) const;
    double median_unexplained_at(uint32_t from, uint32_t at, const std::vector<bool>& trusted) const;

    Dataset dataset_;
    const std::vector<stage::Camera>& cameras_;
    size_t most_wrong_;
    std::vector<CameraEvidence> times_;
};

std::vector<CameraFit> CameraJudge::judge(const std::vector<bool>& trusted, bool blame) const {
    std::vector<std::vector<double>> unexplained(trusted.size()), denied(trusted.size());
    for (const CameraEvidence& time : times_) {
        const std::vector<std::optional<CameraFit>> fits = time.judge(trusted, blame);
        for (size_t c = 0; c < fits.size(); ++c) {
            if (!fits[c]) continue;
            unexplained[c].push_back(fits[c]->unexplained);
            denied[c].push_back(fits[c]->denied);
        }
    }
    std::vector<CameraFit> fits;
    for (size_t c = 0; c < trusted.size(); ++c) fits.push_back({lower_median(unexplained[c]), lower_median(denied[c])});
    return fits;
}

CameraFit CameraJudge::judge_joining(uint32_t camera, std::vector<bool> trusted) const {
    trusted[camera] = true;
    return judge(trusted)[camera];
}

std::vector<bool> CameraJudge::find_agreeing() const {
    std::vector<bool> trusted(dataset_.cameras.size(), true);
    for (size_t removed = 0; removed < most_wrong_; ++removed) {
        const std::vector<CameraFit> fits = judge(trusted);
        if (std::ranges::all_of(fits, agrees)) break;
        // What one camera denies is unexplained in all others.
        const auto others = static_cast<double>(trusted.size() - removed - 1);
        const auto worst = std::ranges::max_element(
            fits, {}, [&](const CameraFit& fit) { return fit.unexplained + others * fit.denied; });
        trusted[static_cast<size_t>(worst - fits.begin())] = false;
    }
    if (!std::ranges::all_of(judge(trusted), is_settled))
        return trusted.size() <= kMostTriedPairs && most_wrong_ >= 2 ? without_best_pair() : trusted;
    // What was wrong may have made right ones look worse.
    for (size_t c = 0; c < trusted.size(); ++c) {
        if (trusted[c]) continue;
        trusted[c] = true;
        trusted[c] = std::ranges::all_of(judge(trusted), agrees);
    }
    return trusted;
}

// Without the two cameras without which the others agree best.
std::vector<bool> CameraJudge::without_best_pair() const {
    std::vector<bool> best;
    double least = 0;
    for (size_t a = 0; a < dataset_.cameras.size(); ++a)
        for (size_t b = a + 1; b < dataset_.cameras.size(); ++b) {
            std::vector<bool> trusted(dataset_.cameras.size(), true);
            trusted[a] = trusted[b] = false;
            const double share = unexplained_sum(trusted);
            if (!best.empty() && share >= least) continue;
            least = share;
            best = std::move(trusted);
        }
    return best;
}

Dataset CameraJudge::with_swapped(uint32_t a, uint32_t b) const {
    Dataset swapped = dataset_;
    for (View& view : swapped.views)
        if (view.camera == a || view.camera == b) view.camera = a + b - view.camera;
    return swapped;
}

double CameraJudge::median_unexplained_at(uint32_t from, uint32_t at, const std::vector<bool>& trusted) const {
    std::vector<double> shares;
    for (const CameraEvidence& time : times_)
        if (const auto share = time.unexplained_at(from, at, trusted)) shares.push_back(*share);
    return shares.empty() ? 1 : lower_median(shares);
}

// The sum over all trusted cameras.
double CameraJudge::unexplained_sum(const std::vector<bool>& trusted) const {
    double sum = 0;
    for (const CameraFit& fit : judge(trusted, false)) sum += fit.unexplained;
    return sum;
}

// Cameras of other sizes cannot have each other's images, even where their small mattes are of one size.
bool CameraJudge::may_be_swapped(uint32_t a, uint32_t b, std::vector<bool> agreeing) const {
    if (cameras_[a].width != cameras_[b].width || cameras_[a].height != cameras_[b].height) return false;
    agreeing[a] = agreeing[b] = false;
    return median_unexplained_at(a, b, agreeing) < kSettledUnexplained &&
           median_unexplained_at(b, a, agreeing) < kSettledUnexplained;
}

// Nothing where two cameras do not agree with the others any better once they are swapped.
std::optional<SwappedCameras> CameraJudge::judge_swap(uint32_t a, uint32_t b, std::vector<bool> agreeing) const {
    constexpr double kNothing = 0.002;  // of one image's foreground
    agreeing[a] = agreeing[b] = false;
    const double others = unexplained_sum(agreeing);
    agreeing[a] = agreeing[b] = true;
    const CameraJudge swapped(with_swapped(a, b), cameras_, most_wrong_);
    const std::vector<CameraFit> fits = swapped.judge(agreeing);
    if (!is_settled(fits[a]) || !is_settled(fits[b])) return {};
    const double before = unexplained_sum(agreeing), after = swapped.unexplained_sum(agreeing);
    if (before - others + kNothing < kSwapGain * (std::max(after - others, 0.0) + kNothing)) return {};
    const auto count = static_cast<double>(std::ranges::count(agreeing, true));
    return SwappedCameras{std::min(a, b), std::max(a, b), before / count, after / count};
}

std::optional<SwappedCameras> CameraJudge::find_swapped(const std::vector<bool>& agreeing) const {
    const size_t cameras = agreeing.size();
    std::optional<SwappedCameras> best;
    const auto try_pair = [&](uint32_t a, uint32_t b, const std::vector<bool>& trusted) {
        if (!may_be_swapped(a, b, trusted)) return;
        const std::optional<SwappedCameras> pair = judge_swap(a, b, trusted);
        if (pair && (!best || pair->unexplained_swapped < best->unexplained_swapped)) best = pair;
    };
    if (std::ranges::count(agreeing, false) == 0) return best;
    for (uint32_t a = 0; a < cameras; ++a)
        for (uint32_t b = 0; b < cameras && !agreeing[a]; ++b)
            if (b != a && (agreeing[b] || b > a)) try_pair(a, b, agreeing);
    if (best) return best;
    // Where two cameras look at each other, what the swap spoils is little, and others may seem to be at fault.
    for (uint32_t a = 0; a < cameras && cameras <= kMostSwappedPairs; ++a)
        for (uint32_t b = a + 1; b < cameras; ++b) try_pair(a, b, std::vector<bool>(cameras, true));
    return best;
}

}  // namespace

size_t most_misfits(size_t cameras) {
    return cameras < kMinJudgedCameras ? 0 : std::min({cameras - 4, 2 * cameras / 5, size_t{12}});
}

Misfits find_misfits(const Dataset& look) {
    const TraceSpan span("find misfits");
    const size_t most = most_misfits(look.cameras.size());
    Misfits found;
    if (most == 0) return found;
    std::optional<CameraJudge> judge(std::in_place, small_mattes(look), look.cameras, most);
    std::vector<bool> agreeing;
    while (true) {
        agreeing = judge->find_agreeing();
        if (!std::ranges::all_of(judge->judge(agreeing), is_settled)) return found;
        if (2 * found.swapped.size() >= most) break;
        const std::optional<SwappedCameras> pair = judge->find_swapped(agreeing);
        if (!pair) break;
        found.swapped.push_back(*pair);
        Dataset swapped = judge->with_swapped(pair->a, pair->b);
        judge.emplace(std::move(swapped), look.cameras, most);
    }
    if (look.times.size() < kMinMisfitTimes) return found;
    for (uint32_t camera = 0; camera < agreeing.size(); ++camera) {
        if (agreeing[camera]) continue;
        const CameraFit fit = judge->judge_joining(camera, agreeing);
        if (fit.unexplained > kMisfitUnexplained || fit.denied > kMisfitDenied) found.others.push_back({camera, fit});
    }
    return found;
}

}  // namespace neuvv::training
