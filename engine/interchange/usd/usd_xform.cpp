#include "interchange/usd/usd_xform.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtx/transform.hpp>

#include "base/error.h"

namespace neuvv::interchange {

namespace {

constexpr const char* kOpPrefix = "xformOp:";
constexpr const char* kInvert = "!invert!";
constexpr const char* kReset = "!resetXformStack!";

bool is_turn(const std::string& type) {
    return type.starts_with("quat");
}

// The turn about each of the axes, in the order of their letters: the first is done first.
glm::dmat4 turns_of(const std::string& axes, const std::vector<double>& degrees) {
    glm::dmat4 turn(1);
    for (size_t i = 0; i < axes.size(); ++i) {
        const int axis = axes[i] - 'X';
        glm::dvec3 about(0);
        about[axis] = 1;
        turn = glm::rotate(glm::radians(degrees[axes.size() == 1 ? 0 : static_cast<size_t>(axis)]), about) * turn;
    }
    return turn;
}

// The matrix of an op whose name is xformOp:KIND or xformOp:KIND:suffix.
glm::dmat4 op_matrix(const std::string& kind, const UsdValue& value, const UsdPrim& prim, const std::string& file) {
    const std::vector<double>& n = value.numbers;
    const auto need = [&](size_t count) {
        const bool finite = std::all_of(n.begin(), n.end(), [](double x) { return std::isfinite(x); });
        if (n.size() != count || !finite)
            throw InputError(file, prim.name + "." + kOpPrefix + kind, fmt::format("is not {} numbers", count));
    };
    const auto vector = [&] {
        need(3);
        return glm::dvec3(n[0], n[1], n[2]);
    };
    if (kind == "translate") return glm::translate(vector());
    if (kind == "scale") return glm::scale(vector());
    if (kind == "orient") {
        need(4);
        const glm::dquat turn(n[0], n[1], n[2], n[3]);
        if (!(glm::length(turn) > 1e-9)) throw InputError(file, prim.name, "has a quaternion of length 0");
        return glm::mat4_cast(glm::normalize(turn));
    }
    if (kind == "transform") {
        need(16);
        glm::dmat4 matrix;  // its rows, which are for row vectors, are our columns
        for (size_t i = 0; i < 16; ++i) matrix[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = n[i];
        return matrix;
    }
    if (kind.starts_with("rotate")) {
        const std::string axes = kind.substr(6);
        for (const char* order : {"XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX", "X", "Y", "Z"})
            if (axes == order) {
                need(axes.size());
                return turns_of(axes, n);
            }
    }
    throw InputError(file, prim.name, fmt::format("has the op {}{}, which OpenUSD does not know", kOpPrefix, kind));
}

glm::dmat4 op_at(const UsdPrim& prim, std::string op, double time_code, const std::string& file) {
    const bool inverted = op.starts_with(kInvert);
    if (inverted) op = op.substr(std::string(kInvert).size());
    const auto found = prim.attributes.find(op);
    if (!op.starts_with(kOpPrefix) || found == prim.attributes.end())
        throw InputError(file, prim.name, fmt::format("orders the op \"{:.60}\", which it does not have", op));
    std::string kind = op.substr(std::string(kOpPrefix).size());
    kind = kind.substr(0, kind.find(':'));
    const glm::dmat4 matrix = op_matrix(kind, usd_value_at(found->second, time_code), prim, file);
    if (!inverted) return matrix;
    if (!(std::abs(glm::determinant(matrix)) > 1e-12)) throw InputError(file, prim.name, "inverts a flat transform");
    return glm::inverse(matrix);
}

}  // namespace

UsdValue usd_value_at(const UsdAttribute& attribute, double time_code) {
    const auto& samples = attribute.samples;
    if (samples.empty()) return attribute.value;
    const auto after = std::upper_bound(samples.begin(), samples.end(), time_code,
                                        [](double time, const auto& sample) { return time < sample.first; });
    if (after == samples.begin()) return samples.front().second;
    const auto before = after - 1;
    if (after == samples.end() || before->second.numbers.size() != after->second.numbers.size()) return before->second;
    const double u = (time_code - before->first) / (after->first - before->first);
    UsdValue value = before->second;
    double cosine = 0;
    for (size_t i = 0; i < value.numbers.size(); ++i) cosine += value.numbers[i] * after->second.numbers[i];
    const double sign = is_turn(attribute.type) && cosine < 0 ? -1 : 1;  // of one turn, there are two quaternions
    for (size_t i = 0; i < value.numbers.size(); ++i)
        value.numbers[i] = (1 - u) * value.numbers[i] + u * sign * after->second.numbers[i];
    return value;
}

glm::dmat4 usd_local_transform(const UsdPrim& prim, double time_code, const std::string& file) {
    glm::dmat4 transform(1);
    const auto order = prim.attributes.find("xformOpOrder");
    if (order == prim.attributes.end()) return transform;
    for (const std::string& op : order->second.value.texts)
        if (op != kReset) transform *= op_at(prim, op, time_code, file);
    return transform;
}

bool usd_resets_stack(const UsdPrim& prim) {
    const auto order = prim.attributes.find("xformOpOrder");
    return order != prim.attributes.end() && !order->second.value.texts.empty() &&
           order->second.value.texts[0] == kReset;
}

glm::dmat4 usd_world_from_layer(const UsdLayer& layer, const std::string& file) {
    const double metres = layer.number("metersPerUnit", 0.01);
    if (!(metres >= 1e-6 && metres <= 1e6))
        throw InputError(file, "metersPerUnit", fmt::format("is {}, no scale", metres), "give metres in a unit");
    const glm::dmat4 scale = glm::scale(glm::dvec3(metres));
    const std::string up = layer.text("upAxis", "Y");
    if (up == "Y") return scale;
    if (up != "Z") throw InputError(file, "upAxis", fmt::format("is \"{:.20}\"", up), "give \"Y\" or \"Z\"");
    return glm::dmat4(glm::dvec4(1, 0, 0, 0), glm::dvec4(0, 0, -1, 0), glm::dvec4(0, 1, 0, 0), glm::dvec4(0, 0, 0, 1)) *
           scale;
}

}  // namespace neuvv::interchange
