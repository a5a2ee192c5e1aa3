#pragma once

#include <atomic>

#include <asio/buffer.hpp>
#include <asio/io_context.hpp>
#include <asio/posix/stream_descriptor.hpp>
#include <fcntl.h>
#include <unistd.h>

#include <busbar/server/waker.hpp>

namespace busbar::net::detail {

/// A pipe to the same process: writing one byte neither blocks nor allocates.
class PipeWaker final : public server::Waker {
public:
    explicit PipeWaker(asio::io_context& context) : reader_{context}
    {
        int ends[2] = {-1, -1};
        if (::pipe2(ends, O_NONBLOCK | O_CLOEXEC) == 0) {
            reader_.assign(ends[0]);
            writer_ = ends[1];
        }
    }
    ~PipeWaker() override
    {
        if (writer_ >= 0) {
            ::close(writer_);
        }
    }
    void wake() override
    {
        if (!is_awake_.exchange(true)) {
            const char byte = 0;
            static_cast<void>(!::write(writer_, &byte, 1));
        }
    }
    /// Calls `on_wake` on the loop's thread each time. Does nothing if it is waiting already.
    template <typename OnWake>
    void wait(OnWake on_wake)
    {
        if (is_waiting_) {
            return;
        }
        reader_.async_read_some(asio::buffer(buffer_),
                                [this, on_wake](std::error_code error, std::size_t) {
                                    is_waiting_ = false;
                                    if (!error) {
                                        is_awake_ = false;
                                        wait(on_wake);
                                        on_wake();
                                    }
                                });
        is_waiting_ = true;
    }

private:
    asio::posix::stream_descriptor reader_;
    int writer_{-1};
    std::atomic<bool> is_awake_{false};
    bool is_waiting_{false};
    char buffer_[64]{};
};

} // namespace busbar::net::detail
