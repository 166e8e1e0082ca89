// Streams from nginx, a server as there are many.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>

#include "stream/served_stream.h"
#include "support/input_error.h"

namespace neuvv::test::nginx_test {
namespace {

constexpr const char* kNginx = "/usr/sbin/nginx";

// A port of this machine to which nobody listens at this moment.
int free_port() {
    const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t length = sizeof address;
    EXPECT_EQ(::bind(socket, reinterpret_cast<sockaddr*>(&address), length), 0);
    EXPECT_EQ(::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &length), 0);
    ::close(socket);
    return ntohs(address.sin_port);
}

struct NginxTest : testing::Test, ServedStream {
    int secure_port = 0;

    void SetUp() override {
        if (!std::filesystem::exists(kNginx)) GTEST_SKIP() << "needs nginx (Debian's nginx-light)";
        write(3);
        const std::string certificate = (folder.path / "cert.pem").string(), key = (folder.path / "key.pem").string();
        ASSERT_EQ(std::system(fmt::format("openssl req -x509 -newkey rsa:2048 -nodes -subj /CN=localhost -keyout {} "
                                          "-out {} 2>/dev/null",
                                          key, certificate)
                                  .c_str()),
                  0)
            << "is openssl there?";
        // Another program may take a port before nginx does: then nginx ends.
        for (int tries = 0; tries < 20 && !starts(certificate, key); ++tries) {
        }
        ASSERT_TRUE(std::filesystem::exists(folder.path / "pid")) << read_text(log);
    }
    bool starts(const std::string& certificate, const std::string& key) {
        port = free_port();
        secure_port = free_port();
        std::ofstream(folder.path / "nginx.conf") << fmt::format(
            R"(daemon off; master_process off; pid {0}/pid; error_log {0}/error.log;
events {{}}
http {{
  access_log {0}/access.log; client_body_temp_path {0}/body; proxy_temp_path {0}/proxy; fastcgi_temp_path {0}/fastcgi;
  uwsgi_temp_path {0}/uwsgi; scgi_temp_path {0}/scgi;
  server {{
    listen 127.0.0.1:{1}; root {0};
    location /slow/ {{ alias {0}/; limit_rate 200k; }}
    location /moved/ {{ rewrite ^/moved/(.*)$ /$1 redirect; }}
    location /circle/ {{ return 302 $request_uri; }}
    location /busy/ {{ return 503; }}
    location /gzip/ {{ alias {0}/; gzip on; gzip_types *; gzip_min_length 1; }}
    location /whole/ {{ alias {0}/; max_ranges 0; }}
  }}
  server {{ listen 127.0.0.1:{2} ssl; root {0}; ssl_certificate {3}; ssl_certificate_key {4}; }}
}})",
            folder.path.string(), port, secure_port, certificate, key);
        server = std::make_unique<ChildProcess>(
            std::vector<std::string>{kNginx, "-p", folder.path.string(), "-c", (folder.path / "nginx.conf").string()},
            log);
        return server->until([&] { return std::filesystem::exists(folder.path / "pid"); });
    }
    // "" is as nginx does it by default.
    void expect_plays(const std::string& place) const {
        stream::Reader reader(fmt::format("http://127.0.0.1:{}{}/show.nvs", port, place));
        for (const uint32_t frame : {2u, 0u, 1u, 2u}) EXPECT_EQ(reader.frame(frame)->planes, decoded[frame].planes);
    }
    void expect_refused(const std::string& address, const std::string& problem) const {
        expect_input_error([&] { stream::Reader reader(address); }, {problem});
    }
};

TEST_F(NginxTest, PlaysAsItIsByDefault) {
    expect_plays("");
    expect_plays("/moved");
    expect_plays("/gzip");
}

TEST_F(NginxTest, PlaysThroughALineThatIsSlow) {
    const auto from = std::chrono::steady_clock::now();
    expect_plays("/slow");
    EXPECT_GT(std::chrono::steady_clock::now() - from, std::chrono::seconds(1)) << "else it was not slow";
}

TEST_F(NginxTest, SaysWhatIsWrong) {
    const std::string begin = fmt::format("http://127.0.0.1:{}", port);
    expect_refused(begin + "/missing.nvs", "answers 404");
    expect_refused(begin + "/circle/show.nvs", "redirects");
    expect_refused(begin + "/busy/show.nvs", "answers 503");
    expect_refused(begin + "/whole/show.nvs", "not by ranges");
    expect_refused(begin + "/key.pem", "no stream");
    expect_refused(fmt::format("https://127.0.0.1:{}/show.nvs", secure_port), "certificate");
}

}  // namespace
}  // namespace neuvv::test::nginx_test
