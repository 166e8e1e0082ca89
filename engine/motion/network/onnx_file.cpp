#include "motion/network/onnx_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "base/error.h"
#include "base/platform.h"

namespace neuvv::motion {

namespace {

using ProtoBytes = std::span<const uint8_t>;

// Members of ONNX's messages, by their numbers in onnx.proto.
constexpr uint64_t kModelGraph = 7, kGraphNode = 1, kGraphInitializer = 5, kGraphInput = 11, kGraphOutput = 12,
                   kNodeAttribute = 5, kAttributeTensor = 5, kValueName = 1, kValueType = 2, kTypeTensor = 1,
                   kTensorShape = 2, kShapeDim = 1, kDimValue = 1;
constexpr uint64_t kTensorDims = 1, kTensorType = 2, kTensorFloats = 4, kTensorInts = 5, kTensorLongs = 7,
                   kTensorName = 8, kTensorRaw = 9, kTensorDoubles = 10, kTensorUnsigned = 11, kTensorLocation = 14;
// Bytes of an element in raw data, by the tensor's type; 0: a type that networks have no numbers of.
constexpr uint64_t kElementBytes[] = {0, 4, 1, 1, 2, 2, 4, 8, 0, 1, 2, 8, 4, 8, 0, 0};
constexpr uint64_t kMaxModelBytes = uint64_t{1} << 31;  // what protobuf reads
constexpr uint64_t kMaxModelElements = uint64_t{1} << 31;

// One member of a protobuf message: a number, or the bytes of a text, of a list or of another message.
struct ProtoField {
    uint64_t member = 0, number = 0;
    ProtoBytes bytes;
    bool is_bytes = false;
};

// Reads a message member by member. Throws InputError where it ends in the middle of one.
class ProtoReader {
  public:
    ProtoReader(ProtoBytes message, const std::string& file) : rest_(message), file_(file) {}

    std::optional<ProtoField> next() {
        if (rest_.empty()) return std::nullopt;
        const uint64_t key = varint();
        ProtoField field{key >> 3, 0, {}, (key & 7) == 2};
        switch (key & 7) {
            case 0:
                field.number = varint();
                break;
            case 1:
                take(8);
                break;
            case 2:
                field.bytes = take(varint());
                break;
            case 5:
                take(4);
                break;
            default:
                fail();
        }
        if (field.member == 0) fail();
        return field;
    }

    bool at_end() const { return rest_.empty(); }
    uint64_t varint() {
        uint64_t value = 0;
        for (unsigned shift = 0; shift < 64; shift += 7) {
            const uint8_t byte = take(1)[0];
            value |= uint64_t{byte & 0x7fu} << shift;
            if (byte < 0x80) return value;
        }
        fail();
    }

  private:
    [[noreturn]] void fail() const {
        throw InputError(file_, "", "is no ONNX model, or a part of one", "export or download it again");
    }
    ProtoBytes take(uint64_t count) {
        if (count > rest_.size()) fail();
        const ProtoBytes taken = rest_.first(count);
        rest_ = rest_.subspan(count);
        return taken;
    }

    ProtoBytes rest_;
    const std::string& file_;
};

// The last member of this number, as protobuf reads it; empty where there is none.
ProtoBytes proto_member(ProtoBytes message, uint64_t member, const std::string& file) {
    ProtoBytes found;
    ProtoReader reader(message, file);
    while (const auto field = reader.next())
        if (field->member == member) found = field->bytes;
    return found;
}

std::string proto_text(ProtoBytes bytes) {
    return {bytes.begin(), bytes.end()};
}

// How many numbers a member has: one, or a list of them, of 4 or 8 bytes each or of the bytes that each needs.
uint64_t count_numbers(const ProtoField& field) {
    if (!field.is_bytes) return 1;
    if (field.member == kTensorFloats) return field.bytes.size() / 4;
    if (field.member == kTensorDoubles) return field.bytes.size() / 8;
    return static_cast<uint64_t>(std::ranges::count_if(field.bytes, [](uint8_t byte) { return byte < 0x80; }));
}

// Of a member that is a number, or a list of them.
std::vector<uint64_t> numbers_of(const ProtoField& field, const std::string& file) {
    if (!field.is_bytes) return {field.number};
    std::vector<uint64_t> numbers;
    ProtoReader list(field.bytes, file);
    while (!list.at_end()) numbers.push_back(list.varint());
    return numbers;
}

uint64_t checked_product(uint64_t count, uint64_t size, const std::string& file) {
    if (size > 0 && count > kMaxModelElements / size)
        throw InputError(file, "graph.initializer", "is larger than any model", "export or download the model again");
    return count * size;
}

// Throws InputError for a tensor that has another number of elements than its sizes say: OpenCV would read beyond.
void check_tensor(ProtoBytes tensor, const std::string& file) {
    uint64_t count = 1, type = 0, raw_bytes = 0;
    std::map<uint64_t, uint64_t> numbers;  // by member
    bool elsewhere = false;
    ProtoReader reader(tensor, file);
    while (const auto field = reader.next()) {
        const uint64_t member = field->member;
        if (member == kTensorDims)
            for (const uint64_t size : numbers_of(*field, file)) count = checked_product(count, size, file);
        if (member == kTensorType) type = field->number;
        if (member == kTensorRaw) raw_bytes = field->bytes.size();
        if (member == kTensorLocation) elsewhere = field->number != 0;
        if (member == kTensorFloats || member == kTensorInts || member == kTensorLongs || member == kTensorDoubles ||
            member == kTensorUnsigned)
            numbers[member] += count_numbers(*field);
    }
    if (elsewhere)
        throw InputError(file, "graph.initializer", "has its numbers in another file", "export the model as one file");
    const uint64_t element = type < std::size(kElementBytes) ? kElementBytes[type] : 0;
    if (element == 0) return;  // OpenCV refuses it
    const bool whole = std::ranges::all_of(numbers, [&](const auto& list) { return list.second == count; });
    if (!whole || (raw_bytes > 0 && raw_bytes != count * element) || (count > 0 && raw_bytes == 0 && numbers.empty()))
        throw InputError(file, "graph.initializer", fmt::format("has not the {} numbers that its sizes say", count),
                         "export or download the model again");
}

// The weights of a graph, and the constants in its nodes.
void check_tensors(ProtoBytes graph, const std::string& file) {
    ProtoReader reader(graph, file);
    while (const auto field = reader.next()) {
        if (field->member == kGraphInitializer) check_tensor(field->bytes, file);
        if (field->member != kGraphNode) continue;
        ProtoReader node(field->bytes, file);
        while (const auto member = node.next()) {
            if (member->member != kNodeAttribute) continue;
            ProtoReader attribute(member->bytes, file);
            while (const auto value = attribute.next())
                if (value->member == kAttributeTensor && value->is_bytes) check_tensor(value->bytes, file);
        }
    }
}

// The sizes of an input or output; 0 for one that the model leaves open, by a name or by a negative number.
std::vector<uint64_t> value_sizes(ProtoBytes value, const std::string& file) {
    const ProtoBytes tensor = proto_member(proto_member(value, kValueType, file), kTypeTensor, file);
    std::vector<uint64_t> sizes;
    ProtoReader dims(proto_member(tensor, kTensorShape, file), file);
    while (const auto dim = dims.next()) {
        if (dim->member != kShapeDim) continue;
        sizes.push_back(0);
        ProtoReader members(dim->bytes, file);
        while (const auto member = members.next())
            if (member->member == kDimValue) sizes.back() = member->number >> 63 ? 0 : member->number;
    }
    return sizes;
}

void expect_possible_size(const OnnxValue& input, const std::string& file) {
    uint64_t count = 1;
    for (const uint64_t size : input.sizes) {
        const uint64_t known = std::max<uint64_t>(size, 1);
        if (known > kMaxInputElements / count)
            throw InputError(file, "graph.input",
                             fmt::format("{} is {}: larger than any image", input.name, input.size_text()),
                             "export or download the model again");
        count *= known;
    }
}

// The graph's inputs that are no weights, and its outputs.
void read_values(ProtoBytes graph, OnnxFile& onnx) {
    std::set<std::string> weights;
    ProtoReader reader(graph, onnx.name);
    while (const auto field = reader.next()) {
        const auto value = [&] {
            return OnnxValue{proto_text(proto_member(field->bytes, kValueName, onnx.name)),
                             value_sizes(field->bytes, onnx.name)};
        };
        if (field->member == kGraphInitializer)
            weights.insert(proto_text(proto_member(field->bytes, kTensorName, onnx.name)));
        if (field->member == kGraphInput) onnx.inputs.push_back(value());
        if (field->member == kGraphOutput) onnx.outputs.push_back(value());
    }
    std::erase_if(onnx.inputs, [&](const OnnxValue& input) { return weights.contains(input.name); });
    for (const OnnxValue& input : onnx.inputs) expect_possible_size(input, onnx.name);
}

}  // namespace

std::string OnnxValue::size_text() const {
    return sizes.empty() ? "without sizes" : fmt::format("{}", fmt::join(sizes, "×"));
}

OnnxFile parse_onnx(std::vector<uint8_t> bytes, const std::string& name) {
    OnnxFile onnx{.name = name, .bytes = std::move(bytes)};
    const ProtoBytes graph = proto_member(onnx.bytes, kModelGraph, name);
    if (graph.empty()) throw InputError(name, "graph", "is not there: this is no ONNX model", "name an .onnx file");
    check_tensors(graph, name);
    read_values(graph, onnx);
    return onnx;
}

OnnxFile read_onnx_file(const std::filesystem::path& path) {
    return parse_onnx(read_file(path, kMaxModelBytes), path.string());
}

}  // namespace neuvv::motion
