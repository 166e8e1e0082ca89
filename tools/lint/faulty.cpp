// Five faults, in a header, a template and an unnamed namespace, that tools/check tidy must find before it is believed
// that other files have none. Nothing compiles this file.
#include "faulty.h"

namespace {

template <typename Text>
auto use_after_move_in_a_template(Text text) {
    const Text taken = std::move(text);
    return taken.size() + text.size();
}

struct Shape {
    virtual ~Shape() = default;
    virtual int corners() const { return 0; }
};
struct Triangle : Shape {
    virtual int corners() const { return 3; }  // without override
};

struct Area {
    double twice_ = doubled();  // reads area_ before it is made
    double area_ = 1;
    double doubled() const { return 2 * area_; }
};

double sides(double corners) {  // which of the two a call takes, its argument says
    return corners;
}

}  // namespace

std::string::size_type use_all(const std::string& text) {
    return use_after_move_in_a_header(text) + use_after_move_in_a_template(text) +
           static_cast<std::string::size_type>(sides(Triangle().corners()) + sides(Area().twice_));
}
