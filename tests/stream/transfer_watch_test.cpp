// How long servers may take, and where redirects may lead.
#include "stream/transport/transfer_watch.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>

#include <vector>

namespace neuvv::stream {
namespace {

sockaddr_storage address_of(const char* text) {
    sockaddr_storage result{};
    auto& v4 = reinterpret_cast<sockaddr_in&>(result);
    auto& v6 = reinterpret_cast<sockaddr_in6&>(result);
    if (inet_pton(AF_INET, text, &v4.sin_addr) == 1)
        v4.sin_family = AF_INET;
    else if (inet_pton(AF_INET6, text, &v6.sin6_addr) == 1)
        v6.sin6_family = AF_INET6;
    else
        ADD_FAILURE() << text;
    return result;
}
bool allows(RedirectRule& rule, const char* text) {
    const sockaddr_storage address = address_of(text);
    return rule.allows(reinterpret_cast<const sockaddr&>(address));
}
Nearness nearness(const char* text) {
    const sockaddr_storage address = address_of(text);
    return nearness_of(reinterpret_cast<const sockaddr&>(address));
}

TEST(Nearness, TellsOwnNetworksFromOthers) {
    for (const char* text :
         {"127.0.0.1", "127.9.9.9", "0.0.0.0", "169.254.169.254", "::1", "::", "fe80::1", "224.0.0.1",
          "255.255.255.255", "::ffff:127.0.0.1", "64:ff9b::7f00:1", "2002:7f00:1::1", "ff02::1"})
        EXPECT_EQ(nearness(text), Nearness::kOwnMachine) << text;
    for (const char* text : {"10.0.0.1", "172.16.0.1", "172.31.255.255", "192.168.1.1", "100.64.0.1", "198.18.0.1",
                             "fd00::1", "fc00::1", "fec0::1", "::ffff:192.168.1.1"})
        EXPECT_EQ(nearness(text), Nearness::kOwnNetwork) << text;
    for (const char* text : {"8.8.8.8", "11.0.0.1", "172.15.255.255", "172.32.0.1", "192.167.255.255", "100.128.0.1",
                             "169.253.0.1", "223.255.255.255", "2606:4700::1", "::ffff:8.8.8.8", "64:ff9b::808:808"})
        EXPECT_EQ(nearness(text), Nearness::kPublic) << text;
}

TEST(RedirectRule, NeverLeadsNearerToThisMachine) {
    RedirectRule of_public;
    of_public.redirected_by("8.8.8.8");
    EXPECT_TRUE(allows(of_public, "2606:4700::1"));
    EXPECT_FALSE(of_public.has_refused());
    EXPECT_FALSE(allows(of_public, "192.168.1.1"));
    of_public.redirected_by("192.168.1.1");
    EXPECT_FALSE(allows(of_public, "127.0.0.1")) << "the first redirect counts";
    EXPECT_FALSE(allows(of_public, "::ffff:10.0.0.1"));
    EXPECT_TRUE(of_public.has_refused());
    RedirectRule of_studio;
    of_studio.redirected_by("fd00::1");
    EXPECT_TRUE(allows(of_studio, "10.1.2.3"));
    EXPECT_TRUE(allows(of_studio, "8.8.8.8"));
    EXPECT_FALSE(allows(of_studio, "169.254.169.254"));
    RedirectRule of_this_machine;
    of_this_machine.redirected_by("127.0.0.1");
    EXPECT_TRUE(allows(of_this_machine, "192.168.1.1"));
    EXPECT_FALSE(of_this_machine.has_refused());
    RedirectRule of_unknown;
    of_unknown.redirected_by("nowhere");
    EXPECT_FALSE(allows(of_unknown, "192.168.1.1"));
}

// A name may have addresses out there and in here, which are tried in any order.
TEST(RedirectRule, AllAddressesOfTheServerItselfMayBeTried) {
    RedirectRule rule;
    for (const char* text : {"2606:4700::1", "192.168.1.9", "127.0.0.1"}) EXPECT_TRUE(allows(rule, text)) << text;
    EXPECT_FALSE(rule.has_refused());
    rule.redirected_by("2606:4700::1");
    EXPECT_FALSE(allows(rule, "192.168.1.9")) << "that another address may be tried opens no way in";
}

TEST(TransferWatch, EachBlockHasItsTime) {
    TransferWatch patient("example.org", 1000, 1e6), impatient("example.org", 1000, -1);
    EXPECT_TRUE(patient.may_go_on(0));
    EXPECT_TRUE(patient.may_go_on(5000));
    EXPECT_FALSE(patient.was_too_slow());
    EXPECT_FALSE(impatient.may_go_on(10));
    EXPECT_TRUE(impatient.was_too_slow());
}

}  // namespace
}  // namespace neuvv::stream
