// Messages of Open Sound Control 1.0, as they arrive in packets.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace neuvv::motion {

using OscArgument = std::variant<double, std::string>;

struct OscMessage {
    std::string path;  // "/VMC/Ext/OK"
    std::vector<OscArgument> arguments;
};

// The messages of a packet that have one of these paths, those of its bundles included, in their order. Other messages
// are passed over. Numbers are int32, float and double, and may be infinite or no numbers. Throws InputError with
// `stream` where the packet is malformed, has bundles in bundles in more than four levels, or where one of these
// messages has an argument that is no number and no text.
std::vector<OscMessage> read_osc(std::span<const uint8_t> packet, std::span<const char* const> paths,
                                 const std::string& stream);

}  // namespace neuvv::motion
