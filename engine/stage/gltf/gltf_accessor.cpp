#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "base/error.h"
#include "stage/gltf/gltf_parse.h"

namespace neuvv::stage {

namespace {

// Elements that lie in a buffer at a constant stride. The bounds have been checked.
struct Run {
    const uint8_t* data = nullptr;
    size_t stride = 0;
};

Run checked_run(const AccessorReader& reader, const std::string& place, int view_index, uint64_t offset, uint64_t count,
                uint64_t element_bytes) {
    if (view_index < 0 || static_cast<size_t>(view_index) >= reader.model.bufferViews.size())
        throw InputError(reader.file, place, fmt::format("bufferView {} does not exist", view_index));
    const tinygltf::BufferView& view = reader.model.bufferViews[static_cast<size_t>(view_index)];
    const uint64_t stride = view.byteStride ? view.byteStride : element_bytes;
    if (stride < element_bytes)
        throw InputError(reader.file, place,
                         fmt::format("elements of {} bytes overlap: the stride of bufferView {} is {}", element_bytes,
                                     view_index, stride));
    // No overflow: parse_gltf bounds offsets and counts by 2³⁰, and a stride is below 2⁸.
    const uint64_t end = offset + (count - 1) * stride + element_bytes;
    if (end > view.byteLength)
        throw InputError(reader.file, place,
                         fmt::format("{} elements end at byte {} of bufferView {}, which has {}", count, end,
                                     view_index, view.byteLength));
    const tinygltf::Buffer& buffer = reader.model.buffers.at(static_cast<size_t>(view.buffer));
    if (view.byteOffset + view.byteLength > buffer.data.size())
        throw InputError(reader.file, place, fmt::format("bufferView {} runs past its buffer", view_index));
    return {buffer.data.data() + view.byteOffset + offset, stride};
}

template <typename T>
T load(const uint8_t* at) {
    T value;
    std::memcpy(&value, at, sizeof(T));
    return value;
}

double component_at(const uint8_t* at, int type) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return load<int8_t>(at);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return load<uint8_t>(at);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return load<int16_t>(at);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return load<uint16_t>(at);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return load<uint32_t>(at);
        default:
            return static_cast<double>(load<float>(at));
    }
}

// Largest value of a normalised integer; 0 for types that cannot be normalised.
double normalised_range(int type) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return 127;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 255;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return 32767;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 65535;
        default:
            return 0;
    }
}

size_t component_bytes(int type) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return 4;
        default:
            return 0;
    }
}

void read_run(const Run& run, size_t count, size_t components, int type, std::vector<double>& out,
              const std::vector<uint32_t>* scatter = nullptr) {
    const size_t bytes = component_bytes(type);
    for (size_t i = 0; i < count; ++i)
        for (size_t c = 0; c < components; ++c)
            out[(scatter ? (*scatter)[i] : i) * components + c] =
                component_at(run.data + i * run.stride + c * bytes, type);
}

void read_sparse(const AccessorReader& reader, const tinygltf::Accessor& accessor, const std::string& place,
                 size_t components, std::vector<double>& out) {
    const auto& sparse = accessor.sparse;
    const int index_type = sparse.indices.componentType;
    if (sparse.count < 1 || static_cast<size_t>(sparse.count) > accessor.count)
        throw InputError(reader.file, place + "/sparse/count",
                         fmt::format("is {} of {} elements", sparse.count, accessor.count));
    if (sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
        throw InputError(reader.file, place + "/sparse", "has a negative byteOffset");
    if (component_bytes(index_type) == 0 || index_type == TINYGLTF_COMPONENT_TYPE_FLOAT)
        throw InputError(reader.file, place + "/sparse/indices", "has a componentType that is not an unsigned integer");
    const auto count = static_cast<size_t>(sparse.count);
    const Run indices =
        checked_run(reader, place + "/sparse/indices", sparse.indices.bufferView,
                    static_cast<uint64_t>(sparse.indices.byteOffset), count, component_bytes(index_type));
    const Run values = checked_run(reader, place + "/sparse/values", sparse.values.bufferView,
                                   static_cast<uint64_t>(sparse.values.byteOffset), count,
                                   components * component_bytes(accessor.componentType));
    std::vector<uint32_t> scatter(count);
    for (size_t i = 0; i < count; ++i) {
        const double index = component_at(indices.data + i * indices.stride, index_type);
        if (index < 0 || index >= static_cast<double>(accessor.count))
            throw InputError(reader.file, place + "/sparse/indices",
                             fmt::format("element {} is {}, out of range", i, index));
        scatter[i] = static_cast<uint32_t>(index);
    }
    read_run(values, count, components, accessor.componentType, out, &scatter);
}

const tinygltf::Accessor& checked_accessor(const AccessorReader& reader, int index, const std::string& user) {
    if (index < 0 || static_cast<size_t>(index) >= reader.model.accessors.size())
        throw InputError(reader.file, user, fmt::format("accessor {} does not exist", index));
    return reader.model.accessors[static_cast<size_t>(index)];
}

std::vector<double> read_components(AccessorReader& reader, int index, int components, const std::string& user) {
    const tinygltf::Accessor& accessor = checked_accessor(reader, index, user);
    const std::string place = fmt::format("/accessors/{}", index);
    if (accessor_components(reader, index, user) != components)
        throw InputError(reader.file, place,
                         fmt::format("has {} components an element, {} needs {}",
                                     accessor_components(reader, index, user), user, components));
    const size_t bytes = component_bytes(accessor.componentType);
    if (bytes == 0) throw InputError(reader.file, place, "has a componentType that glTF does not know");
    if (accessor.count == 0) throw InputError(reader.file, place, "has no elements");
    const auto width = static_cast<size_t>(components);
    if (accessor.count * width > reader.budget)
        throw InputError(reader.file, place,
                         fmt::format("{} elements are more than this program takes", accessor.count),
                         "simplify the model");
    // The bounds are checked before memory is allocated for a count that may be false.
    Run run;
    if (accessor.bufferView >= 0)
        run = checked_run(reader, place, accessor.bufferView, accessor.byteOffset, accessor.count, width * bytes);
    reader.budget -= accessor.count * width;
    std::vector<double> out(accessor.count * width, 0.0);
    if (run.data) read_run(run, accessor.count, width, accessor.componentType, out);
    if (accessor.sparse.isSparse) read_sparse(reader, accessor, place, width, out);
    return out;
}

}  // namespace

int accessor_components(const AccessorReader& reader, int index, const std::string& user) {
    return tinygltf::GetNumComponentsInType(static_cast<uint32_t>(checked_accessor(reader, index, user).type));
}

bool is_raw_integer(const AccessorReader& reader, int index) {
    const tinygltf::Accessor& accessor = reader.model.accessors.at(static_cast<size_t>(index));
    return accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT && !accessor.normalized;
}

std::vector<float> read_floats(AccessorReader& reader, int index, int components, const std::string& user) {
    const std::vector<double> values = read_components(reader, index, components, user);
    const tinygltf::Accessor& accessor = reader.model.accessors[static_cast<size_t>(index)];
    const double range = accessor.normalized ? normalised_range(accessor.componentType) : 0;
    std::vector<float> out(values.size());
    for (size_t i = 0; i < values.size(); ++i) {
        if (!std::isfinite(values[i]))
            throw InputError(reader.file, fmt::format("/accessors/{}", index),
                             fmt::format("element {} is not finite", i / static_cast<size_t>(components)));
        out[i] = static_cast<float>(range > 0 ? std::max(values[i] / range, -1.0) : values[i]);
    }
    return out;
}

std::vector<uint32_t> read_integers(AccessorReader& reader, int index, int components, const std::string& user) {
    const int type = checked_accessor(reader, index, user).componentType;
    if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
        type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
        throw InputError(reader.file, fmt::format("/accessors/{}", index),
                         fmt::format("{} needs unsigned integers", user));
    const std::vector<double> values = read_components(reader, index, components, user);
    std::vector<uint32_t> out(values.size());
    for (size_t i = 0; i < values.size(); ++i) out[i] = static_cast<uint32_t>(values[i]);
    return out;
}

}  // namespace neuvv::stage
