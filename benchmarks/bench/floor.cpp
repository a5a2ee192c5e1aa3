#include "floor.hpp"

#include <algorithm>
#include <array>
#include <thread>
#include <vector>

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <busbar/crypto/asymmetric.hpp>
#include <busbar/crypto/symmetric.hpp>
#include <busbar/types/secure_channel.hpp>

#include "identity.hpp"
#include "load.hpp"

namespace busbar::bench {

namespace {

constexpr int echoes = 51;

/// A connected pair of loopback TCP sockets.
struct Pair {
    Pair()
    {
        const int listener = ::socket(AF_INET, SOCK_STREAM, 0);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        auto* any = reinterpret_cast<sockaddr*>(&address);
        socklen_t size = sizeof address;
        ends[0] = ::socket(AF_INET, SOCK_STREAM, 0);
        const bool is_up = ::bind(listener, any, size) == 0 && ::listen(listener, 1) == 0 &&
                           ::getsockname(listener, any, &size) == 0 &&
                           ::connect(ends[0], any, size) == 0;
        ends[1] = is_up ? ::accept(listener, nullptr, nullptr) : -1;
        ::close(listener);
        const int on = 1;
        for (const int end : ends) {
            ::setsockopt(end, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
        }
    }
    Pair(const Pair&) = delete;
    Pair& operator=(const Pair&) = delete;
    ~Pair()
    {
        ::close(ends[0]);
        ::close(ends[1]);
    }

    std::array<int, 2> ends{-1, -1};
};

bool send_all(int socket, std::vector<std::byte>& bytes, std::size_t size)
{
    std::size_t sent = 0;
    while (sent < size) {
        const auto n = ::send(socket, bytes.data() + sent, size - sent, MSG_NOSIGNAL);
        if (n <= 0) {
            return false;
        }
        sent += static_cast<std::size_t>(n);
    }
    return true;
}

bool receive_all(int socket, std::vector<std::byte>& bytes, std::size_t size)
{
    std::size_t received = 0;
    while (received < size) {
        const auto n = ::recv(socket, bytes.data() + received, size - received, 0);
        if (n <= 0) {
            return false;
        }
        received += static_cast<std::size_t>(n);
    }
    return true;
}

double middle_of(std::vector<double> times)
{
    std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2),
                     times.end());
    return times[times.size() / 2];
}

double thread_us()
{
    timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) * 1e6 + static_cast<double>(time.tv_nsec) / 1e3;
}

Floor echo(std::size_t request, std::size_t response)
{
    Pair pair;
    double peer_us = 0;
    std::thread peer{[&] {
        std::vector<std::byte> bytes(std::max(request, response));
        const double begin = thread_us();
        while (receive_all(pair.ends[1], bytes, request) &&
               send_all(pair.ends[1], bytes, response)) {
        }
        peer_us = thread_us() - begin;
    }};
    std::vector<std::byte> bytes(std::max(request, response));
    std::vector<double> times;
    for (int i = 0; i < echoes; ++i) {
        const TimePoint start = clock_now();
        if (!send_all(pair.ends[0], bytes, request) ||
            !receive_all(pair.ends[0], bytes, response)) {
            break;
        }
        times.push_back(elapsed_us(start));
    }
    ::shutdown(pair.ends[0], SHUT_RDWR);
    peer.join();
    return times.empty() ? Floor{} : Floor{middle_of(times), peer_us / echoes};
}

/// The median of what `work` takes.
template <typename Work>
double time_us(Work work)
{
    std::vector<double> times;
    for (int i = 0; i < echoes; ++i) {
        const TimePoint start = clock_now();
        work();
        times.push_back(elapsed_us(start));
    }
    return middle_of(std::move(times));
}

/// What the sender of so many bytes takes to sign and encrypt them, and the receiver for the
/// reverse.
struct CipherTime {
    double sender_us{0};
    double receiver_us{0};
};

CipherTime cipher_time(std::size_t size, const channel::SecuritySetting& security)
{
    if (security.mode == MessageSecurityMode::None) {
        return {};
    }
    const std::array<std::byte, 32> nonce{};
    const auto keys = crypto::derive_keys(*security.policy, nonce, nonce);
    auto cipher = crypto::SymmetricCipher::create(*security.policy, *keys);
    std::vector<std::byte> bytes((size + 15) / 16 * 16);
    std::array<std::byte, 32> signature{};
    const double sign = time_us([&] { static_cast<void>(cipher->sign(bytes, signature)); });
    if (security.mode == MessageSecurityMode::Sign) {
        return {sign, sign};
    }
    return {sign + time_us([&] { static_cast<void>(cipher->encrypt(bytes)); }),
            sign + time_us([&] { static_cast<void>(cipher->decrypt(bytes)); })};
}

/// How often the text of an OpenSecureChannel is encrypted: a block each time. It has a header of
/// the sequence, a request or response with its nonce, padding and a signature.
std::size_t open_blocks(const crypto::SecurityPolicy& policy, std::size_t key_size)
{
    OpenSecureChannelRequest request;
    const std::vector<std::byte> nonce(policy.nonce_size);
    request.client_nonce = ByteString{nonce};
    const auto body = binary::to_bytes(request);
    const std::size_t text = 8 + (body ? body->size() : 0) + 1 + key_size;
    const std::size_t block = crypto::plain_block_size(policy, key_size);
    return block == 0 ? 0 : (text + block - 1) / block;
}

} // namespace

Floor exchange_floor(std::size_t request, std::size_t response,
                     const channel::SecuritySetting& security)
{
    Floor floor = echo(request, response);
    const CipherTime there = cipher_time(request, security);
    const CipherTime back = cipher_time(response, security);
    floor.server_us += there.receiver_us + back.sender_us;
    floor.both_us += there.sender_us + there.receiver_us + back.sender_us + back.receiver_us;
    return floor;
}

Floor connect_floor(const channel::SecuritySetting& security, std::uint32_t key_bits, DateTime now)
{
    if (security.mode == MessageSecurityMode::None) {
        return {};
    }
    const auto identity = make_identity(now, key_bits);
    if (!identity) {
        return {};
    }
    const crypto::SecurityPolicy& policy = *security.policy;
    const crypto::Certificate& certificate = identity->certificates.front();
    const std::vector<std::byte> text(crypto::plain_block_size(policy, certificate.key_size()));
    const auto cipher = crypto::asymmetric_encrypt(policy, certificate, text);
    const auto signature = crypto::asymmetric_sign(policy, identity->key, text);
    if (!cipher || !signature) {
        return {};
    }
    const double sign =
        time_us([&] { static_cast<void>(crypto::asymmetric_sign(policy, identity->key, text)); });
    const double verify = time_us([&] {
        static_cast<void>(crypto::asymmetric_verify(policy, certificate, text, *signature));
    });
    const double encrypt =
        time_us([&] { static_cast<void>(crypto::asymmetric_encrypt(policy, certificate, text)); });
    const double decrypt = time_us(
        [&] { static_cast<void>(crypto::asymmetric_decrypt(policy, identity->key, *cipher)); });
    const auto blocks = static_cast<double>(open_blocks(policy, certificate.key_size()));
    // Each side signs and verifies one OpenSecureChannel, encrypts one and decrypts the other; the
    // server signs the client's nonce and the client the server's.
    const double one = 2 * sign + 2 * verify + blocks * (encrypt + decrypt);
    return {2 * one, one};
}

} // namespace busbar::bench
