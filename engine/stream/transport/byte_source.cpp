#include "stream/transport/byte_source.h"

#include <fstream>
#include <mutex>

#include "base/error.h"
#include "base/platform.h"
#include "stream/transport/http_source.h"

namespace neuvv::stream {

namespace {

class FileSource : public ByteSource {
  public:
    explicit FileSource(const std::filesystem::path& path) : path_(path) {
        expect_regular_file(path);
        file_.open(path, std::ios::binary);
        stamp_ = stamp_of(path);
        if (!file_) throw InputError(path.string(), "", "cannot be opened");
    }
    std::vector<uint8_t> read(uint64_t offset, uint64_t count) override {
        std::vector<uint8_t> bytes(count);
        const std::lock_guard lock(mutex_);
        file_.clear();
        file_.seekg(static_cast<std::streamoff>(offset));
        file_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(count));
        if (!file_) throw InputError(path_.string(), "", "cannot be read to its end");
        return bytes;
    }

  private:
    std::filesystem::path path_;
    std::mutex mutex_;  // guards the file and its place
    std::ifstream file_;
};

}  // namespace

bool is_address(const std::filesystem::path& path) {
    return path.native().starts_with("http://") || path.native().starts_with("https://");
}

std::unique_ptr<ByteSource> open_source(const std::filesystem::path& path) {
    if (is_address(path)) return std::make_unique<HttpSource>(path.string());
    return std::make_unique<FileSource>(path);
}

}  // namespace neuvv::stream
