// What tools/check tidy must complain of, a fault in each function, so that a linter that looks at nothing is noticed.
// Nothing compiles it.
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

}  // namespace

std::string::size_type use_all(const std::string& text) {
    return use_after_move_in_a_header(text) + use_after_move_in_a_template(text) +
           static_cast<std::string::size_type>(Triangle().corners());
}
