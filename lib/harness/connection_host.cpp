#include <busbar/harness/connection_host.hpp>

#include <utility>

namespace busbar::harness {

client::ConnectionConfig open_connection_config()
{
    client::ConnectionConfig config;
    config.channel.endpoint_url = "opc.tcp://server:4840";
    config.application_uri = "urn:busbar:harness:client";
    return config;
}

ConnectionHost::ConnectionHost(World& world, client::ConnectionConfig config,
                               const ClientParts& parts)
    : world_{world}, config_{std::move(config)}, parts_{parts},
      random_{world.new_chance(Actor::Client).next()}, connect_{world.scheduler(),
                                                                [this] { connect(); }},
      deadline_{world.scheduler(), [this] {
                    connection_->handle_deadline(world_.now());
                    update();
                }}
{
    if (parts_.log == nullptr) {
        parts_.log = &world.new_log(Actor::Client);
    }
}

ConnectionHost::~ConnectionHost()
{
    if (link_ != nullptr) {
        link_->leave(Side::Client);
    }
}

Result<void> ConnectionHost::open(Duration limit)
{
    drop();
    closed_by_.reset();
    connect_.set_after(parts_.connect_time);
    if (!world_.run_until([this] { return is_ready_ || closed_by_; }, limit)) {
        return fail(status::Bad_Timeout);
    }
    if (!is_ready_) {
        return fail(closed_by_->is_bad() ? *closed_by_ : status::Bad_ConnectionClosed);
    }
    return {};
}

void ConnectionHost::connect()
{
    const channel::ChannelEnvironment environment{
        .random = parts_.random != nullptr ? parts_.random : &random_,
        .wall_clock = &world_.clock(),
        .log = parts_.log,
        .validator = parts_.validator != nullptr ? parts_.validator : &accept_any_,
        .identity = parts_.identity,
        .key_log = parts_.key_log,
        .chunk_hook = &world_.network().chunk_hook()};
    connection_.emplace(config_, environment, world_.now());
    auto link = world_.network().connect(config_.channel.endpoint_url, *this, parts_.address);
    if (!link) {
        end(link.error());
        return;
    }
    link_ = *std::move(link);
    update();
}

void ConnectionHost::feed(std::span<const std::byte> in)
{
    static_cast<void>(connection_->feed(in, world_.now()));
    update();
}

void ConnectionHost::tell_time()
{
    if (is_ready_) {
        connection_->handle_deadline(world_.now());
    }
}

void ConnectionHost::update()
{
    while (connection_) {
        auto event = connection_->next_event();
        if (!event) {
            break;
        }
        handle(*std::move(event));
    }
    if (link_ == nullptr) {
        return;
    }
    link_->flush(Side::Client);
    if (connection_->is_closed()) {
        link_->close(Side::Client);
        link_.reset();
        end(status::Bad_ConnectionClosed);
    } else {
        deadline_.set(connection_->next_deadline());
    }
}

void ConnectionHost::handle(client::ConnectionEvent event)
{
    switch (event.kind) {
    case client::ConnectionEvent::Kind::Ready:
        is_ready_ = true;
        break;
    case client::ConnectionEvent::Kind::Response: {
        if (auto raw = body_handlers_.extract(event.handle); !raw.empty()) {
            raw.mapped()(std::move(event.body));
            return;
        }
        auto found = handlers_.extract(event.handle);
        if (found.empty()) {
            return;
        }
        if (event.status.is_bad()) {
            found.mapped()(fail(event.status));
        } else {
            found.mapped()(client::ResponseBody{std::move(event.body)});
        }
        break;
    }
    case client::ConnectionEvent::Kind::Closed:
        is_ready_ = false;
        closed_by_ = event.status;
        break;
    }
}

void ConnectionHost::await(Result<std::uint32_t> sent, Handler handler)
{
    if (!sent) {
        handler(fail(sent.error()));
        return;
    }
    handlers_.emplace(*sent, std::move(handler));
    if (link_ != nullptr) {
        link_->flush(Side::Client);
        deadline_.set(connection_->next_deadline());
    }
}

void ConnectionHost::send_body(std::span<const std::byte> body, BodyHandler then)
{
    tell_time();
    binary::Reader reader{body};
    NodeId id;
    RequestHeader header;
    decode(reader, id);
    decode(reader, header);
    const auto fields = reader.ok() ? body.subspan(reader.offset()) : body.first(0);
    const auto sent =
        is_ready_ && reader.ok()
            ? connection_->send_encoded([&](binary::Writer& writer, const RequestHeader& own) {
                  encode(writer, id);
                  encode(writer, own);
                  writer.bytes(fields);
              })
            : fail(status::Bad_NotConnected);
    if (!sent) {
        then({});
        return;
    }
    body_handlers_.emplace(*sent, std::move(then));
    link_->flush(Side::Client);
    deadline_.set(connection_->next_deadline());
}

void ConnectionHost::close()
{
    connect_.cancel();
    if (link_ != nullptr) {
        connection_->close();
        update();
    }
}

void ConnectionHost::drop()
{
    connect_.cancel();
    if (link_ != nullptr) {
        std::exchange(link_, nullptr)->leave(Side::Client);
        end(status::Bad_ConnectionClosed);
    }
}

void ConnectionHost::end(StatusCode status)
{
    link_.reset();
    is_ready_ = false;
    deadline_.cancel();
    if (!closed_by_) {
        closed_by_ = status;
    }
    for (auto& [handle, handler] : std::exchange(handlers_, {})) {
        handler(fail(status::Bad_ConnectionClosed));
    }
    for (auto& [handle, handler] : std::exchange(body_handlers_, {})) {
        handler({});
    }
}

} // namespace busbar::harness
