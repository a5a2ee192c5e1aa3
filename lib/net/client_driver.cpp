#include "client_driver.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include <asio/post.hpp>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/core/detail/guarded.hpp>

namespace busbar::net::detail {

namespace {

/// Maximum number of occurrences handled in one step, so that others on the executor get their
/// turn.
constexpr std::size_t max_steps = 256;
/// Time for the last bytes of a connection.
constexpr Duration farewell = std::chrono::seconds{2};

} // namespace

void ClientLine::leave(TimePoint until, bool awaits_peer)
{
    if (client_ == nullptr) {
        return;
    }
    const auto output = client_->output();
    rest_.assign(output.begin(), output.end());
    client_->consume(output.size());
    client_ = nullptr;
    is_busy_ = false;
    awaits_peer_ = awaits_peer;
    until_ = until;
}

Result<void> ClientLine::feed(std::span<const std::byte> in, TimePoint now)
{
    return client_ != nullptr ? client_->feed(in, now) : Result<void>{};
}

std::span<const std::byte> ClientLine::output() const
{
    return client_ != nullptr ? client_->output() : std::span{rest_}.subspan(sent_);
}

void ClientLine::consume(std::size_t size)
{
    if (client_ != nullptr) {
        client_->consume(size);
    } else {
        sent_ += size;
    }
}

void ClientLine::handle_deadline(TimePoint now)
{
    if (until_ <= now) {
        sent_ = rest_.size();
        awaits_peer_ = false;
        until_ = no_deadline;
    }
}

ClientDriver::ClientDriver(const asio::any_io_executor& executor, client::ClientConfig config,
                           const channel::ChannelEnvironment& environment, Lookup lookup)
    : executor_{executor}, log_{environment.log}, connect_timeout_{config.connect_timeout},
      is_reverse_{config.is_reverse}, expected_{config.server_uri, config.endpoint_url},
      client_{std::move(config), environment, now()},
      connector_{executor, *environment.log, std::move(lookup)}, timer_{executor}
{
    keep_free_memory(); // memory_return_ returns it
}

void ClientDriver::take_from(std::shared_ptr<ReverseQueue> queue)
{
    if (queue_) {
        queue_->forget(ticket_);
    }
    queue_ = std::move(queue);
    ticket_ = queue_->expect(expected_);
}

void ClientDriver::wake()
{
    if (has_stopped_ || std::exchange(is_woken_, true)) {
        return;
    }
    asio::post(executor_, [self = shared_from_this()] {
        self->is_woken_ = false;
        self->step();
    });
}

void ClientDriver::step()
{
    if (has_stopped_ || is_stepping_) {
        return;
    }
    const auto self = shared_from_this(); // a handler may destroy our owner
    is_stepping_ = true;
    bool has_more = poll();
    is_stepping_ = false;
    while (const auto order = has_stopped_ ? std::nullopt : client_.next_order()) {
        carry_out(*order);
        has_more = true;
    }
    if (const auto link = link_) {
        link->engine().set_busy(has_more);
        link->pump();
    }
    if (has_stopped_) {
        return;
    }
    await_deadline();
    if (has_more) {
        wake();
    }
    if (on_step_) {
        on_step_();
    }
}

void ClientDriver::await_deadline()
{
    const TimePoint memory = link_ ? memory_return_.next_deadline() : no_deadline;
    timer_.await(std::min(client_.next_deadline(), memory), [self = shared_from_this()] {
        if (!self->has_stopped_) {
            self->client_.handle_deadline(now());
            self->memory_return_.look(now());
            self->step();
        }
    });
}

/// Returns true if there is more to do.
bool ClientDriver::poll()
{
    bool has_more = true;
    busbar::detail::guarded(*log_, "Client::poll",
                            [&] { has_more = client_.poll(now(), max_steps); });
    return has_more;
}

void ClientDriver::carry_out(const client::TransportOrder& order)
{
    const bool awaits_peer = order.awaits_peer && link_ != nullptr;
    drop(awaits_peer);
    if (awaits_peer) {
        return; // ended() tells the Client
    }
    if (order.kind == client::TransportOrder::Kind::Drop) {
        // The link sends the rest: the Client need not wait for it.
        client_.disconnected(order.id, status::Bad_ConnectionClosed, now());
        return;
    }
    end_waiting();
    if (is_reverse_) {
        open_reverse(order.id);
    } else {
        open(order);
    }
}

void ClientDriver::open(const client::TransportOrder& order)
{
    const auto url = channel::EndpointUrl::parse(order.url);
    if (!url) {
        client_.disconnected(order.id, url.error(), now());
        return;
    }
    connector_.start(*url, connect_timeout_,
                     [this, id = order.id](Expected<asio::ip::tcp::socket, Unreached> socket) {
                         socket ? opened(id, *std::move(socket), {}) : failed(id, socket.error());
                     });
}

void ClientDriver::open_reverse(std::uint64_t order)
{
    if (!queue_) {
        log("there is no listener for the server's connection");
        client_.disconnected(order, status::Bad_ConfigurationError, now());
        return;
    }
    queue_->take(ticket_,
                 [this, order](asio::ip::tcp::socket socket, const std::vector<std::byte>& hello) {
                     opened(order, std::move(socket), hello);
                 });
}

/// `in` was read from the connection before.
void ClientDriver::opened(std::uint64_t order, asio::ip::tcp::socket socket,
                          std::span<const std::byte> in)
{
    const auto line = std::make_shared<ClientLine>(client_, order);
    link_ = std::make_shared<ClientLink>(
        std::move(socket), *line,
        [this](ClientLink&) {
            memory_return_.note_activity(now());
            step();
        },
        [this, line](ClientLink& link) { ended(link); });
    client_.connected(order, now());
    if (!in.empty()) {
        // It answers what it refuses, and then orders the connection to be dropped.
        static_cast<void>(client_.feed(in, now()));
    }
    link_->start();
    step();
}

void ClientDriver::failed(std::uint64_t order, const Unreached& why)
{
    client_.disconnected(order, why.status, now(), why.reason);
    step();
}

void ClientDriver::drop(bool awaits_peer)
{
    connector_.cancel();
    if (queue_) {
        queue_->cancel(ticket_);
    }
    if (const auto link = std::exchange(link_, nullptr)) {
        leaving_.push_back(link);
        link->engine().leave(after(farewell), awaits_peer);
        link->pump();
    }
}

/// The Client continues: a peer that has not closed yet finds the connection closed.
void ClientDriver::end_waiting()
{
    const auto leaving = leaving_;
    for (const auto& link : leaving) {
        if (link->engine().awaits_peer()) {
            link->engine().stop_waiting();
            link->pump();
        }
    }
}

void ClientDriver::ended(ClientLink& link)
{
    if (has_stopped_) {
        return;
    }
    if (link_.get() == &link) {
        const auto gone = std::exchange(link_, nullptr);
        client_.disconnected(gone->engine().order(), status::Bad_ConnectionClosed, now());
    } else {
        const std::uint64_t order = link.engine().order();
        std::erase_if(leaving_, [&](const auto& leaving) { return leaving.get() == &link; });
        // The Client ignores an old order.
        client_.disconnected(order, status::Bad_ConnectionClosed, now());
    }
    wake();
}

void ClientDriver::stop()
{
    if (std::exchange(has_stopped_, true)) {
        return;
    }
    connector_.cancel();
    if (queue_) {
        queue_->forget(ticket_);
    }
    timer_.cancel();
    on_step_ = nullptr;
    if (const auto link = std::exchange(link_, nullptr)) {
        link->end();
    }
    for (const auto& link : std::exchange(leaving_, {})) {
        link->end();
    }
}

void ClientDriver::log(const std::string& text)
{
    busbar::detail::write_safely(*log_, LogLevel::Error, "net", text);
}

} // namespace busbar::net::detail
