#include "motion/packet_source.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/udp_socket.h"
#include "motion/pose_stream.h"
#include "motion/vmc.h"

namespace neuvv::motion {

namespace {

constexpr double kSilence_s = 2;  // after which another sender may go on

class PacketReader {
  public:
    virtual ~PacketReader() = default;
    // Takes a packet. Returns whether it belongs to a motion. Throws InputError where it is malformed.
    virtual bool read(std::span<const uint8_t> packet, double now_s, PoseStream& stream) = 0;
    // No more packets wait. Throws InputError where what came is no pose.
    virtual void end(double now_s, PoseStream& stream) = 0;
    // The next packets are of another sender.
    virtual void forget_sender() = 0;
};

class VmcReader : public PacketReader {
  public:
    explicit VmcReader(std::string name) : name_(std::move(name)) {}
    bool read(std::span<const uint8_t> packet, double, PoseStream&) override { return body_.read(packet, name_); }
    void end(double now_s, PoseStream& stream) override {
        if (const auto poses = body_.take(name_)) stream.add_untimed(poses->newest, now_s, poses->count);
    }
    void forget_sender() override { body_ = {}; }

  private:
    std::string name_;
    VmcBody body_;
};

class JsonReader : public PacketReader {
  public:
    explicit JsonReader(std::string name) : name_(std::move(name)) {}
    bool read(std::span<const uint8_t> packet, double now_s, PoseStream& stream) override {
        stream.add(read_pose_line({packet.begin(), packet.end()}, name_), now_s);
        return true;
    }
    void end(double, PoseStream&) override {}
    void forget_sender() override {}

  private:
    std::string name_;
};

class PacketSource : public PoseSource {
  public:
    PacketSource(std::unique_ptr<UdpSocket> socket, std::unique_ptr<PacketReader> reader, std::string name)
        : socket_(std::move(socket)), reader_(std::move(reader)), name_(std::move(name)) {}

    std::optional<TimedPose> newest(double now_s) override {
        // Everything that waits, and not much more where packets come faster than they are read.
        size_t bytes = 0;
        for (size_t i = 0; i < UdpSocket::kMostWaiting && bytes <= size_t{UdpSocket::kWaiting_bytes}; ++i) {
            const std::optional<UdpPacket> packet = socket_->receive();
            if (!packet) break;
            bytes += packet->bytes.size();
            try_reading([&] { take(*packet, now_s); });
        }
        try_reading([&] { reader_->end(now_s, stream_); });
        // Only now is known that the sender said nothing since the last call, however long ago that was.
        if (sender_ && now_s - heard_s_ > kSilence_s) {
            sender_.reset();
            reader_->forget_sender();
            stream_.forget_sender();
        }
        return stream_.take(now_s);
    }
    PoseSourceState state() const override { return stream_.state(); }
    std::string name() const override { return name_; }

  private:
    void take(const UdpPacket& packet, double now_s) {
        if (sender_ && packet.sender != *sender_)
            return stream_.leave_out("a packet came from a second sender while the first one was sending");
        if (packet.cut) return stream_.leave_out("a packet has more than 16 KiB");
        if (!reader_->read(packet.bytes, now_s, stream_)) return;
        sender_ = packet.sender;
        heard_s_ = now_s;
    }

    template <typename Call>
    void try_reading(Call&& call) {
        try {
            call();
        } catch (const InputError& error) {
            stream_.leave_out(error.what());
        }
    }

    std::unique_ptr<UdpSocket> socket_;
    std::unique_ptr<PacketReader> reader_;
    PoseStream stream_;
    std::string name_;
    std::optional<UdpSender> sender_;
    double heard_s_ = 0;
};

template <typename Reader>
std::unique_ptr<PoseSource> listen(const char* kind, const std::string& host, uint16_t port,
                                   const std::string& address) {
    auto socket = std::make_unique<UdpSocket>(host, port, address);
    const std::string name = fmt::format("{} on {}", kind, socket->name());
    return std::make_unique<PacketSource>(std::move(socket), std::make_unique<Reader>(name), name);
}

}  // namespace

std::unique_ptr<PoseSource> listen_for_vmc(const std::string& host, uint16_t port, const std::string& address) {
    return listen<VmcReader>("VMC", host, port, address);
}

std::unique_ptr<PoseSource> listen_for_json(const std::string& host, uint16_t port, const std::string& address) {
    return listen<JsonReader>("JSON", host, port, address);
}

}  // namespace neuvv::motion
