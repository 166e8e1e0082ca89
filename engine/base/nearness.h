// How near to this machine a network address is.
#pragma once

#include <optional>

struct sockaddr;  // of the operating system

namespace neuvv {

enum class Nearness { kPublic, kOwnNetwork, kOwnMachine };
Nearness nearness_of(const sockaddr& address);
// The same of an address in digits, IPv4 or IPv6; nothing where the text is none.
std::optional<Nearness> nearness_of(const char* ip);

}  // namespace neuvv
