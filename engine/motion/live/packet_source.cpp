#include "motion/live/packet_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "base/error.h"
#include "base/udp_socket.h"
#include "motion/live/pose_stream.h"
#include "motion/live/vmc.h"

namespace neuvv::motion {

namespace {

constexpr double kSilence_s = 2;    // after which another sender may go on
constexpr double kPatience_s = 1;   // in which a body may come in parts, or from another sender
constexpr size_t kMostSenders = 8;  // that are heard before one of them sends a body

// Which port of a machine is followed, where two programs there send bodies at the same time: the one from which bodies
// came again first. A program that takes another port for each packet, or that begins anew, is none of two.
class Ports {
  public:
    // Of a packet with a body, or a part of one. Throws InputError where it is of another program than the one that is
    // followed. Returns whether what came before may be of others, and does not count any more.
    bool add(uint16_t port, double now_s, const std::string& stream) {
        if (follows_other(port))
            throw InputError(
                stream, fmt::format("port {}", port),
                fmt::format("sends another body than port {} of the same machine, which is followed", *followed_),
                "let one of the two programs send elsewhere");
        const bool replaces = followed_ && *followed_ != port;
        if (replaces) followed_.reset();
        if (replaces) recent_.clear();
        last_ = port;
        const auto known = std::ranges::find(recent_, port, &Recent::port);
        const bool again = known != recent_.end();
        if (again) recent_.erase(known);
        recent_.push_back({port, now_s});
        if (recent_.size() > kMostPrograms) recent_.erase(recent_.begin(), recent_.end() - kMostPrograms);
        if (followed_ || !again || recent_.size() == kMostPrograms) return replaces;
        followed_ = port;
        const bool mixed = recent_.size() > 1;
        recent_ = {{port, now_s}};
        return mixed;
    }
    bool follows_other(uint16_t port) const { return followed_ && *followed_ != port && !recent_.empty(); }
    // Whether a packet without a body may tell of the body.
    bool counts(uint16_t port) const { return followed_ ? *followed_ == port : recent_.size() > 1 || last_ == port; }
    // No more packets wait: only now is known from where nothing came.
    void end(double now_s) {
        std::erase_if(recent_, [&](const Recent& one) { return now_s - one.heard_s > kAtOnce_s; });
    }

  private:
    struct Recent {
        uint16_t port = 0;
        double heard_s = 0;
    };
    static constexpr double kAtOnce_s = 0.5;    // in which a program that sends has sent
    static constexpr size_t kMostPrograms = 4;  // as many ports are those of one program, which always takes another
    std::optional<uint16_t> followed_, last_;
    std::vector<Recent> recent_;  // the newest at the end; where one is followed, that one, unless it is silent
};

// The packets of one sender.
class PacketReader {
  public:
    virtual ~PacketReader() = default;
    // Takes a packet, which came from this port. Returns whether it is a pose by itself. Throws InputError where it is
    // malformed.
    virtual bool read(std::span<const uint8_t> packet, uint16_t port, double now_s, PoseStream& stream) = 0;
    // No more packets wait. Returns whether a pose has come. Throws InputError where what came is no pose.
    virtual bool end(double now_s, PoseStream& stream) = 0;
};

// Programs without a body, as trackers of faces, send their status to the same port: it says nothing of the body that
// another program sends.
class VmcReader : public PacketReader {
  public:
    explicit VmcReader(std::string name) : name_(std::move(name)) {}
    bool read(std::span<const uint8_t> packet, uint16_t port, double now_s, PoseStream&) override {
        VmcBody other;
        VmcBody& body = ports_.follows_other(port) ? other : body_;
        if (!body.read(packet, name_, ports_.counts(port)) || !ports_.add(port, now_s, name_)) return false;
        body_ = {};
        body_.read(packet, name_);
        return false;
    }
    bool end(double now_s, PoseStream& stream) override {
        ports_.end(now_s);
        const auto poses = body_.take(name_);
        if (poses) stream.add_untimed(poses->newest, now_s, poses->count);
        return poses.has_value();
    }

  private:
    std::string name_;
    VmcBody body_;
    Ports ports_;
};

class JsonReader : public PacketReader {
  public:
    explicit JsonReader(std::string name) : name_(std::move(name)) {}
    bool read(std::span<const uint8_t> packet, uint16_t port, double now_s, PoseStream& stream) override {
        const TimedPose pose = read_pose_line({packet.begin(), packet.end()}, name_);
        person_.expect(pose, name_);
        ports_.add(port, now_s, name_);
        has_body_ = has_body_ || std::ranges::any_of(pose.pose, [](const auto& joint) { return joint.confidence > 0; });
        if (has_body_) stream.add(pose, now_s);  // later, nobody may be seen
        return has_body_;
    }
    bool end(double now_s, PoseStream&) override {
        ports_.end(now_s);
        return false;
    }

  private:
    std::string name_;
    FirstPerson person_;
    Ports ports_;
    bool has_body_ = false;
};

using MakeReader = std::unique_ptr<PacketReader> (*)(const std::string& name);

class PacketSource : public PoseSource {
  public:
    PacketSource(std::unique_ptr<UdpSocket> socket, MakeReader make_reader, std::string name, std::string advice)
        : socket_(std::move(socket)), make_reader_(make_reader), name_(std::move(name)), advice_(std::move(advice)) {}

    std::optional<TimedPose> newest(double now_s) override {
        // Everything that waits, and not much more where packets come faster than they are read.
        size_t bytes = 0;
        for (size_t i = 0; i < UdpSocket::kMostWaiting && bytes <= size_t{UdpSocket::kWaiting_bytes}; ++i) {
            const std::optional<UdpPacket> packet = socket_->receive();
            if (!packet) break;
            bytes += packet->bytes.size();
            take(*packet, now_s);
        }
        for (size_t i = 0; i < senders_.size(); ++i) end_poses(i, now_s);
        // Only now is known that a sender said nothing since the last call, however long ago that was.
        const size_t fell_silent =
            std::erase_if(senders_, [&](const Sender& sender) { return now_s - sender.heard_s > kSilence_s; });
        if (has_body_ && fell_silent > 0) {
            has_body_ = false;
            stream_.forget_sender();
        }
        return stream_.take(now_s);
    }
    PoseSourceState state() const override { return stream_.state(); }
    std::string name() const override { return name_; }
    std::string advice() const override { return advice_; }

  private:
    // A program: the address of its machine, whatever its port.
    struct Sender {
        std::array<uint8_t, 16> host{};
        std::unique_ptr<PacketReader> reader;
        double since_s = 0, heard_s = 0;
    };

    void take(const UdpPacket& packet, double now_s) {
        if (packet.cut) return stream_.leave_out("a packet has more than 16 KiB");
        const auto known = std::ranges::find(senders_, packet.sender.host, &Sender::host);
        const size_t index = static_cast<size_t>(known - senders_.begin());
        const bool is_new = known == senders_.end();
        if (is_new && (has_body_ || senders_.size() == kMostSenders))
            return stream_.leave_out("a packet came from a second sender while the first one was sending");
        if (is_new) senders_.push_back({packet.sender.host, make_reader_(name_), now_s, now_s});
        try {
            const bool is_pose = senders_[index].reader->read(packet.bytes, packet.sender.port, now_s, stream_);
            if (is_pose || !has_body_) senders_[index].heard_s = now_s;
            if (is_pose) follow(index);
        } catch (const InputError& error) {
            if (is_new) senders_.pop_back();
            stream_.leave_out(error.what());
        }
    }

    void end_poses(size_t index, double now_s) {
        if (index >= senders_.size()) return;
        try {
            if (!senders_[index].reader->end(now_s, stream_)) return;
            senders_[index].heard_s = now_s;
            follow(index);
        } catch (const InputError& error) {
            if (has_body_ || now_s - senders_[index].since_s >= kPatience_s) stream_.leave_out(error.what());
        }
    }

    // The sender whose packets have a body counts.
    void follow(size_t index) {
        if (has_body_) return;
        has_body_ = true;
        if (index > 0) std::swap(senders_[0], senders_[index]);
        senders_.resize(1);
    }

    std::unique_ptr<UdpSocket> socket_;
    MakeReader make_reader_;
    PoseStream stream_;
    std::string name_, advice_;
    std::vector<Sender> senders_;  // the one that is followed, or those that may be
    bool has_body_ = false;        // one is followed
};

template <typename Reader>
std::unique_ptr<PoseSource> listen(const char* kind, const char* advice, const std::string& host, uint16_t port,
                                   const std::string& address) {
    auto socket = std::make_unique<UdpSocket>(host, port, address);
    const std::string name = fmt::format("{} on {}", kind, socket->name());
    const auto make_reader = [](const std::string& stream) -> std::unique_ptr<PacketReader> {
        return std::make_unique<Reader>(stream);
    };
    const std::string text = fmt::format(fmt::runtime(advice), socket->name());
    return std::make_unique<PacketSource>(std::move(socket), make_reader, name, text);
}

}  // namespace

std::unique_ptr<PoseSource> listen_for_vmc(const std::string& host, uint16_t port, const std::string& address) {
    return listen<VmcReader>("VMC", "let a program send a whole body with the VMC protocol to {}", host, port, address);
}

std::unique_ptr<PoseSource> listen_for_json(const std::string& host, uint16_t port, const std::string& address) {
    return listen<JsonReader>("JSON", "send a pose of JSON in each packet to {}, as engine/motion/README.md says", host,
                              port, address);
}

}  // namespace neuvv::motion
