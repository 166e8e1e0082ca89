// Who is who where images show several people: views of one person agree on where the joints are, and a person moves on
// from frame to frame.
#pragma once

#include <vector>

#include "motion/video/key_points.h"

namespace neuvv::motion {

struct Person {
    std::vector<KeyPoints> points;  // frames × cameras, as Detections::points; confidence 0 where a view has none
    size_t frames = 0;              // in which at least two views show the person
    size_t views = 0;               // of all those frames together
    glm::dvec3 place{0};            // the median place of the body's centre, metres
};

// The people whom at least two views show in a tenth of the frames that the first one has, whom most views show in most
// frames; empty where no two views agree on anybody. A person of an image belongs to the person whose last pose it fits
// best, by the median distance of its key points in metres; left and right may be exchanged. Those that are left in a
// frame become new people by the pair of views that agree and that most others agree with. Where no image has several
// people they are all of one. At most 8 people of an image count, the most confident ones.
std::vector<Person> find_people(const Detections& detections);

}  // namespace neuvv::motion
