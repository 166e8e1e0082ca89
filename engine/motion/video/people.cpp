#include "motion/video/people.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "motion/skeleton/median.h"
#include "motion/skeleton/skeleton.h"
#include "motion/video/triangulate.h"

namespace neuvv::motion {

namespace {

constexpr size_t kMostPeople = 8;        // of an image
constexpr size_t kLeastJoints = 5;       // that a body needs to be told from another
constexpr double kPairTolerance = 0.05;  // of the body's height: two views agree on a joint
constexpr double kPairShare = 0.6;       // of the joints that two views share, on which they agree
constexpr double kPersonTolerance =
    0.12;                            // of the height: the median error of a person of a view, calibration included
constexpr double kSpeed = 1;         // heights a second: how far a body that no two views show may have moved
constexpr double kForgotten_s = 2;   // after which such a body is another person
constexpr double kLeastShare = 0.1;  // of the frames of the person with the most

constexpr size_t kNobody = SIZE_MAX;

class PeopleFinder {
  public:
    explicit PeopleFinder(const Detections& seen)
        : seen_(seen), views_(seen.cameras.size()), height_(guessed_height(seen.cameras, seen.points)) {}

    std::vector<Person> run() {
        for (size_t f = 0; f < seen_.frames; ++f) {
            begin_frame(f);
            follow(f);
            begin_new(f);
        }
        return found();
    }

  private:
    using Chosen = std::vector<size_t>;  // by view, whom of its people; kNobody: none of them

    struct Track {
        Pose pose;  // the last one
        size_t last_frame = 0;
        std::vector<std::pair<size_t, Chosen>> frames;
        Chosen now;
    };

    // A person of an image who may be that of a track.
    struct Match {
        double error = 0;  // in tolerances
        size_t track = 0, view = 0, person = 0;
        auto operator<=>(const Match&) const = default;
    };

    // A new person: how many views agree, and how well.
    struct Seed {
        size_t views = 0;
        double error = INFINITY;
        Chosen chosen;
        Pose pose;
        bool better_than(const Seed& other) const {
            return views != other.views ? views > other.views : error < other.error;
        }
    };

    const std::vector<KeyPoints>& people_in(size_t frame, size_t view) const {
        return seen_.people[frame * views_ + view];
    }

    void begin_frame(size_t frame) {
        free_.assign(views_, {});
        for (size_t v = 0; v < views_; ++v) free_[v].assign(std::min(people_in(frame, v).size(), kMostPeople), true);
    }

    // How far a person of a view is from a pose: the median of the joints' distances, metres.
    double error_of(const KeyPoints& points, size_t view, const Pose& pose) const {
        const stage::Camera& camera = seen_.cameras[view];
        std::vector<double> errors;
        for (size_t j = 0; j < kJoints; ++j) {
            if (!(points[j].confidence > 0)) continue;
            double least = INFINITY;
            for (const JointSample* sample : {&pose[j], &at(pose, info_of(joint_at(j)).mirrored)}) {
                if (!(sample->confidence > 0)) continue;
                if (const auto shown = project(camera, sample->position))
                    least = std::min(
                        least, glm::distance(*shown, points[j].pixel) * metres_per_pixel(camera, sample->position));
            }
            if (least < INFINITY) errors.push_back(least);
        }
        return errors.size() < kLeastJoints ? INFINITY : median(errors);
    }

    // Triangulates the joints on which the chosen people agree; the others stay as they are. Returns how many agree.
    size_t triangulate_pose(size_t frame, const Chosen& chosen, Pose& pose) const {
        size_t agree = 0;
        std::vector<KeyPoint> points(views_);
        for (size_t j = 0; j < kJoints; ++j) {
            for (size_t v = 0; v < views_; ++v)
                points[v] = chosen[v] == kNobody ? KeyPoint() : people_in(frame, v)[chosen[v]][j];
            if (const auto joint = triangulate(seen_.cameras, points, kPairTolerance * height_)) {
                pose[j] = {joint->position, joint->confidence, true};
                ++agree;
            }
        }
        return agree;
    }

    static size_t count_of(const Chosen& chosen) {
        return static_cast<size_t>(std::ranges::count_if(chosen, [](size_t person) { return person != kNobody; }));
    }

    double tolerance_of(const Track& track, size_t frame) const {
        const double age_s = static_cast<double>(frame - track.last_frame - 1) / seen_.fps;
        return (kPersonTolerance + kSpeed * age_s) * height_;
    }

    // Finds the people of the frames before, those that fit best first.
    void follow(size_t frame) {
        std::vector<Match> matches;
        for (size_t t = 0; t < tracks_.size(); ++t) {
            Track& track = tracks_[t];
            track.now.assign(views_, kNobody);
            if (static_cast<double>(frame - track.last_frame) > kForgotten_s * seen_.fps + 1) continue;
            for (size_t v = 0; v < views_; ++v)
                for (size_t p = 0; p < free_[v].size(); ++p)
                    if (const double error = error_of(people_in(frame, v)[p], v, track.pose);
                        error < tolerance_of(track, frame))
                        matches.push_back({error / (kPersonTolerance * height_), t, v, p});
        }
        std::ranges::sort(matches);
        for (const Match& match : matches) {
            if (!free_[match.view][match.person] || tracks_[match.track].now[match.view] != kNobody) continue;
            tracks_[match.track].now[match.view] = match.person;
            free_[match.view][match.person] = false;
        }
        for (Track& track : tracks_) advance(frame, track);
    }

    // Moves a person on to this frame, with the views that agree. The people of others are free again.
    void advance(size_t frame, Track& track) {
        Pose pose = track.pose;
        const bool agree = count_of(track.now) >= 2 && triangulate_pose(frame, track.now, pose) >= kLeastJoints;
        for (size_t v = 0; v < views_; ++v) {
            if (track.now[v] == kNobody) continue;
            const bool fits =
                agree && error_of(people_in(frame, v)[track.now[v]], v, pose) < kPersonTolerance * height_;
            if (fits) continue;
            free_[v][track.now[v]] = true;
            track.now[v] = kNobody;
        }
        if (count_of(track.now) < 2) return;
        track.pose = pose;
        track.last_frame = frame;
        track.frames.emplace_back(frame, track.now);
    }

    // Makes new people of those that are left: the best seeds first, each without whom another one has taken.
    void begin_new(size_t frame) {
        std::vector<Seed> seeds;
        for (size_t v = 0; v < views_; ++v)
            for (size_t w = v + 1; w < views_; ++w)
                for (size_t p = 0; p < free_[v].size(); ++p)
                    for (size_t q = 0; q < free_[w].size(); ++q)
                        if (Seed seed = seed_of(frame, {v, p}, {w, q}); seed.views >= 2)
                            seeds.push_back(std::move(seed));
        std::ranges::stable_sort(seeds, [](const Seed& a, const Seed& b) { return a.better_than(b); });
        for (Seed& seed : seeds) {
            for (size_t v = 0; v < views_; ++v)
                if (seed.chosen[v] != kNobody && !free_[v][seed.chosen[v]]) seed.chosen[v] = kNobody;
            seed.pose = {};
            if (count_of(seed.chosen) < 2 || triangulate_pose(frame, seed.chosen, seed.pose) < kLeastJoints) continue;
            for (size_t v = 0; v < views_; ++v)
                if (seed.chosen[v] != kNobody) free_[v][seed.chosen[v]] = false;
            tracks_.push_back({seed.pose, frame, {{frame, seed.chosen}}, {}});
        }
    }

    using InView = std::pair<size_t, size_t>;  // the view, and whom of its people

    // The person of two views, with those of the others who fit; views = 0: there is none.
    Seed seed_of(size_t frame, InView one, InView other) const {
        Seed seed;
        if (!free_[one.first][one.second] || !free_[other.first][other.second]) return seed;
        seed.chosen.assign(views_, kNobody);
        seed.chosen[one.first] = one.second;
        seed.chosen[other.first] = other.second;
        const KeyPoints& a = people_in(frame, one.first)[one.second];
        const KeyPoints& b = people_in(frame, other.first)[other.second];
        size_t shared = 0;
        for (size_t j = 0; j < kJoints; ++j) shared += a[j].confidence > 0 && b[j].confidence > 0;
        const size_t agree = triangulate_pose(frame, seed.chosen, seed.pose);
        if (agree < kLeastJoints || static_cast<double>(agree) < kPairShare * static_cast<double>(shared)) return seed;
        double sum = error_of(a, one.first, seed.pose) + error_of(b, other.first, seed.pose);
        for (size_t v = 0; v < views_; ++v) {
            double least = kPersonTolerance * height_;
            for (size_t p = 0; p < free_[v].size() && v != one.first && v != other.first; ++p) {
                if (!free_[v][p]) continue;
                const double error = error_of(people_in(frame, v)[p], v, seed.pose);
                if (error < least) least = error, seed.chosen[v] = p;
            }
            if (v != one.first && v != other.first && seed.chosen[v] != kNobody) sum += least;
        }
        seed.views = count_of(seed.chosen);
        seed.error = sum / static_cast<double>(seed.views);
        return seed;
    }

    Person person_of(const Track& track) const {
        Person person;
        person.points.resize(seen_.frames * views_);
        person.frames = track.frames.size();
        person.views = views_of(track);
        std::array<std::vector<double>, 3> places;
        for (const auto& [frame, chosen] : track.frames) {
            for (size_t v = 0; v < views_; ++v)
                if (chosen[v] != kNobody) person.points[frame * views_ + v] = people_in(frame, v)[chosen[v]];
            Pose pose;
            triangulate_pose(frame, chosen, pose);
            for (const JointSample& sample : pose)
                for (int axis = 0; axis < 3 && sample.confidence > 0; ++axis)
                    places[static_cast<size_t>(axis)].push_back(sample.position[axis]);
        }
        person.place = {median(places[0]), median(places[1]), median(places[2])};
        return person;
    }

    static size_t views_of(const Track& track) {
        size_t views = 0;
        for (const auto& [frame, chosen] : track.frames) views += count_of(chosen);
        return views;
    }

    // Those who were seen long enough, the best seen first.
    std::vector<Person> found() {
        std::ranges::stable_sort(tracks_, std::greater(), views_of);
        std::vector<Person> people;
        for (const Track& track : tracks_)
            if (static_cast<double>(track.frames.size()) >= kLeastShare * static_cast<double>(tracks_[0].frames.size()))
                people.push_back(person_of(track));
        return people;
    }

    const Detections& seen_;
    size_t views_;
    double height_;
    std::vector<Track> tracks_;
    std::vector<std::vector<bool>> free_;  // by view and person of the frame: whether it is nobody's yet
};

}  // namespace

std::vector<Person> find_people(const Detections& detections) {
    const bool alone = std::ranges::all_of(detections.people, [](const auto& people) { return people.size() < 2; });
    if (alone) return {{detections.points, detections.frames, detections.points.size(), {}}};
    return PeopleFinder(detections).run();
}

}  // namespace neuvv::motion
