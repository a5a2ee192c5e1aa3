#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <asio/ip/tcp.hpp>
#include <asio/ip/udp.hpp>
#include <asio/steady_timer.hpp>
#include <asio/write.hpp>

#include "plc.hpp"

namespace plc_responder {

inline busbar::TimePoint now()
{
    return std::chrono::time_point_cast<busbar::Duration>(std::chrono::steady_clock::now());
}

/// A TCP connection. While its client takes no answers, it takes no requests.
class Session : public std::enable_shared_from_this<Session> {
public:
    Session(asio::ip::tcp::socket socket, std::unique_ptr<Connection> connection)
        : socket_{std::move(socket)}, timer_{socket_.get_executor()}, connection_{
                                                                          std::move(connection)}
    {
    }

    void advance()
    {
        connection_->handle_deadline(now());
        if (is_writing_ || !socket_.is_open()) {
            return;
        }
        if (!connection_->output().empty()) {
            write();
        } else if (connection_->is_closed()) {
            close();
        } else {
            wait();
            read();
        }
    }
    void close()
    {
        asio::error_code ignored;
        socket_.close(ignored);
        timer_.cancel();
    }
    [[nodiscard]] bool is_open() const { return socket_.is_open(); }
    [[nodiscard]] Connection& connection() { return *connection_; }

private:
    void read()
    {
        if (std::exchange(is_reading_, true)) {
            return;
        }
        socket_.async_read_some(
            asio::buffer(input_),
            [self = shared_from_this()](const asio::error_code& error, std::size_t size) {
                self->is_reading_ = false;
                if (error) {
                    self->close();
                    return;
                }
                self->connection_->feed(std::span{self->input_}.first(size), now());
                self->advance();
            });
    }
    void write()
    {
        output_.clear();
        while (!connection_->output().empty()) {
            const auto part = connection_->output();
            output_.insert(output_.end(), part.begin(), part.end());
            connection_->consume(part.size());
        }
        is_writing_ = true;
        asio::async_write(socket_, asio::buffer(output_),
                          [self = shared_from_this()](const asio::error_code& error, std::size_t) {
                              self->is_writing_ = false;
                              if (error) {
                                  self->close();
                              }
                              self->advance();
                          });
    }
    void wait()
    {
        timer_.expires_at(connection_->next_deadline());
        timer_.async_wait([self = shared_from_this()](const asio::error_code& error) {
            if (!error) {
                self->advance();
            }
        });
    }

    asio::ip::tcp::socket socket_;
    asio::steady_timer timer_;
    std::unique_ptr<Connection> connection_;
    std::array<std::byte, 16'384> input_{};
    std::vector<std::byte> output_{};
    bool is_reading_{false};
    bool is_writing_{false};
};

/// A UDP port. Each peer has a connection, and each datagram is a frame.
class DatagramPort {
public:
    DatagramPort(asio::ip::udp::socket socket, Plc& plc)
        : socket_{std::move(socket)}, timer_{socket_.get_executor()}, plc_{plc}
    {
        read();
    }

    void close() { peers_.clear(); }
    void set_latency(busbar::Duration latency) { plc_.set_latency(latency); }

private:
    static constexpr std::size_t max_peers = 64;

    void read()
    {
        socket_.async_receive_from(
            asio::buffer(input_), peer_, [this](const asio::error_code& error, std::size_t size) {
                if (error == asio::error::operation_aborted) {
                    return;
                }
                if (!error) {
                    if (peers_.size() >= max_peers && !peers_.contains(peer_)) {
                        peers_.clear();
                    }
                    auto& connection = peers_[peer_];
                    if (!connection || connection->is_closed()) {
                        connection = plc_.connect();
                    }
                    connection->feed(std::span{input_}.first(size), now());
                }
                advance();
                read();
            });
    }
    void advance()
    {
        busbar::TimePoint next = busbar::no_deadline;
        for (auto& [peer, connection] : peers_) {
            connection->handle_deadline(now());
            while (!connection->output().empty()) {
                const auto frame = connection->output();
                asio::error_code ignored; // a datagram may be lost
                socket_.send_to(asio::buffer(frame.data(), frame.size()), peer, 0, ignored);
                connection->consume(frame.size());
            }
            next = std::min(next, connection->next_deadline());
        }
        timer_.expires_at(next);
        timer_.async_wait([this](const asio::error_code& error) {
            if (!error) {
                advance();
            }
        });
    }

    asio::ip::udp::socket socket_;
    asio::steady_timer timer_;
    Plc& plc_;
    std::map<asio::ip::udp::endpoint, std::unique_ptr<Connection>> peers_{};
    asio::ip::udp::endpoint peer_{};
    std::array<std::byte, 16'384> input_{};
};

} // namespace plc_responder
