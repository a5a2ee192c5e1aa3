#include <busbar/harness/client_host.hpp>

#include <utility>

namespace busbar::harness {

client::ClientConfig open_client_config()
{
    client::ClientConfig config;
    config.endpoint_url = "opc.tcp://server:4840";
    config.application_uri = "urn:busbar:harness:client";
    config.security.min_mode = MessageSecurityMode::None;
    config.security.allows_none = true;
    return config;
}

ClientHost::ClientHost(World& world, client::ClientConfig config, const ClientParts& parts)
    : world_{world}, parts_{parts}, random_{world.new_chance(Actor::Client).next()},
      environment_{.random = &random_,
                   .wall_clock = &world.clock(),
                   .log = parts.log != nullptr ? parts.log : &world.new_log(Actor::Client),
                   .validator = parts.validator != nullptr ? parts.validator : &accept_any_,
                   .identity = parts.identity,
                   .key_log = parts.key_log,
                   .chunk_hook = &world.network().chunk_hook()},
      client_{std::make_unique<client::Client>(std::move(config), environment_, world.now())},
      open_{world.scheduler(), [this] { open(); }}, deadline_{world.scheduler(),
                                                              [this] {
                                                                  client_->handle_deadline(
                                                                      world_.now());
                                                                  update();
                                                              }},
      touched_{world.scheduler(), [this] { update(); }}
{
}

ClientHost::~ClientHost()
{
    if (link_ != nullptr) {
        link_->leave(Side::Client);
    }
}

Result<void> ClientHost::connect(Duration limit)
{
    client().connect(world_.now());
    const auto is_done = [this] {
        return state() == client::ClientState::Ready || state() == client::ClientState::Closed;
    };
    static_cast<void>(world_.run_until(is_done, limit));
    if (state() == client::ClientState::Ready) {
        return {};
    }
    const StatusCode error = client_->last_error();
    return fail(error.is_bad() ? error : status::Bad_Timeout);
}

void ClientHost::close(Duration limit)
{
    client().close(world_.now());
    static_cast<void>(
        world_.run_until([this] { return state() == client::ClientState::Closed; }, limit));
}

void ClientHost::feed(std::span<const std::byte> in)
{
    static_cast<void>(client_->feed(in, world_.now()));
    update();
}

void ClientHost::link_lost()
{
    link_.reset();
    client_->disconnected(order_.id, status::Bad_ConnectionClosed, world_.now());
    update();
}

void ClientHost::update()
{
    bool has_obeyed = true;
    while (std::exchange(has_obeyed, false)) {
        while (client_->poll(world_.now())) {
        }
        while (auto order = client_->next_order()) {
            obey(*std::move(order));
            has_obeyed = true;
        }
    }
    if (link_ != nullptr) {
        link_->flush(Side::Client);
    }
    deadline_.set(client_->next_deadline());
    if (on_step_) {
        on_step_();
    }
}

void ClientHost::obey(client::TransportOrder order)
{
    if (order.kind == client::TransportOrder::Kind::Open) {
        if (link_ != nullptr) {
            std::exchange(link_, nullptr)->close(Side::Client);
        }
        order_ = std::move(order);
        open_.set_after(parts_.connect_time);
        return;
    }
    open_.cancel();
    if (link_ != nullptr && order.awaits_peer) {
        return; // update() sends the rest, and link_lost() reports that the server has closed
    }
    if (link_ != nullptr) {
        std::exchange(link_, nullptr)->close(Side::Client);
        client_->disconnected(order_.id, status::Bad_ConnectionClosed, world_.now());
    }
}

void ClientHost::open()
{
    auto link = world_.network().connect(order_.url, *this, parts_.address);
    if (link) {
        link_ = *std::move(link);
        client_->connected(order_.id, world_.now());
    } else {
        client_->disconnected(order_.id, link.error(), world_.now());
    }
    update();
}

} // namespace busbar::harness
