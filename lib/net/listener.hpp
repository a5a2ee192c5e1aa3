#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <system_error>

#include <asio/any_io_executor.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/steady_timer.hpp>

#include <busbar/core/log.hpp>
#include <busbar/core/result.hpp>

namespace busbar::net::detail {

/// A port that peers connect to. All calls on the executor.
class Listener : public std::enable_shared_from_this<Listener> {
public:
    using Handler = std::function<void(asio::ip::tcp::socket)>;

    Listener(const asio::any_io_executor& executor, LogSink& log)
        : acceptor_{executor}, pause_{executor}, log_{&log}
    {
    }

    /// Opens the port: "" means every address of the machine, IPv4 and IPv6; port 0 any free one.
    /// Returns the port, or Bad_CommunicationError with the reason in the log.
    [[nodiscard]] Result<std::uint16_t> open(std::string_view address, std::uint16_t port)
    {
        return reserve(address, port).and_then([this](std::uint16_t reserved) {
            return listen().transform([reserved] { return reserved; });
        });
    }
    /// The same, but peers are refused until listen().
    [[nodiscard]] Result<std::uint16_t> reserve(std::string_view address, std::uint16_t port);
    /// Does nothing if it listens already.
    [[nodiscard]] Result<void> listen();
    /// Calls `handler` for each peer until close().
    void start(Handler handler);
    void close();
    /// Accepts again if an exception has prevented it.
    void resume();

private:
    class Waiting;

    [[nodiscard]] std::error_code bind(std::string_view address, std::uint16_t port);
    void accept();
    void accepted(std::error_code error, asio::ip::tcp::socket socket);
    /// Tries again later, with growing delays, and logs it once, and once a minute if the trouble
    /// comes and goes.
    void back_off(std::error_code error);
    void tell(std::error_code error);
    [[nodiscard]] Unexpected<StatusCode> cannot_listen(std::error_code error) const;
    void recover();

    asio::ip::tcp::acceptor acceptor_;
    asio::steady_timer pause_;
    std::string place_; // for people
    bool is_listening_{false};
    std::error_code trouble_;
    std::chrono::milliseconds next_pause_{0};
    /// The time when trouble was last logged, and whether its end must still be logged.
    std::optional<std::chrono::steady_clock::time_point> told_at_;
    bool is_told_{false};
    /// It waits for a peer or for the end of a pause.
    bool is_waiting_{false};
    LogSink* log_;
    Handler handler_; // null once closed
};

} // namespace busbar::net::detail
