#include "training/mattes/agreement.h"

#include <algorithm>
#include <functional>

namespace neuvv::training {

namespace {

constexpr uint32_t kEdge = 3;  // small pixels by which a hull may be off without a word

}  // namespace

void AgreementSums::add(uint32_t camera, const PixelMask& figure, const PixelMask& hull) {
    Counts& counts = counts_[camera];
    const PixelMask near = grown(hull, kEdge), inside = grown(figure, kEdge);
    for (size_t i = 0; i < figure.size(); ++i) {
        counts.hull += hull[i];
        counts.figure += figure[i];
        counts.lacking += hull[i] && !inside[i];
        counts.beyond += figure[i] && !near[i];
    }
}

std::vector<CameraAgreement> AgreementSums::of(const std::vector<CameraShots>& cameras) const {
    std::vector<CameraAgreement> agreements;
    for (size_t c = 0; c < cameras.size(); ++c)
        agreements.push_back({.camera = cameras[c].name(),
                              .lacking = counts_[c].lacking / std::max(1.0, counts_[c].hull),
                              .beyond = counts_[c].beyond / std::max(1.0, counts_[c].figure)});
    std::ranges::stable_sort(agreements, std::greater(), [](const CameraAgreement& a) { return a.lacking + a.beyond; });
    return agreements;
}

}  // namespace neuvv::training
