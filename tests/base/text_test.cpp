#include "base/text.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace neuvv {
namespace {

TEST(Text, PasswordsOfAddressesAreHidden) {
    for (const auto& [text, shown] : {
             std::pair("https://eva:secret@host/show.nvs", "https://***@host/show.nvs"),
             std::pair("http://token@host:80?a=b", "http://***@host:80?a=b"),
             std::pair("at http://a:b@c and \"https://d:e@f\"", "at http://***@c and \"https://***@f\""),
             std::pair("https://eva:p@ss:w@host/x", "https://***@host/x"),
             std::pair("https://eva:pa/ss@host/x", "https://***@host/x"),
             std::pair("https://eva:secret@[::1]:80/x", "https://***@[::1]:80/x"),
             std::pair("https://host:8080/@eva/show.nvs", "https://host:8080/@eva/show.nvs"),
             std::pair("https://host/a@b", "https://host/a@b"),
             std::pair("https://[::1]:80/a@b", "https://[::1]:80/a@b"),
             std::pair("eva@host: no address", "eva@host: no address"),
             std::pair("https://", "https://"),
         })
        EXPECT_EQ(without_passwords(text), shown);
    const InputError error("https://eva:secret@host/x", "of http://a:b@c/", "is http://d:secret@e/", "f://g:secret@h");
    EXPECT_EQ(std::string(error.what()).find("secret"), std::string::npos) << error.what();
}

}  // namespace
}  // namespace neuvv
