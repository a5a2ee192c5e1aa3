#include "device_link.hpp"

#include <utility>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::net::detail {

using asio::ip::udp;

namespace {

/// The largest datagram.
constexpr std::size_t datagram_size = 65'536;
constexpr const char* lost_connection = "it closed the connection, or the network lost it";

} // namespace

DatagramLink::DatagramLink(const asio::any_io_executor& executor, backend::Device& device,
                           std::function<void(const std::string&)> on_end)
    : socket_{executor}, timer_{executor}, device_{&device}, on_end_{std::move(on_end)},
      buffer_(datagram_size)
{
}

std::error_code DatagramLink::open(const udp::endpoint& peer)
{
    std::error_code error;
    socket_.open(peer.protocol(), error);
    if (!error) {
        socket_.non_blocking(true, error);
    }
    if (!error) {
        socket_.connect(peer, error);
    }
    return error;
}

void DatagramLink::pump()
{
    while (on_end_ && !device_->output().empty()) {
        const auto out = device_->output();
        std::error_code error;
        socket_.send(asio::buffer(out.data(), out.size()), 0, error);
        if (error && error != asio::error::would_block && error != asio::error::no_buffer_space) {
            end(error.message());
            return;
        }
        device_->consume(out.size()); // a datagram that has no room is lost, like any other
    }
    if (!on_end_) {
        return;
    }
    if (device_->is_closed()) {
        end({});
        return;
    }
    timer_.await(device_->next_deadline(), [self = shared_from_this()] {
        if (self->on_end_) {
            self->device_->handle_deadline(now());
            self->pump();
        }
    });
}

void DatagramLink::receive()
{
    socket_.async_wait(udp::socket::wait_read, [self = shared_from_this()](std::error_code waited) {
        if (waited || !self->on_end_) {
            return;
        }
        std::error_code error;
        const std::size_t size = self->socket_.receive(asio::buffer(self->buffer_), 0, error);
        if (!error) {
            static_cast<void>(self->device_->feed(std::span{self->buffer_}.first(size), now()));
        } else if (error != asio::error::would_block) {
            self->end(error.message()); // nobody has that port, says the other machine
            return;
        }
        self->pump();
        if (self->on_end_) {
            self->receive();
        }
    });
}

void DatagramLink::start()
{
    receive();
    pump();
}

void DatagramLink::close()
{
    on_end_ = nullptr;
    timer_.cancel();
    std::error_code ignored;
    socket_.close(ignored);
}

void DatagramLink::end(const std::string& reason)
{
    const auto on_end = std::exchange(on_end_, nullptr);
    close();
    if (on_end) {
        on_end(reason);
    }
}

DeviceLink::DeviceLink(const asio::any_io_executor& executor, backend::Device& device, LogSink& log)
    : executor_{executor}, device_{&device}, log_{&log},
      connector_{executor, no_log_}, names_{executor, system_lookup}, timer_{executor}
{
}

void DeviceLink::start()
{
    device_->on_output([this] {
        if (stream_) {
            stream_->pump();
        } else if (datagrams_) {
            datagrams_->pump();
        }
    });
    look();
}

void DeviceLink::stop()
{
    if (device_ == nullptr) {
        return;
    }
    connector_.cancel();
    names_.cancel();
    timer_.cancel();
    lost("it is not used any more");
    timer_.cancel();
    device_->on_output({});
    device_ = nullptr;
}

/// Connects if it is time, and waits until it is.
void DeviceLink::look()
{
    if (device_ == nullptr || stream_ || datagrams_) {
        return;
    }
    if (device_->wants_connection(now())) {
        connect();
    }
    timer_.await(device_->next_deadline(), [self = shared_from_this()] {
        busbar::detail::guarded(*self->log_, "connecting to a PLC", [&] {
            if (self->device_ != nullptr && !self->stream_ && !self->datagrams_ &&
                self->device_->state() == backend::DeviceState::Connecting) {
                self->lost("no answer in time");
            }
            self->look();
        });
    });
}

void DeviceLink::connect()
{
    device_->connecting(now());
    if (device_->config().is_datagram) {
        names_.start(device_->config().host,
                     [this](std::vector<asio::ip::address> addresses) { found(addresses); });
        return;
    }
    channel::EndpointUrl url;
    url.host = device_->config().host;
    url.port = device_->config().port;
    connector_.start(url, device_->config().connect_timeout,
                     [this](Expected<asio::ip::tcp::socket, Unreached> socket) {
                         connected(std::move(socket));
                     });
}

void DeviceLink::found(const std::vector<asio::ip::address>& addresses)
{
    if (addresses.empty()) {
        lost("the host has no address");
        return;
    }
    datagrams_ = std::make_shared<DatagramLink>(
        executor_, *device_, [this](const std::string& reason) { lost(reason); });
    const auto error = datagrams_->open({addresses.front(), device_->config().port});
    if (error) {
        lost(error.message());
        return;
    }
    device_->connected(now());
    if (datagrams_) {
        datagrams_->start();
    }
}

void DeviceLink::connected(Expected<asio::ip::tcp::socket, Unreached> socket)
{
    if (!socket) {
        lost(socket.error().reason);
        return;
    }
    device_->connected(now());
    stream_ = std::make_shared<StreamLink>(
        *std::move(socket), *device_, [](auto&) {}, [this](auto&) { lost(lost_connection); });
    stream_->start();
}

void DeviceLink::lost(const std::string& reason)
{
    // Neither may be asked for what the device says next.
    const auto stream = std::exchange(stream_, nullptr);
    const auto datagrams = std::exchange(datagrams_, nullptr);
    device_->lost(reason, now());
    if (stream) {
        stream->end();
    }
    if (datagrams) {
        datagrams->close();
    }
    look();
}

} // namespace busbar::net::detail
