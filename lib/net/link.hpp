#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <utility>

#include <asio/ip/tcp.hpp>

#include <busbar/core/clock.hpp>
#include <busbar/core/result.hpp>

#include "clock.hpp"

namespace busbar::net::detail {

/// The common interface of engines. An engine that also has has_enough() is not fed while that is
/// true; its owner calls pump() when it is over. One with has_said_all() gets a half-close once
/// that is true, and is kept until the peer has closed too.
template <typename E>
concept Engine = requires(E& engine, std::span<const std::byte> in, TimePoint now, std::size_t n)
{
    {
        engine.feed(in, now)
        } -> std::same_as<Result<void>>;
    {
        engine.output()
        } -> std::convertible_to<std::span<const std::byte>>;
    engine.consume(n);
    {
        engine.next_deadline()
        } -> std::same_as<TimePoint>;
    engine.handle_deadline(now);
    {
        engine.is_closed()
        } -> std::same_as<bool>;
};

/// The bytes that a socket has just received. All links of a loop can share one: an engine keeps
/// none of its input.
using ReadBuffer = std::array<std::byte, 65'536>;

/// One TCP connection and its engine. Lives as long as its handlers do.
///
/// Reading stops while the peer does not take the output: a peer that sends requests and never
/// reads holds one response and the socket's buffers, not more. All calls are made on the loop's
/// thread.
template <Engine E>
class SocketLink : public std::enable_shared_from_this<SocketLink<E>> {
public:
    using Handler = std::function<void(SocketLink&)>;

    /// `on_change` is called after the engine was fed or its deadline handled, `on_end` once when
    /// the connection is closed.
    SocketLink(asio::ip::tcp::socket socket, E& engine, Handler on_change, Handler on_end,
               std::shared_ptr<ReadBuffer> buffer = std::make_shared_for_overwrite<ReadBuffer>())
        : socket_{std::move(socket)}, timer_{socket_.get_executor()}, engine_{&engine},
          on_change_{std::move(on_change)}, on_end_{std::move(on_end)}, buffer_{std::move(buffer)}
    {
    }

    void start()
    {
        std::error_code ignored;
        socket_.non_blocking(true, ignored);
        socket_.set_option(asio::ip::tcp::no_delay{true}, ignored);
        pump();
    }

    /// Sends the engine's output, and waits for the next occurrence.
    void pump()
    {
        if (has_ended_) {
            return;
        }
        if (!send()) {
            end();
            return;
        }
        if (engine_->is_closed() && engine_->output().empty()) {
            end();
            return;
        }
        close_half();
        wait_for_input();
        wait_for_deadline();
    }

    /// Drops the connection at once; on_end is called.
    void end()
    {
        if (std::exchange(has_ended_, true)) {
            return;
        }
        std::error_code ignored;
        timer_.cancel();
        socket_.shutdown(asio::ip::tcp::socket::shutdown_both, ignored);
        socket_.close(ignored);
        const Handler on_end = std::exchange(on_end_, nullptr);
        on_change_ = nullptr;
        on_end(*this);
    }

    [[nodiscard]] E& engine() { return *engine_; }

private:
    /// An exception of `work`, such as a failed allocation, ends this connection and is passed on
    /// to the code that runs the loop.
    template <typename Work>
    void guard(Work work)
    {
        try {
            work();
        } catch (...) {
            end();
            throw;
        }
    }

    /// Writes until all is sent or the socket takes no more. False if the connection is broken.
    bool send()
    {
        for (auto out = engine_->output(); !out.empty() && !is_writing_; out = engine_->output()) {
            std::error_code error;
            const std::size_t sent =
                socket_.write_some(asio::buffer(out.data(), out.size()), error);
            if (error == asio::error::would_block) {
                wait_for_room();
                return true;
            }
            if (error) {
                return false;
            }
            engine_->consume(sent);
        }
        return true;
    }

    void close_half()
    {
        if constexpr (requires { engine_->has_said_all(); }) {
            if (!is_half_closed_ && engine_->has_said_all()) {
                std::error_code ignored;
                is_half_closed_ = true;
                socket_.shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
            }
        }
    }

    void wait_for_room()
    {
        is_writing_ = true;
        socket_.async_wait(asio::ip::tcp::socket::wait_write,
                           [self = this->shared_from_this()](std::error_code error) {
                               self->is_writing_ = false;
                               self->guard([&] { error ? self->end() : self->pump(); });
                           });
    }

    void wait_for_input()
    {
        if (is_reading_ || is_writing_) {
            return;
        }
        if constexpr (requires { engine_->has_enough(); }) {
            if (engine_->has_enough()) {
                return;
            }
        }
        is_reading_ = true;
        socket_.async_wait(asio::ip::tcp::socket::wait_read,
                           [self = this->shared_from_this()](std::error_code error) {
                               self->is_reading_ = false;
                               self->guard([&] { error ? self->end() : self->receive(); });
                           });
    }

    void receive()
    {
        std::error_code error;
        const std::size_t size = socket_.read_some(asio::buffer(*buffer_), error);
        if (error == asio::error::would_block) {
            pump();
            return;
        }
        if (error) {
            end();
            return;
        }
        // A refused input leaves an Error message to send; is_closed() ends the link after it.
        static_cast<void>(engine_->feed(std::span{*buffer_}.first(size), now()));
        changed();
    }

    void wait_for_deadline()
    {
        timer_.await(engine_->next_deadline(), [self = this->shared_from_this()] {
            if (!self->has_ended_) {
                self->guard([&] {
                    self->engine_->handle_deadline(now());
                    self->changed();
                });
            }
        });
    }

    void changed()
    {
        if (on_change_) {
            on_change_(*this);
        }
        pump();
    }

    asio::ip::tcp::socket socket_;
    DeadlineTimer timer_;
    E* engine_;
    Handler on_change_;
    Handler on_end_;
    bool is_reading_{false};
    bool is_writing_{false};
    bool is_half_closed_{false};
    bool has_ended_{false};
    std::shared_ptr<ReadBuffer> buffer_;
};

} // namespace busbar::net::detail
