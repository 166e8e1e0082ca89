#include "motion/live/osc.h"

#include <lo/lo.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string_view>

#include "base/error.h"

namespace neuvv::motion {

namespace {

constexpr size_t kMostLevels = 4;  // of bundles in bundles
constexpr std::string_view kBundle("#bundle\0", 8);
constexpr size_t kTimeTag_bytes = 8;

using Bytes = std::span<const uint8_t>;

// The text that begins at `at`, without its end.
std::string_view text_at(Bytes bytes, size_t at, const std::string& stream) {
    const auto begin = bytes.begin() + static_cast<ptrdiff_t>(std::min(at, bytes.size()));
    const auto end = std::find(begin, bytes.end(), uint8_t{0});
    if (end == bytes.end()) throw InputError(stream, "", "has an OSC packet with a text that does not end");
    return {reinterpret_cast<const char*>(&*begin), static_cast<size_t>(end - begin)};
}

size_t padded(size_t text_bytes) {
    return (text_bytes / 4 + 1) * 4;
}

template <typename Number>
double number_of(const lo_arg* argument) {
    Number number;  // arguments are aligned to four bytes, a lo_arg to eight
    std::memcpy(&number, argument, sizeof number);
    return static_cast<double>(number);
}

OscArgument argument_of(char type, lo_arg* argument) {
    switch (type) {
        case LO_INT32:
            return number_of<int32_t>(argument);
        case LO_FLOAT:
            return number_of<float>(argument);
        case LO_DOUBLE:
            return number_of<double>(argument);
        default:
            return std::string(reinterpret_cast<const char*>(argument));
    }
}

// liblo's parser checks sizes, but for that of a blob, which it reads without knowing whether it is there; so messages
// with blobs do not come to it, nor any others that nobody here reads.
std::vector<OscArgument> arguments_of(Bytes bytes, std::string_view types, const std::string& stream) {
    if (!types.starts_with(',') || types.find_first_not_of("ifds", 1) != std::string_view::npos)
        throw InputError(stream, "", "has an OSC message with arguments that are no numbers and no texts");
    const std::unique_ptr<std::remove_pointer_t<lo_message>, decltype(&lo_message_free)> message(
        lo_message_deserialise(const_cast<uint8_t*>(bytes.data()), bytes.size(), nullptr), &lo_message_free);
    if (!message) throw InputError(stream, "", "has an OSC message whose arguments are cut off or too long");
    std::vector<OscArgument> arguments;
    lo_arg** const values = lo_message_get_argv(message.get());
    for (size_t i = 1; i < types.size(); ++i) arguments.push_back(argument_of(types[i], values[i - 1]));
    return arguments;
}

class Reader {
  public:
    Reader(std::span<const char* const> paths, const std::string& stream) : paths_(paths), stream_(stream) {}

    void read(Bytes bytes, size_t levels) {
        if (bytes.empty() || bytes.size() % 4 != 0)
            throw InputError(stream_, "", "has a packet whose size is not that of an OSC packet");
        if (bytes[0] == '#')
            read_bundle(bytes, levels + 1);
        else
            read_message(bytes);
    }
    std::vector<OscMessage> messages;

  private:
    void read_bundle(Bytes bytes, size_t levels) {
        if (bytes.size() < kBundle.size() + kTimeTag_bytes ||
            std::memcmp(bytes.data(), kBundle.data(), kBundle.size()) != 0)
            throw InputError(stream_, "", "has an OSC bundle without a beginning");
        if (levels > kMostLevels) throw InputError(stream_, "", "has OSC bundles in bundles, more than four levels");
        bytes = bytes.subspan(kBundle.size() + kTimeTag_bytes);
        while (!bytes.empty()) {
            if (bytes.size() < 4) throw InputError(stream_, "", "has an OSC bundle that is cut off");
            const size_t size = size_t{bytes[0]} << 24 | size_t{bytes[1]} << 16 | size_t{bytes[2]} << 8 | bytes[3];
            bytes = bytes.subspan(4);
            if (size > bytes.size()) throw InputError(stream_, "", "has an OSC bundle that is cut off");
            read(bytes.first(size), levels);
            bytes = bytes.subspan(size);
        }
    }

    void read_message(Bytes bytes) {
        const std::string_view path = text_at(bytes, 0, stream_);
        if (!path.starts_with('/')) throw InputError(stream_, "", "has a packet that is no OSC message");
        if (std::ranges::find(paths_, path) == paths_.end()) return;
        const std::string_view types = text_at(bytes, padded(path.size()), stream_);
        messages.push_back({std::string(path), arguments_of(bytes, types, stream_)});
    }

    std::span<const char* const> paths_;
    const std::string& stream_;
};

}  // namespace

std::vector<OscMessage> read_osc(std::span<const uint8_t> packet, std::span<const char* const> paths,
                                 const std::string& stream) {
    Reader reader(paths, stream);
    reader.read(packet, 0);
    return std::move(reader.messages);
}

}  // namespace neuvv::motion
