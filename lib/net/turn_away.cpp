#include "turn_away.hpp"

#include <array>
#include <chrono>
#include <utility>

#include <asio/buffer.hpp>
#include <asio/steady_timer.hpp>
#include <asio/write.hpp>

#include "channel/frame.hpp"
#include "channel/output_buffer.hpp"

namespace busbar::net::detail {

namespace {

using asio::ip::tcp;

constexpr std::chrono::seconds longest_wait{1};
/// Maximum input of a peer meanwhile: a Hello and little more.
constexpr std::size_t most_read = 65'536;

/// One peer that is being refused. Closing at once would reset the connection if the peer has sent
/// anything, and the message would be lost.
class Farewell : public std::enable_shared_from_this<Farewell> {
public:
    Farewell(tcp::socket socket, std::shared_ptr<std::size_t> places)
        : socket_{std::move(socket)}, timer_{socket_.get_executor()}, places_{std::move(places)}
    {
        --*places_;
    }
    Farewell(const Farewell&) = delete;
    Farewell& operator=(const Farewell&) = delete;
    ~Farewell() { ++*places_; }

    void start(StatusCode error, std::string_view reason)
    {
        channel::detail::write_error(message_, error, reason);
        timer_.expires_after(longest_wait);
        timer_.async_wait([self = shared_from_this()](std::error_code) { self->close(); });
        const auto bytes = message_.output();
        asio::async_write(socket_, asio::buffer(bytes.data(), bytes.size()),
                          [self = shared_from_this()](std::error_code failed, std::size_t) {
                              self->sent(failed);
                          });
    }

private:
    void sent(std::error_code failed)
    {
        std::error_code ignored;
        socket_.shutdown(tcp::socket::shutdown_send, ignored);
        failed ? close() : read();
    }
    void read()
    {
        socket_.async_read_some(asio::buffer(input_),
                                [self = shared_from_this()](std::error_code end, std::size_t size) {
                                    self->read_ += size;
                                    end || self->read_ > most_read ? self->close() : self->read();
                                });
    }
    void close()
    {
        std::error_code ignored;
        socket_.close(ignored);
        timer_.cancel();
    }

    tcp::socket socket_;
    asio::steady_timer timer_;
    std::shared_ptr<std::size_t> places_;
    channel::detail::OutputBuffer message_;
    std::array<char, 1'024> input_{};
    std::size_t read_{0};
};

} // namespace

void TurnAway::operator()(tcp::socket socket, StatusCode error, std::string_view reason)
{
    if (*places_ != 0) {
        std::make_shared<Farewell>(std::move(socket), places_)->start(error, reason);
    }
}

} // namespace busbar::net::detail
