#include <algorithm>
#include <array>
#include <initializer_list>
#include <map>
#include <string_view>

#include <busbar/binary/writer.hpp>
#include <busbar/harness/recording.hpp>

namespace busbar::harness {

namespace {

constexpr std::size_t ethernet_size = 14;
constexpr std::size_t ip_size = 20;
constexpr std::size_t tcp_size = 20;
constexpr std::size_t max_segment_size = 1'460;
constexpr std::uint32_t max_packet_size = 65'535;
constexpr std::uint16_t first_client_port = 49'152;

// TCP flags (RFC 9293, 3.1).
constexpr std::uint8_t fin = 1;
constexpr std::uint8_t syn = 2;
constexpr std::uint8_t push = 8;
constexpr std::uint8_t ack = 16;

constexpr std::array<std::byte, 3> no_bytes{};

constexpr std::uint32_t client_address = 0xC000'0201; // 192.0.2.1, RFC 5737
constexpr std::uint32_t server_address = 0xC000'0202;

/// A packet's bytes in network order.
class Packet {
public:
    void put8(std::uint8_t value) { bytes_.push_back(static_cast<std::byte>(value)); }
    void put16(std::uint32_t value)
    {
        put8(static_cast<std::uint8_t>(value >> 8U));
        put8(static_cast<std::uint8_t>(value));
    }
    void put32(std::uint32_t value)
    {
        put16(value >> 16U);
        put16(value & 0xFFFFU);
    }
    void put(std::span<const std::byte> bytes)
    {
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    }
    /// Writes the Internet checksum (RFC 1071) of all from `begin` on, and of `more`, at `offset`.
    void seal(std::size_t begin, std::size_t size, std::size_t offset, std::uint32_t more)
    {
        std::uint32_t sum = more;
        for (std::size_t i = begin; i < begin + size; ++i) {
            const auto byte = std::to_integer<std::uint32_t>(bytes_[i]);
            sum += (i - begin) % 2 == 0 ? byte << 8U : byte;
            sum = (sum & 0xFFFFU) + (sum >> 16U);
        }
        sum = ~((sum & 0xFFFFU) + (sum >> 16U));
        bytes_[offset] = static_cast<std::byte>(sum >> 8U);
        bytes_[offset + 1] = static_cast<std::byte>(sum);
    }
    [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }

private:
    std::vector<std::byte> bytes_;
};

constexpr std::uint32_t words(std::uint32_t address)
{
    return (address >> 16U) + (address & 0xFFFFU);
}

/// Turns the entries of one recording into packets.
class Capture {
public:
    enum class Format : std::uint8_t { Pcap, Pcapng };

    Capture(std::uint16_t port, Format format, std::string_view secrets = {})
        : port_{port}, format_{format}
    {
        if (format == Format::Pcapng) {
            begin_section(secrets);
            return;
        }
        writer_.number(std::uint32_t{0xA1B2'C3D4});
        for (const std::uint16_t part : {std::uint16_t{2}, std::uint16_t{4}}) {
            writer_.number(part);
        }
        for (const std::uint32_t part : {0U, 0U, max_packet_size, 1U}) { // 1: Ethernet
            writer_.number(part);
        }
    }

    void add(const Recording::Entry& entry)
    {
        Flow& flow = flows_[entry.connection];
        time_ = entry.time;
        switch (entry.kind) {
        case Recording::Kind::Opened:
            flow.client_port =
                static_cast<std::uint16_t>(first_client_port + entry.connection % 16'000);
            packet(flow, Side::Client, syn, {});
            packet(flow, Side::Server, syn | ack, {});
            packet(flow, Side::Client, ack, {});
            break;
        case Recording::Kind::Bytes:
            add_bytes(flow, entry);
            break;
        case Recording::Kind::Ended:
            packet(flow, entry.from, fin | ack, {});
            break;
        }
    }
    [[nodiscard]] std::vector<std::byte> take() { return sink_.take(writer_.written()); }

private:
    struct Flow {
        std::uint16_t client_port{0};
        /// The next sequence number, by Side. Different first numbers make mistakes visible.
        std::array<std::uint32_t, 2> next{1'000, 5'000};
    };

    void add_bytes(Flow& flow, const Recording::Entry& entry)
    {
        std::span<const std::byte> rest{entry.bytes};
        while (!rest.empty()) {
            const auto segment = rest.first(std::min(rest.size(), max_segment_size));
            rest = rest.subspan(segment.size());
            packet(flow, entry.from, push | ack, segment);
        }
    }
    void packet(Flow& flow, Side from, std::uint8_t flags, std::span<const std::byte> data)
    {
        Packet packet;
        const std::uint8_t last = from == Side::Client ? 1 : 2;
        for (const std::uint8_t station : {std::uint8_t(3 - last), last}) { // to, from
            packet.put32(0x0200'0000U);                                     // locally administered
            packet.put16(station);
        }
        packet.put16(0x0800); // IPv4
        put_ip(packet, from, tcp_size + data.size());
        put_tcp(packet, flow, from, flags);
        packet.put(data);
        const std::size_t size = tcp_size + data.size();
        const std::size_t begin = ethernet_size + ip_size;
        // The pseudo header: addresses, protocol, length.
        packet.seal(begin, size, begin + 16,
                    words(client_address) + words(server_address) + 6 +
                        static_cast<std::uint32_t>(size));
        flow.next[static_cast<std::size_t>(from)] +=
            static_cast<std::uint32_t>(data.size()) + ((flags & (syn | fin)) != 0 ? 1U : 0U);
        write(packet);
    }
    void put_ip(Packet& packet, Side from, std::size_t payload)
    {
        packet.put16(0x4500); // version 4, five words, no service
        packet.put16(static_cast<std::uint32_t>(ip_size + payload));
        packet.put16(++last_packet_ & 0xFFFFU);
        packet.put16(0x4000);         // do not fragment
        packet.put16(64U << 8U | 6U); // time to live, TCP
        packet.put16(0);
        packet.put32(from == Side::Client ? client_address : server_address);
        packet.put32(from == Side::Client ? server_address : client_address);
        packet.seal(ethernet_size, ip_size, ethernet_size + 10, 0);
    }
    void put_tcp(Packet& packet, const Flow& flow, Side from, std::uint8_t flags)
    {
        packet.put16(from == Side::Client ? flow.client_port : port_);
        packet.put16(from == Side::Client ? port_ : flow.client_port);
        packet.put32(flow.next[static_cast<std::size_t>(from)]);
        packet.put32((flags & ack) != 0 ? flow.next[static_cast<std::size_t>(other(from))] : 0);
        packet.put8(5U << 4U); // five words
        packet.put8(flags);
        packet.put16(0xFFFF); // window
        packet.put32(0);      // checksum and urgent pointer
    }
    /// A block of pcapng: its type and size, and the size again after its content, which is filled
    /// up to whole words.
    void block(std::uint32_t type, std::initializer_list<std::uint32_t> words,
               std::span<const std::byte> data = {})
    {
        constexpr std::size_t frame_size = 12;
        const std::size_t padding = (4 - data.size() % 4) % 4;
        const auto size =
            static_cast<std::uint32_t>(frame_size + 4 * words.size() + data.size() + padding);
        writer_.number(type);
        writer_.number(size);
        for (const std::uint32_t word : words) {
            writer_.number(word);
        }
        writer_.bytes(data);
        writer_.bytes(std::span<const std::byte>{no_bytes}.first(padding));
        writer_.number(size);
    }
    void begin_section(std::string_view secrets)
    {
        // Magic number of the byte order, version 1.0, a section of unknown size.
        block(0x0A0D'0D0A, {0x1A2B'3C4D, 1, UINT32_MAX, UINT32_MAX});
        block(1, {1, max_packet_size}); // an interface: Ethernet, times in microseconds
        if (!secrets.empty()) {
            constexpr std::uint32_t opcua_key_log = 0x5541'4B4C;
            block(0xA, {opcua_key_log, static_cast<std::uint32_t>(secrets.size())},
                  std::as_bytes(std::span{secrets}));
        }
    }
    void write(const Packet& packet)
    {
        const auto microseconds =
            std::chrono::duration_cast<std::chrono::microseconds>(time_).count();
        if (format_ == Format::Pcapng) {
            const auto size = static_cast<std::uint32_t>(packet.bytes().size());
            const auto time = static_cast<std::uint64_t>(microseconds);
            constexpr std::uint32_t interface = 0;
            block(6,
                  {interface, static_cast<std::uint32_t>(time >> 32U),
                   static_cast<std::uint32_t>(time), size, size},
                  packet.bytes());
            return;
        }
        writer_.number(static_cast<std::uint32_t>(microseconds / 1'000'000));
        writer_.number(static_cast<std::uint32_t>(microseconds % 1'000'000));
        writer_.number(static_cast<std::uint32_t>(packet.bytes().size()));
        writer_.number(static_cast<std::uint32_t>(packet.bytes().size()));
        writer_.bytes(packet.bytes());
    }

    std::uint16_t port_;
    Format format_;
    binary::VectorSink sink_;
    binary::Writer writer_{sink_};
    std::map<std::uint32_t, Flow> flows_;
    Duration time_{0};
    std::uint32_t last_packet_{0};
};

std::vector<std::byte> captured(const Recording& recording, Capture& capture)
{
    for (const Recording::Entry& entry : recording.entries) {
        capture.add(entry);
    }
    return capture.take();
}

} // namespace

std::vector<std::byte> to_pcap(const Recording& recording, std::uint16_t port)
{
    Capture capture{port, Capture::Format::Pcap};
    return captured(recording, capture);
}

std::vector<std::byte> to_pcapng(const Recording& recording, std::string_view key_log,
                                 std::uint16_t port)
{
    Capture capture{port, Capture::Format::Pcapng, key_log};
    return captured(recording, capture);
}

} // namespace busbar::harness
