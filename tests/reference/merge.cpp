#include "reference/merge.h"

#include <algorithm>
#include <cmath>

namespace neuvv::reference {

std::vector<Sample> merge(const std::vector<std::vector<Sample>>& instances) {
    std::vector<double> borders;
    for (const std::vector<Sample>& samples : instances)
        for (const Sample& sample : samples)
            if (sample.sigma > 0)
                for (const double side : {-0.5, 0.5}) borders.push_back(sample.z_m + side * sample.delta_m);
    std::sort(borders.begin(), borders.end());
    std::vector<Sample> merged;
    for (size_t i = 0; i + 1 < borders.size(); ++i) {
        const double centre = 0.5 * (borders[i] + borders[i + 1]);
        Sample sum{0, glm::dvec3(0), borders[i + 1] - borders[i], centre};
        for (const std::vector<Sample>& samples : instances)
            for (const Sample& sample : samples)
                if (std::abs(centre - sample.z_m) < 0.5 * sample.delta_m) {
                    sum.sigma += sample.sigma;
                    sum.colour += sample.sigma * sample.colour;
                }
        if (sum.sigma <= 0) continue;
        sum.colour /= sum.sigma;
        merged.push_back(sum);
    }
    return merged;
}

std::vector<Sample> in_world(const std::vector<Sample>& samples, double world_metres, double opacity, double density) {
    std::vector<Sample> result;
    double solid = 1;  // the transmittance at opacity 1
    for (const Sample& sample : samples) {
        const double before = 1 - opacity * (1 - solid);
        solid *= std::exp(-density * sample.sigma * sample.delta_m);
        const double after = 1 - opacity * (1 - solid), delta = world_metres * sample.delta_m;
        result.push_back({std::log(before / after) / delta, sample.colour, delta, world_metres * sample.z_m});
    }
    return result;
}

}  // namespace neuvv::reference
