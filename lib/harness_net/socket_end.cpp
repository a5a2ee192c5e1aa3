#include "socket_end.hpp"

#include <utility>

#include <asio/connect.hpp>
#include <asio/write.hpp>

namespace busbar::harness::detail {

void SocketEnd::begin(std::shared_ptr<Link> link)
{
    link_ = std::move(link);
    is_connected_ = true;
    asio::error_code ignored;
    socket_.set_option(asio::ip::tcp::no_delay{true}, ignored);
    constexpr std::size_t read_size = 64U << 10U;
    incoming_.resize(read_size);
    read();
    write();
}

void SocketEnd::begin(std::shared_ptr<Link> link,
                      const asio::ip::tcp::resolver::results_type& addresses,
                      std::function<void(const std::string& why)> failed)
{
    link_ = std::move(link);
    asio::async_connect(socket_, addresses,
                        [self = shared_from_this(),
                         failed = std::move(failed)](asio::error_code error, const auto&) {
                            if (self->link_ == nullptr) {
                                return;
                            }
                            if (error) {
                                failed(error.message());
                                self->socket_lost(false);
                            } else {
                                self->begin(self->link_);
                            }
                        });
}

void SocketEnd::read()
{
    socket_.async_read_some(asio::buffer(incoming_), [self = shared_from_this()](
                                                         asio::error_code error, std::size_t size) {
        if (error) {
            self->socket_lost(error == asio::error::eof);
            return;
        }
        if (self->link_ == nullptr) {
            return;
        }
        const auto end = self->incoming_.begin() + static_cast<std::ptrdiff_t>(size);
        self->received_.insert(self->received_.end(), self->incoming_.begin(), end);
        self->link_->flush(self->side_);
        self->read();
    });
}

void SocketEnd::consume(std::size_t size)
{
    received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(size));
}

void SocketEnd::feed(std::span<const std::byte> in)
{
    if (unsent_.size() + in.size() > max_unsent) {
        socket_lost(false);
        return;
    }
    unsent_.insert(unsent_.end(), in.begin(), in.end());
    write();
}

void SocketEnd::write()
{
    if (!is_connected_ || !writing_.empty()) {
        return;
    }
    if (unsent_.empty()) {
        if (is_ending_) {
            close_socket(false);
        }
        return;
    }
    writing_ = std::exchange(unsent_, {});
    asio::async_write(socket_, asio::buffer(writing_),
                      [self = shared_from_this()](asio::error_code error, std::size_t) {
                          self->writing_.clear();
                          if (error) {
                              self->socket_lost(false);
                          } else {
                              self->write();
                          }
                      });
}

void SocketEnd::link_lost()
{
    const auto link = std::exchange(link_, nullptr);
    if (link == nullptr) {
        return;
    }
    if (link->is_cut() || !is_connected_) {
        close_socket(true);
        return;
    }
    is_ending_ = true;
    write();
}

void SocketEnd::socket_lost(bool is_proper)
{
    close_socket(false);
    if (const auto link = std::exchange(link_, nullptr)) {
        if (is_proper) {
            link->close(side_);
        } else {
            link->leave(side_);
        }
    }
}

void SocketEnd::close_socket(bool is_reset)
{
    asio::error_code ignored;
    if (is_reset) {
        socket_.set_option(asio::socket_base::linger{true, 0}, ignored);
    }
    socket_.close(ignored);
}

void SocketEnd::stop()
{
    socket_lost(false);
}

} // namespace busbar::harness::detail
