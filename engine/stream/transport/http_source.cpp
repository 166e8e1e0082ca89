#include "stream/transport/http_source.h"

#include <curl/curl.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstring>
#include <mutex>
#include <thread>
#include <utility>

#include "base/error.h"
#include "base/platform.h"
#include "base/seconds.h"
#include "base/text.h"
#include "base/trace_file.h"

namespace neuvv::stream {

namespace {

constexpr int kTries = 4;
constexpr long kConnect_s = 10, kStall_s = 15, kMostRedirects = 5;
constexpr uint64_t kMostBytes = uint64_t{1} << 42;

// Servers that are busy, and gateways that do not reach them.
bool is_passing(long status) {
    return status == 429 || status == 500 || status == 502 || status == 503 || status == 504;
}

// Connections that break or stall. Others, such as a name that is not known, will not be better a second later.
bool is_passing(CURLcode code) {
    return code == CURLE_COULDNT_CONNECT || code == CURLE_OPERATION_TIMEDOUT || code == CURLE_RECV_ERROR ||
           code == CURLE_SEND_ERROR || code == CURLE_PARTIAL_FILE || code == CURLE_GOT_NOTHING;
}

// The same a minute later: also where the network is gone for a while, and nobody knows the name.
bool may_pass(CURLcode code) {
    return is_passing(code) || code == CURLE_COULDNT_RESOLVE_HOST || code == CURLE_ABORTED_BY_CALLBACK;
}

// What went wrong, for people; `text` is curl's own.
std::string text_of(CURLcode code, const std::string& text) {
    switch (code) {
        case CURLE_COULDNT_RESOLVE_HOST:
            return "there is no server of this name";
        case CURLE_COULDNT_CONNECT:
            return "no server answers there";
        case CURLE_OPERATION_TIMEDOUT:
            return "the server does not answer in time";
        case CURLE_URL_MALFORMAT:
        case CURLE_UNSUPPORTED_PROTOCOL:
            return "this is no address of a file on a web server";
        case CURLE_WEIRD_SERVER_REPLY:
            return "what answers there is no web server";
        case CURLE_WRITE_ERROR:  // by Answer::take
            return "the server sends more than it was asked for";
        case CURLE_TOO_MANY_REDIRECTS:
            return "the server redirects from one address to the next";
        case CURLE_GOT_NOTHING:
        case CURLE_PARTIAL_FILE:
        case CURLE_RECV_ERROR:
        case CURLE_SEND_ERROR:
            return "the server broke off";
        case CURLE_PEER_FAILED_VERIFICATION:
            return "nobody whom this machine trusts vouches for the server's certificate";
        case CURLE_SSL_CONNECT_ERROR:
            return "no secure connection can be made";
        default:
            return text;
    }
}

// What curl asks about a request.
struct Watched {
    const std::atomic<bool>& cancelled;
    TransferWatch watch;
};
int ends_transfer(void* watched, curl_off_t, curl_off_t bytes, curl_off_t, curl_off_t) {
    auto& of = *static_cast<Watched*>(watched);
    return of.cancelled || stop_requested() || !of.watch.may_go_on(static_cast<uint64_t>(bytes)) ? 1 : 0;
}

curl_socket_t open_allowed(void* rule, curlsocktype, curl_sockaddr* to) {
    if (!static_cast<RedirectRule*>(rule)->allows(to->addr)) return CURL_SOCKET_BAD;
    return socket(to->family, to->socktype | SOCK_CLOEXEC, to->protocol);
}

// "host:port" of an address.
std::string server_of(const std::string& address) {
    const std::string shown = without_passwords(address);
    const size_t begin = shown.find("://") + 3, end = std::min(shown.find_first_of("/?#", begin), shown.size());
    const std::string server = shown.substr(begin, end - begin);
    return server.substr(server.rfind('@') + 1);
}

void begin_curl() {
    static std::once_flag once;
    std::call_once(once, [] { curl_global_init(CURL_GLOBAL_DEFAULT); });
}

// The numbers of "bytes FIRST-LAST/SIZE"; all 0 where it is something else.
struct Range {
    uint64_t first = 0, last = 0, size = 0;
};
Range range_of(std::string_view text) {
    Range range;
    const size_t begin = text.find("bytes "), dash = text.find('-'), slash = text.find('/');
    if (begin == std::string_view::npos || dash == std::string_view::npos || slash == std::string_view::npos) return {};
    const auto number = [&](size_t from, uint64_t& value) {
        return std::from_chars(text.data() + from, text.data() + text.size(), value).ec == std::errc();
    };
    if (!number(begin + 6, range.first) || !number(dash + 1, range.last) || !number(slash + 1, range.size)) return {};
    return range;
}

}  // namespace

struct HttpSource::Answer {
    CURL* curl = nullptr;
    CURLcode code = CURLE_OK;
    long status = 0;
    uint64_t most = 0;  // bytes that are taken
    std::vector<uint8_t> bytes;
    std::string range;                   // of the last answer's header
    double first_byte_s = 0, all_s = 0;  // since it was asked for
    std::string problem;
    RedirectRule redirects;

    static size_t take(char* data, size_t one, size_t count, void* to) {
        auto& answer = *static_cast<Answer*>(to);
        const size_t bytes = one * count;
        if (answer.bytes.size() + bytes > answer.most) return 0;  // it ends the transfer
        answer.bytes.insert(answer.bytes.end(), data, data + bytes);
        return bytes;
    }
    static size_t take_header(char* data, size_t one, size_t count, void* to) {
        auto& answer = *static_cast<Answer*>(to);
        const std::string line = lower_case(std::string(data, one * count));
        if (line.starts_with("http/")) {
            answer.range.clear();  // of a redirect
            const char* ip = "";
            if (line.find(" 3") == line.find(' ') &&
                curl_easy_getinfo(answer.curl, CURLINFO_PRIMARY_IP, &ip) == CURLE_OK)
                answer.redirects.redirected_by(ip);
        }
        if (line.starts_with("content-range:")) answer.range = line.substr(std::strlen("content-range:"));
        return one * count;
    }
};

HttpSource::HttpSource(std::string address, CachePlace cache, double most_s_a_block)
    : address_(std::move(address)), most_s_a_block_(most_s_a_block) {
    begin_curl();
    curl_ = curl_easy_init();
    if (!curl_) throw std::bad_alloc();
    const bool secure = address_.starts_with("https://");
    curl_easy_setopt(curl_, CURLOPT_URL, address_.c_str());
    curl_easy_setopt(curl_, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(curl_, CURLOPT_REDIR_PROTOCOLS_STR, secure ? "https" : "http,https");
    curl_easy_setopt(curl_, CURLOPT_FOLLOWLOCATION, 1L);
    curl_easy_setopt(curl_, CURLOPT_MAXREDIRS, kMostRedirects);
    curl_easy_setopt(curl_, CURLOPT_CONNECTTIMEOUT, kConnect_s);
    curl_easy_setopt(curl_, CURLOPT_LOW_SPEED_LIMIT, 1L);
    curl_easy_setopt(curl_, CURLOPT_LOW_SPEED_TIME, kStall_s);
    curl_easy_setopt(curl_, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(curl_, CURLOPT_USERAGENT, "neuvv");
    curl_easy_setopt(curl_, CURLOPT_NOPROGRESS, 0L);
    curl_easy_setopt(curl_, CURLOPT_XFERINFOFUNCTION, &ends_transfer);
    curl_easy_setopt(curl_, CURLOPT_OPENSOCKETFUNCTION, &open_allowed);
    curl_easy_setopt(curl_, CURLOPT_WRITEFUNCTION, &Answer::take);
    curl_easy_setopt(curl_, CURLOPT_HEADERFUNCTION, &Answer::take_header);
    try {
        const double begin_s = seconds_now();
        keep_locked(0, fetch({0, 1}));
        measure_locked(blocks_[0].size(), seconds_now() - begin_s);
        cache_.emplace(std::move(cache), address_, stamp_.bytes, blocks_[0]);
        thread_ = std::thread([this] { run(); });
    } catch (...) {
        curl_easy_cleanup(curl_);
        throw;
    }
}

HttpSource::~HttpSource() {
    cancel();
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    changed_.notify_all();
    thread_.join();
    curl_easy_cleanup(curl_);
}

HttpSource::Answer HttpSource::request(uint64_t offset, uint64_t count) {
    Watched watched{cancelled_, {server_of(address_), kBlock, most_s_a_block_}};  // all tries share the time
    for (int tries = 1;; ++tries) {
        Answer answer;
        answer.curl = curl_;
        answer.most = count;
        char problem[CURL_ERROR_SIZE] = {};
        const std::string range = fmt::format("{}-{}", offset, offset + count - 1);
        curl_easy_setopt(curl_, CURLOPT_XFERINFODATA, &watched);
        curl_easy_setopt(curl_, CURLOPT_RANGE, range.c_str());
        curl_easy_setopt(curl_, CURLOPT_WRITEDATA, &answer);
        curl_easy_setopt(curl_, CURLOPT_HEADERDATA, &answer);
        curl_easy_setopt(curl_, CURLOPT_OPENSOCKETDATA, &answer.redirects);
        curl_easy_setopt(curl_, CURLOPT_ERRORBUFFER, problem);
        answer.code = curl_easy_perform(curl_);
        curl_easy_setopt(curl_, CURLOPT_ERRORBUFFER, nullptr);
        curl_easy_getinfo(curl_, CURLINFO_RESPONSE_CODE, &answer.status);
        curl_easy_getinfo(curl_, CURLINFO_STARTTRANSFER_TIME, &answer.first_byte_s);
        curl_easy_getinfo(curl_, CURLINFO_TOTAL_TIME, &answer.all_s);
        answer.problem = text_of(answer.code, problem[0] ? problem : curl_easy_strerror(answer.code));
        if (stop_requested()) throw RuntimeFailure(fmt::format("stopped while waiting for {}", server_of(address_)));
        if (watched.watch.was_too_slow())
            answer.problem =
                fmt::format("{} sends less than {} kB in {} s", server_of(address_), kBlock >> 10, most_s_a_block_);
        if (watched.watch.was_too_slow() || answer.redirects.has_refused()) return answer;
        const bool passing = answer.code == CURLE_OK ? is_passing(answer.status) : is_passing(answer.code);
        if (!passing || tries == kTries || cancelled_) return answer;
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, std::chrono::milliseconds(150 << tries), [this] { return cancelled_ || stop_; });
    }
}

// Throws InputError where the answer is not the range that was asked for. The file may end within it.
void HttpSource::require_range(const Answer& answer, uint64_t offset, uint64_t count) {
    const auto fail = [&](const std::string& problem, const char* fix) {
        throw InputError(address_, "", problem, fix);
    };
    if (answer.status == 200)
        fail("is sent as a whole, not by ranges", "put it on a server that answers range requests");
    if (answer.code != CURLE_OK && answer.redirects.has_refused())
        fail("the server redirects to an address in this machine's own network", "open that address itself");
    if (may_pass(answer.code))
        throw ServerProblem(address_, "", fmt::format("cannot be read: {}", answer.problem),
                            "check the address and the network");
    if (answer.code != CURLE_OK) fail(fmt::format("cannot be read: {}", answer.problem), "check the address");
    if (is_passing(answer.status))
        throw ServerProblem(address_, "", fmt::format("the server answers {}", answer.status), "try again later");
    if (answer.status != 206) fail(fmt::format("the server answers {}", answer.status), "check the address");
    const Range range = range_of(answer.range);
    const uint64_t last = std::min(offset + count, range.size) - 1;
    if (range.size == 0 || range.size > kMostBytes || range.first != offset || range.last != last ||
        answer.bytes.size() != last - offset + 1)
        fail("the server sends another range than it was asked for", "put it on another server");
    if (stamp_.bytes != 0 && stamp_.bytes != range.size) fail("was changed meanwhile", "open it again");
    if (stamp_.bytes == 0) stamp_.bytes = range.size;
}

std::vector<uint8_t> HttpSource::fetch(const Blocks& blocks) {
    const uint64_t offset = blocks.first * kBlock;
    uint64_t count = blocks.count() * kBlock;
    if (stamp_.bytes != 0) count = std::min(count, stamp_.bytes - offset);
    Answer answer = request(offset, count);
    require_range(answer, offset, count);
    measure_line(answer);
    return std::move(answer.bytes);
}

std::optional<std::vector<uint8_t>> HttpSource::read_copy(uint64_t block) const {
    return cache_->read(block, std::min(kBlock, stamp_.bytes - block * kBlock));
}

void HttpSource::keep_copies(uint64_t first, const std::vector<uint8_t>& bytes) {
    const std::lock_guard lock(copies_mutex_);
    if (!keeps_copies_) return;
    for (uint64_t begin = 0; begin < bytes.size(); begin += kBlock)
        cache_->write(first + begin / kBlock,
                      std::span(bytes).subspan(begin, std::min<uint64_t>(kBlock, bytes.size() - begin)));
}

// The first of these blocks that are not here, as many as follow each other, up to `most`; none where all are.
HttpSource::Blocks HttpSource::missing_locked(const Blocks& in, uint64_t most) const {
    Blocks missing{in.first, in.first};
    while (missing.first < in.end && blocks_.contains(missing.first)) ++missing.first;
    missing.end = missing.first;
    while (missing.end < in.end && missing.count() < most && !blocks_.contains(missing.end)) ++missing.end;
    return missing;
}

void HttpSource::use_locked(uint64_t block) {
    std::erase(order_, block);
    order_.push_back(block);
}

void HttpSource::keep_locked(uint64_t first, const std::vector<uint8_t>& bytes) {
    for (uint64_t begin = 0; begin < bytes.size(); begin += kBlock) {
        const uint64_t end = std::min<uint64_t>(begin + kBlock, bytes.size());
        blocks_[first + begin / kBlock].assign(bytes.begin() + static_cast<ptrdiff_t>(begin),
                                               bytes.begin() + static_cast<ptrdiff_t>(end));
        use_locked(first + begin / kBlock);
    }
    while (order_.size() > kMostBlocks) {
        blocks_.erase(order_.front());
        order_.erase(order_.begin());
    }
}

// What fails while nobody waits for it is asked for again when somebody does, or says again what is read next.
void HttpSource::run() {
    name_trace_thread("fetches a stream");
    std::unique_lock lock(mutex_);
    for (;;) {
        Blocks next;
        bool is_needed = false;
        changed_.wait(lock, [&] {
            next = missing_needed_locked();
            is_needed = next.count() > 0;
            if (!is_needed) next = missing_ahead_locked();
            return stop_ || next.count() > 0;
        });
        if (stop_) return;
        lock.unlock();
        std::vector<uint8_t> bytes;
        std::optional<std::vector<uint8_t>> copy;  // of the first block
        std::exception_ptr failure;
        const double begin_s = seconds_now();
        try {
            const TraceSpan span("fetch from block", static_cast<int64_t>(next.first));
            copy = read_copy(next.first);
            bytes = copy ? std::move(*copy) : fetch(next);
        } catch (...) {
            failure = std::current_exception();
        }
        lock.lock();
        if (failure) {
            if (!is_needed) ahead_ = {};
            // Who waits for what was fetched ahead need not wait as long again.
            for (Need* need : needs_)
                if (const Blocks missing = missing_locked(need->blocks); missing.count() > 0)
                    if (missing.first == next.first) need->failure = failure;
        } else {
            keep_locked(next.first, bytes);
            measure_locked(bytes.size(), seconds_now() - begin_s);
        }
        changed_.notify_all();
        if (failure || copy) continue;
        lock.unlock();
        keep_copies(next.first, bytes);
        lock.lock();
    }
}

// What the thread fetched before, but has not written yet, is not kept, either.
void HttpSource::forget_copies() {
    const std::lock_guard lock(copies_mutex_);
    keeps_copies_ = false;
    cache_->forget();
}

void HttpSource::cancel() {
    cancelled_ = true;
    const std::lock_guard lock(mutex_);  // so that nobody misses it who is about to wait
    changed_.notify_all();
}

void HttpSource::read_ahead(const std::vector<ByteRange>& ranges) {
    std::vector<Blocks> ahead;
    uint64_t room = kMostAhead;
    for (const ByteRange& range : ranges) {
        if (range.count == 0 || range.end() > size()) continue;
        Blocks blocks{range.offset / kBlock, (range.end() - 1) / kBlock + 1};
        blocks.end = std::min(blocks.end, blocks.first + room);
        room -= blocks.count();
        if (blocks.count() > 0) ahead.push_back(blocks);
    }
    const std::lock_guard lock(mutex_);
    ahead_ = std::move(ahead);
    changed_.notify_all();
}

// Of what is waited for, and may still come: the first blocks that are not here.
HttpSource::Blocks HttpSource::missing_needed_locked() const {
    for (const Need* need : needs_)
        if (const Blocks missing = missing_locked(need->blocks); !need->failure && missing.count() > 0) return missing;
    return {};
}

// Of what is read next: the first blocks that are not here.
HttpSource::Blocks HttpSource::missing_ahead_locked() const {
    const uint64_t most = most_ahead_locked();
    for (const Blocks& blocks : ahead_)
        if (const Blocks missing = missing_locked(blocks, most); missing.count() > 0) return missing;
    return {};
}

void HttpSource::measure_line(const Answer& answer) {
    constexpr double kOlder = 0.7;
    const std::lock_guard lock(mutex_);
    answer_s_ = line_s_ > 0 ? kOlder * answer_s_ + (1 - kOlder) * answer.first_byte_s : answer.first_byte_s;
    line_bytes_ = kOlder * line_bytes_ + static_cast<double>(answer.bytes.size());
    line_s_ = kOlder * line_s_ + std::max(answer.all_s - answer.first_byte_s, 1e-6);
}

// In blocks.
uint64_t HttpSource::most_ahead_locked() const {
    const double bytes = std::max(kRequestAhead_s, 4 * answer_s_) * line_bytes_ / line_s_;
    return static_cast<uint64_t>(std::clamp(bytes / kBlock, 1.0, double{kMostOfARequest}));
}

// A request counts with the time that the server needs to answer: small ones are as slow as they are. What comes from
// the disk counts, too: then the server is not asked.
void HttpSource::measure_locked(uint64_t bytes, double seconds) {
    constexpr double kOlder = 0.7;
    recent_bytes_ = kOlder * recent_bytes_ + static_cast<double>(bytes);
    recent_s_ = kOlder * recent_s_ + seconds;
}

std::optional<double> HttpSource::bytes_per_s() const {
    const std::lock_guard lock(mutex_);
    return recent_s_ > 0 ? recent_bytes_ / recent_s_ : 0;
}

// Block by block, as not all of a large range is kept.
std::vector<uint8_t> HttpSource::read(uint64_t offset, uint64_t count) {
    std::vector<uint8_t> bytes;
    if (count == 0) return bytes;
    bytes.reserve(count);
    Need need;
    std::unique_lock lock(mutex_);
    needs_.push_back(&need);
    struct Leave {  // before the lock ends
        std::vector<Need*>& needs;
        Need* need;
        ~Leave() { std::erase(needs, need); }
    };
    const Leave leave{needs_, &need};
    const uint64_t end_block = (offset + count - 1) / kBlock + 1;
    for (uint64_t block = offset / kBlock; block < end_block; ++block) {
        need.blocks = {block, std::min(end_block, block + kMostOfARequest)};
        const auto has_block = [&](const Blocks& blocks) { return block >= blocks.first && block < blocks.end; };
        if (std::ranges::none_of(ahead_, has_block)) ahead_ = {};  // it was said for another place
        changed_.notify_all();
        changed_.wait(lock, [&] { return need.failure || blocks_.contains(block); });
        if (need.failure) std::rethrow_exception(need.failure);
        const std::vector<uint8_t>& whole = blocks_.at(block);
        const uint64_t from = std::max(offset, block * kBlock) - block * kBlock;
        const uint64_t to = std::min(offset + count, block * kBlock + whole.size()) - block * kBlock;
        bytes.insert(bytes.end(), whole.begin() + static_cast<ptrdiff_t>(from),
                     whole.begin() + static_cast<ptrdiff_t>(to));
        use_locked(block);
    }
    return bytes;
}

}  // namespace neuvv::stream
