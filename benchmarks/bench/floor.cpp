#include "floor.hpp"

#include <algorithm>
#include <array>
#include <thread>
#include <vector>

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <busbar/crypto/symmetric.hpp>

#include "load.hpp"

namespace busbar::bench {

namespace {

constexpr int rounds = 51;

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

double median(std::vector<double> times)
{
    std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2),
                     times.end());
    return times[times.size() / 2];
}

double echo_us(std::size_t request, std::size_t response)
{
    Pair pair;
    std::thread peer{[&] {
        std::vector<std::byte> bytes(std::max(request, response));
        while (receive_all(pair.ends[1], bytes, request) &&
               send_all(pair.ends[1], bytes, response)) {
        }
    }};
    std::vector<std::byte> bytes(std::max(request, response));
    std::vector<double> times;
    for (int i = 0; i < rounds; ++i) {
        const TimePoint start = clock_now();
        if (!send_all(pair.ends[0], bytes, request) ||
            !receive_all(pair.ends[0], bytes, response)) {
            break;
        }
        times.push_back(elapsed_us(start));
    }
    ::shutdown(pair.ends[0], SHUT_RDWR);
    peer.join();
    return times.empty() ? 0 : median(times);
}

/// Both sides: what one signs and encrypts the other decrypts and verifies.
double cipher_us(std::size_t size, const channel::SecuritySetting& security)
{
    if (security.mode == MessageSecurityMode::None) {
        return 0;
    }
    const std::array<std::byte, 32> nonce{};
    const auto keys = crypto::derive_keys(*security.policy, nonce, nonce);
    auto cipher = crypto::SymmetricCipher::create(*security.policy, *keys);
    std::vector<std::byte> bytes((size + 15) / 16 * 16);
    std::array<std::byte, 32> signature{};
    const bool is_encrypted = security.mode == MessageSecurityMode::SignAndEncrypt;
    std::vector<double> times;
    for (int i = 0; i < rounds; ++i) {
        const TimePoint start = clock_now();
        for (int side = 0; side < 2; ++side) {
            static_cast<void>(cipher->sign(bytes, signature));
            if (is_encrypted) {
                static_cast<void>(side == 0 ? cipher->encrypt(bytes) : cipher->decrypt(bytes));
            }
        }
        times.push_back(elapsed_us(start));
    }
    return median(times);
}

} // namespace

double floor_us(std::size_t request, std::size_t response, const channel::SecuritySetting& security)
{
    return echo_us(request, response) + cipher_us(request, security) +
           cipher_us(response, security);
}

} // namespace busbar::bench
