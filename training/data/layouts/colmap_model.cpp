#include "training/data/layouts/colmap_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <set>

#include "base/error.h"
#include "base/platform.h"
#include "training/data/layouts/rig/calibration.h"
#include "training/data/layouts/rig/candidates.h"

namespace neuvv::training {

namespace {

constexpr uint64_t kMaxFileBytes = uint64_t{2} << 30;

// A camera model of https://colmap.github.io/cameras.html. Its parameters begin with f, cx, cy (one_focal) or fx, fy,
// cx, cy; `rest` names those after them: k1 … k6 by their digit, p1 and p2 as p and q, s1 and s2 as s and t.
struct LensKind {
    int id;
    const char* name;
    bool one_focal;
    interchange::LensModel model;
    const char* rest;

    size_t parameters() const { return (one_focal ? 3 : 4) + std::strlen(rest); }
};
constexpr LensKind kLensKinds[] = {
    {0, "SIMPLE_PINHOLE", true, interchange::LensModel::kPinhole, ""},
    {1, "PINHOLE", false, interchange::LensModel::kPinhole, ""},
    {2, "SIMPLE_RADIAL", true, interchange::LensModel::kBrown, "1"},
    {3, "RADIAL", true, interchange::LensModel::kBrown, "12"},
    {4, "OPENCV", false, interchange::LensModel::kBrown, "12pq"},
    {5, "OPENCV_FISHEYE", false, interchange::LensModel::kFisheye, "1234"},
    {6, "FULL_OPENCV", false, interchange::LensModel::kBrown, "12pq3456"},
    {7, "FOV", false, interchange::LensModel::kFov, "1"},
    {8, "SIMPLE_RADIAL_FISHEYE", true, interchange::LensModel::kFisheye, "1"},
    {9, "RADIAL_FISHEYE", true, interchange::LensModel::kFisheye, "12"},
    {10, "THIN_PRISM_FISHEYE", false, interchange::LensModel::kFisheye, "12pq34st"},
};

struct ModelCamera {
    uint64_t width = 0, height = 0;
    interchange::Lens lens;
};

struct ModelImage {
    std::array<double, 7> pose{};  // camera from world: w, x, y, z, then the translation
    int64_t camera = 0;
    std::string name, place;
};

// The contents of a model's files, of either kind.
struct RawModel {
    std::map<int64_t, ModelCamera> cameras;
    std::vector<ModelImage> images;
    std::vector<glm::dvec3> points;
};

interchange::Lens make_lens(const LensKind& kind, const std::vector<double>& parameters) {
    interchange::Lens lens;
    lens.model = kind.model;
    const double* at = parameters.data();
    lens.fx = *at++;
    lens.fy = kind.one_focal ? lens.fx : *at++;
    lens.cx = *at++;
    lens.cy = *at++;
    for (const char* slot = kind.rest; *slot; ++slot) switch (*slot) {
            case 'p':
                lens.p1 = *at++;
                break;
            case 'q':
                lens.p2 = *at++;
                break;
            case 's':
                lens.s1 = *at++;
                break;
            case 't':
                lens.s2 = *at++;
                break;
            default:
                lens.k[static_cast<size_t>(*slot - '1')] = *at++;
        }
    return lens;
}

template <typename Matches>
const LensKind& find_kind(Matches matches, const std::string& text, const std::string& file, const std::string& place) {
    for (const LensKind& kind : kLensKinds)
        if (matches(kind)) return kind;
    throw InputError(file, place, fmt::format("has the unknown camera model {:.40}", text),
                     "let `colmap image_undistorter` make a PINHOLE model of it");
}

// ---- Binary files: little-endian; a u64 count comes before each list.

struct BinaryFile {
    std::string file, place;
    std::vector<uint8_t> bytes;
    size_t at = 0;

    explicit BinaryFile(const std::filesystem::path& path)
        : file(path.string()), bytes(read_file(path, kMaxFileBytes)) {}

    void expect(uint64_t count) const {
        if (count > bytes.size() - at)
            throw InputError(file, place, fmt::format("ends after {} bytes, in the centre", bytes.size()),
                             "copy the sparse model again");
    }
    template <typename T>
    T take() {
        expect(sizeof(T));
        T value;
        std::memcpy(&value, &bytes[at], sizeof(T));
        at += sizeof(T);
        return value;
    }
    void skip(uint64_t count) {
        expect(count);
        at += count;
    }
    // The count of a list whose elements have at least this many bytes.
    uint64_t take_count(uint64_t min_bytes) {
        const auto count = take<uint64_t>();
        if (count > (bytes.size() - at) / min_bytes)
            throw InputError(file, place, fmt::format("says that {} elements follow, more than it can hold", count),
                             "copy the sparse model again");
        return count;
    }
    std::string take_name() {
        const auto begin = bytes.begin() + static_cast<ptrdiff_t>(at);
        const auto end = std::find(begin, bytes.end(), uint8_t{0});
        const std::string name(begin, end);
        skip(name.size() + 1);
        return name;
    }
};

void read_binary_cameras(const std::filesystem::path& path, RawModel& model) {
    BinaryFile in(path);
    const uint64_t count = in.take_count(24);
    for (uint64_t i = 0; i < count; ++i) {
        in.place = fmt::format("camera {} of {}", i + 1, count);
        const auto id = in.take<int32_t>();
        const auto model_id = in.take<int32_t>();
        ModelCamera camera;
        camera.width = in.take<uint64_t>();
        camera.height = in.take<uint64_t>();
        const LensKind& kind = find_kind([&](const LensKind& k) { return k.id == model_id; },
                                         fmt::format("{}", model_id), in.file, in.place);
        std::vector<double> parameters(kind.parameters());
        for (double& parameter : parameters) parameter = in.take<double>();
        camera.lens = make_lens(kind, parameters);
        if (!model.cameras.try_emplace(id, camera).second)
            throw InputError(in.file, in.place, fmt::format("has the id {} of another", id), "");
    }
}

void read_binary_images(const std::filesystem::path& path, RawModel& model) {
    BinaryFile in(path);
    const uint64_t count = in.take_count(73);
    for (uint64_t i = 0; i < count; ++i) {
        ModelImage image;
        image.place = in.place = fmt::format("image {} of {}", i + 1, count);
        in.take<int32_t>();  // the image's id
        for (double& number : image.pose) number = in.take<double>();
        image.camera = in.take<int32_t>();
        image.name = in.take_name();
        in.skip(in.take_count(24) * 24);  // where the image shows points
        model.images.push_back(std::move(image));
    }
}

void read_binary_points(const std::filesystem::path& path, RawModel& model) {
    BinaryFile in(path);
    const uint64_t count = in.take_count(51);
    for (uint64_t i = 0; i < count; ++i) {
        in.place = fmt::format("point {} of {}", i + 1, count);
        in.skip(8);  // the point's id
        glm::dvec3 point;
        for (int axis = 0; axis < 3; ++axis) point[axis] = in.take<double>();
        in.skip(3 + 8);                 // colour, error
        in.skip(in.take_count(8) * 8);  // the images that show it
        model.points.push_back(point);
    }
}

// ---- Text files: a camera or a point is a line, an image is two lines.

struct TextFile {
    std::string file, text, line;
    size_t at = 0, number = 0;
    std::string_view rest;  // what is not read yet of the line

    explicit TextFile(const std::filesystem::path& path) : file(path.string()) {
        const std::vector<uint8_t> bytes = read_file(path, kMaxFileBytes);
        text.assign(bytes.begin(), bytes.end());
    }
    std::string place() const { return fmt::format("line {}", number); }

    // False at the end of the file.
    bool next_line() {
        if (at >= text.size()) return false;
        const size_t end = std::min(text.find('\n', at), text.size());
        rest = std::string_view(text).substr(at, end - at);
        if (!rest.empty() && rest.back() == '\r') rest.remove_suffix(1);
        at = end + 1;
        ++number;
        return true;
    }
    // The next line that is neither empty nor a comment; false at the end of the file.
    bool next_record() {
        while (next_line()) {
            rest.remove_prefix(std::min(rest.find_first_not_of(" \t"), rest.size()));
            if (!rest.empty() && rest[0] != '#') return true;
        }
        return false;
    }
    std::string_view word(const char* what) {
        rest.remove_prefix(std::min(rest.find_first_not_of(" \t"), rest.size()));
        const std::string_view word = rest.substr(0, rest.find_first_of(" \t"));
        if (word.empty())
            throw InputError(file, place(), fmt::format("has no {}", what), "copy the sparse model again");
        rest.remove_prefix(word.size());
        return word;
    }
    template <typename T>
    T value(const char* what) {
        const std::string_view digits = word(what);
        T value{};
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (error != std::errc() || end != digits.data() + digits.size())
            throw InputError(file, place(), fmt::format("has the {} \"{:.40}\"", what, digits), "give a number");
        return value;
    }
};

void read_text_cameras(const std::filesystem::path& path, RawModel& model) {
    TextFile in(path);
    while (in.next_record()) {
        const auto id = in.value<int64_t>("camera id");
        const std::string name(in.word("camera model"));
        const LensKind& kind = find_kind([&](const LensKind& k) { return name == k.name; }, name, in.file, in.place());
        ModelCamera camera;
        camera.width = in.value<uint64_t>("width");
        camera.height = in.value<uint64_t>("height");
        std::vector<double> parameters(kind.parameters());
        for (double& parameter : parameters) parameter = in.value<double>("parameter");
        camera.lens = make_lens(kind, parameters);
        if (!model.cameras.try_emplace(id, camera).second)
            throw InputError(in.file, in.place(), fmt::format("has the id {} of another", id), "");
    }
}

void read_text_images(const std::filesystem::path& path, RawModel& model) {
    TextFile in(path);
    while (in.next_record()) {
        ModelImage image;
        image.place = in.place();
        in.value<int64_t>("image id");
        for (double& number : image.pose) number = in.value<double>("pose");
        image.camera = in.value<int64_t>("camera id");
        const std::string_view first = in.word("name");  // the rest of the line, as names may contain spaces
        const std::string_view name(first.data(), first.size() + in.rest.size());
        image.name = name.substr(0, name.find_last_not_of(" \t") + 1);
        model.images.push_back(std::move(image));
        in.next_line();  // where the image shows points; may be empty
    }
}

void read_text_points(const std::filesystem::path& path, RawModel& model) {
    TextFile in(path);
    while (in.next_record()) {
        in.value<uint64_t>("point id");
        glm::dvec3 point;
        for (int axis = 0; axis < 3; ++axis) point[axis] = in.value<double>("coordinate");
        model.points.push_back(point);
    }
}

// ---- For both kinds of files

RigCamera pose_camera(const ModelImage& image, const RawModel& model, const std::string& file) {
    RigCamera camera;
    camera.name = image.name;
    const auto found = model.cameras.find(image.camera);
    if (found == model.cameras.end())
        throw InputError(file, image.place, fmt::format("names the camera {}, which is not there", image.camera),
                         "copy cameras and images of one model");
    const auto& [width, height, lens] = found->second;
    camera.lens = lens;
    camera.lens.width = static_cast<uint32_t>(std::min<uint64_t>(width, UINT32_MAX));
    camera.lens.height = static_cast<uint32_t>(std::min<uint64_t>(height, UINT32_MAX));
    if (camera.lens.width == 0)
        throw InputError(file, image.place, fmt::format("has camera {} of width 0", image.camera), "");
    const auto& p = image.pose;
    const glm::dquat rotation(p[0], p[1], p[2], p[3]);
    const double length = glm::length(rotation);
    if (!(length > 1e-3 && length < 1e3))
        throw InputError(file, image.place, "has a quaternion that is no rotation", "give w x y z of length 1");
    camera.world_from_camera = world_from_opencv(glm::mat3_cast(rotation / length), {p[4], p[5], p[6]});
    expect_sound(camera, file, image.place);
    return camera;
}

std::filesystem::path model_file(const std::filesystem::path& folder, const char* stem) {
    std::error_code ignored;
    for (const char* ending : {".bin", ".txt"})
        if (auto file = folder / (std::string(stem) + ending); std::filesystem::exists(file, ignored)) return file;
    return {};
}

template <typename Read>
void read_either(const std::filesystem::path& file, Read binary, Read text, RawModel& model) {
    (file.extension() == ".bin" ? binary : text)(file, model);
}

}  // namespace

bool holds_colmap_model(const std::filesystem::path& folder) {
    return !model_file(folder, "cameras").empty() && !model_file(folder, "images").empty();
}

size_t placed_images(const std::filesystem::path& folder) {
    RawModel raw;
    try {
        read_either(model_file(folder, "images"), read_binary_images, read_text_images, raw);
    } catch (const InputError&) {
        return 0;
    }
    return raw.images.size();
}

ColmapModel read_colmap_model(const std::filesystem::path& folder) {
    const auto cameras = model_file(folder, "cameras"), images = model_file(folder, "images");
    if (cameras.empty() || images.empty())
        throw InputError(folder.string(), "", "holds no sparse model",
                         "it has cameras and images, both .bin or both .txt");
    RawModel raw;
    read_either(cameras, read_binary_cameras, read_text_cameras, raw);
    read_either(images, read_binary_images, read_text_images, raw);
    if (const auto points = model_file(folder, "points3D"); !points.empty())
        read_either(points, read_binary_points, read_text_points, raw);
    ColmapModel model;
    model.file = images.string();
    std::set<std::string> names;
    for (ModelImage& image : raw.images) {
        image.name = portable_name(image.name);
        expect_inside(image.name, model.file, image.place);
        if (!names.insert(image.name).second)
            throw InputError(model.file, image.place, fmt::format("is a second image {:.80}", image.name), "");
        model.images.push_back(pose_camera(image, raw, model.file));
        model.place.push_back(image.place);
    }
    if (model.images.empty())
        throw InputError(model.file, "", "holds no image", "reconstruct again: COLMAP placed no camera");
    model.points = std::move(raw.points);
    return model;
}

}  // namespace neuvv::training
