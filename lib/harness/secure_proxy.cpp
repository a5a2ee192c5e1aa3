#include <busbar/harness/secure_proxy.hpp>

#include <algorithm>
#include <deque>
#include <map>
#include <utility>

#include <busbar/harness/seeded_random.hpp>

#include "proxy_end.hpp"
#include "proxy_messages.hpp"

namespace busbar::harness {

namespace {

using channel::ChannelEvent;
using detail::ProxyExchange;

constexpr std::size_t max_proxy_connections = 1'000;
/// Requests that wait for a channel to open, and those whose ids are remembered.
constexpr std::size_t max_waiting = 1'000;
constexpr std::size_t max_waiting_bytes = 64U << 20U;
constexpr std::size_t max_remembered = 4'096;
constexpr std::size_t max_unanswered = 100'000;

/// Everything that the connections of one proxy share.
struct ProxyState {
    World& world;
    detail::ProxyMessages messages;
    channel::ChannelEnvironment to_clients;
    channel::ChannelEnvironment to_server;
    channel::ChannelEnvironment between;
    std::string server_url;
    std::string between_url;
    std::uint32_t last_channel_id{0};
};

/// Requests that wait until a channel is open.
class WaitingRequests {
public:
    struct Request {
        std::uint32_t id{0};
        std::vector<std::byte> body;
        ProxyExchange exchange;
    };
    /// False if there are too many.
    [[nodiscard]] bool add(Request request)
    {
        if (requests_.size() == max_waiting || request.body.size() > max_waiting_bytes - size_) {
            return false;
        }
        size_ += request.body.size();
        requests_.push_back(std::move(request));
        return true;
    }
    [[nodiscard]] bool is_empty() const { return requests_.empty(); }
    [[nodiscard]] Request take()
    {
        Request request = std::move(requests_.front());
        requests_.pop_front();
        size_ -= request.body.size();
        return request;
    }

private:
    std::deque<Request> requests_;
    std::size_t size_{0};
};

/// A client, its server, and the connection between both with policy None: "front" is that one's
/// end at the client, "back" the one at the server.
class ProxyPair {
public:
    ProxyPair(ProxyState& shared, std::string source)
        : shared_{shared}, changed_{shared.world.scheduler(), [this] { update(); }},
          client_{shared.world.scheduler(), Side::Server, changed_},
          front_{shared.world.scheduler(), Side::Client, changed_},
          back_{shared.world.scheduler(), Side::Server, changed_}, server_{shared.world.scheduler(),
                                                                           Side::Client, changed_}
    {
        channel::ServerChannelConfig config;
        config.allowed = shared.messages.endpoints().settings();
        config.channel_id = ++shared.last_channel_id;
        config.source = std::move(source);
        client_.begin(channel::ServerChannel{std::move(config), shared.to_clients, now()});
        channel::ClientChannelConfig front;
        front.endpoint_url = shared.server_url;
        front_.begin(channel::ClientChannel{std::move(front), shared.between, now()});
    }

    /// Takes the client, and connects front and back; false if the network refuses that.
    [[nodiscard]] bool begin(const std::shared_ptr<Link>& client, std::string_view source)
    {
        auto between = shared_.world.network().connect(shared_.between_url, front_, source);
        if (!between) {
            return false;
        }
        front_.begin(*std::move(between));
        client->attach(Side::Server, client_);
        client_.begin(client);
        return true;
    }
    void begin_back(const std::shared_ptr<Link>& link)
    {
        channel::ServerChannelConfig config;
        config.allowed = {{}};
        config.channel_id = ++shared_.last_channel_id;
        back_.begin(channel::ServerChannel{std::move(config), shared_.between, now()});
        link->attach(Side::Server, back_);
        back_.begin(link);
    }
    [[nodiscard]] bool has_ended() const
    {
        return !client_.has_link() && !front_.has_link() && !back_.has_link() &&
               !server_.has_link();
    }

private:
    [[nodiscard]] TimePoint now() const { return shared_.world.now(); }
    void update();
    void from_client(ChannelEvent event);
    void from_front(ChannelEvent event);
    void from_back(ChannelEvent event);
    void from_server(ChannelEvent event);
    void begin_server();
    void send_front(WaitingRequests::Request request);
    void send_server(WaitingRequests::Request request);
    void answer_client(ProxyExchange& exchange, std::span<const std::byte> body);
    void answer_back(std::uint32_t id, std::span<const std::byte> body);
    void forget_answered();
    /// Null if there was none, or it is not remembered any more.
    [[nodiscard]] ProxyExchange* exchange_of(std::uint32_t id)
    {
        const auto found = exchanges_.find(id);
        return found == exchanges_.end() ? nullptr : &found->second;
    }

    ProxyState& shared_;
    Alarm changed_;
    detail::ProxyEnd<channel::ServerChannel> client_;
    detail::ProxyEnd<channel::ClientChannel> front_;
    detail::ProxyEnd<channel::ServerChannel> back_;
    detail::ProxyEnd<channel::ClientChannel> server_;
    detail::ProxyChannels channels_;
    WaitingRequests for_front_;
    WaitingRequests for_server_;
    /// Keys are the ids of requests in between. A fault may double a response, so that exchanges
    /// that were answered are kept as long as there is room.
    std::map<std::uint32_t, ProxyExchange> exchanges_;
    /// Maps the id of a request to the server to that one.
    std::map<std::uint32_t, std::uint32_t> asked_;
};

template <typename Channel>
bool send_body(Channel& channel, std::uint32_t id, std::span<const std::byte> body)
{
    return channel.send(id, [&](binary::Writer& writer) { writer.bytes(body); }).has_value();
}

void ProxyPair::update()
{
    while (auto event = client_.next_event()) {
        from_client(*std::move(event));
    }
    while (auto event = front_.next_event()) {
        from_front(*std::move(event));
    }
    while (front_.is_open() && !for_front_.is_empty()) {
        send_front(for_front_.take());
    }
    while (auto event = back_.next_event()) {
        from_back(*std::move(event));
    }
    while (auto event = server_.next_event()) {
        from_server(*std::move(event));
    }
    while (server_.is_open() && !for_server_.is_empty()) {
        send_server(for_server_.take());
    }
    client_.flush();
    front_.flush();
    back_.flush();
    server_.flush();
    // Each end that is over ends its neighbour.
    if (client_.is_over()) {
        front_.end_as(client_);
    }
    if (front_.is_over()) {
        client_.end_as(front_);
    }
    if (back_.is_over()) {
        server_.end_as(back_);
    }
    if (server_.is_over()) {
        back_.end_as(server_);
    }
}

void ProxyPair::from_client(ChannelEvent event)
{
    if (event.kind == ChannelEvent::Kind::Opened) {
        channels_.security = client_.channel().security();
        channels_.client = client_.channel().peer_certificates();
        channels_.server = shared_.messages.endpoints().certificate_for(channels_.security);
        begin_server();
        return;
    }
    if (event.kind != ChannelEvent::Kind::Message) {
        return;
    }
    WaitingRequests::Request request{0, std::move(event.body), {}};
    request.exchange.client_request_id = event.request_id;
    const auto changed = shared_.messages.from_client(channels_, request.exchange, request.body);
    if (!changed) {
        answer_client(request.exchange, shared_.messages.fault(request.exchange, changed.error()));
    } else if (!for_front_.add(std::move(request))) {
        client_.channel().close(status::Bad_TcpNotEnoughResources,
                                "too many requests wait for the server");
    }
}

void ProxyPair::begin_server()
{
    channel::ClientChannelConfig config;
    config.endpoint_url = shared_.server_url;
    config.security = channels_.security;
    config.server_certificate = channels_.server;
    server_.begin(channel::ClientChannel{std::move(config), shared_.to_server, now()});
    if (auto link = shared_.world.network().connect(shared_.server_url, server_)) {
        server_.begin(*std::move(link));
    }
}

void ProxyPair::send_front(WaitingRequests::Request request)
{
    const auto sent =
        front_.channel().send([&](binary::Writer& writer) { writer.bytes(request.body); });
    if (!sent) {
        answer_client(request.exchange, shared_.messages.fault(request.exchange, sent.error()));
        return;
    }
    forget_answered();
    if (exchanges_.size() > max_unanswered) {
        client_.channel().close(status::Bad_TcpNotEnoughResources,
                                "too many requests are not answered");
    }
    exchanges_.insert_or_assign(*sent, std::move(request.exchange));
}

void ProxyPair::from_front(ChannelEvent event)
{
    const auto found = exchanges_.find(event.request_id);
    if (found == exchanges_.end()) {
        return;
    }
    ProxyExchange& exchange = found->second;
    if (event.kind == ChannelEvent::Kind::Aborted) {
        answer_client(exchange, shared_.messages.fault(exchange, event.status));
    } else if (event.kind == ChannelEvent::Kind::Message) {
        const auto changed = shared_.messages.to_client(channels_, exchange, event.body);
        answer_client(exchange, changed ? std::move(event.body)
                                        : shared_.messages.fault(exchange, changed.error()));
    }
}

void ProxyPair::answer_client(ProxyExchange& exchange, std::span<const std::byte> body)
{
    exchange.is_answered = true;
    exchange.secret.reset();
    if (client_.is_open() && !send_body(client_.channel(), exchange.client_request_id, body)) {
        const auto fault = shared_.messages.fault(exchange, status::Bad_ResponseTooLarge);
        static_cast<void>(send_body(client_.channel(), exchange.client_request_id, fault));
    }
}

void ProxyPair::forget_answered()
{
    for (auto at = exchanges_.begin();
         at != exchanges_.end() && exchanges_.size() > max_remembered;) {
        at = at->second.is_answered ? exchanges_.erase(at) : std::next(at);
    }
}

void ProxyPair::from_back(ChannelEvent event)
{
    if (event.kind == ChannelEvent::Kind::Message &&
        !for_server_.add({event.request_id, std::move(event.body), {}})) {
        back_.channel().close(status::Bad_TcpNotEnoughResources,
                              "too many requests wait for the server");
    }
}

void ProxyPair::send_server(WaitingRequests::Request request)
{
    const ProxyExchange* const exchange = exchange_of(request.id);
    if (exchange == nullptr) {
        return; // the client has not sent it
    }
    const auto changed = shared_.messages.to_server(channels_, *exchange, request.body);
    const auto sent =
        changed
            ? server_.channel().send([&](binary::Writer& writer) { writer.bytes(request.body); })
            : fail(changed.error());
    if (sent) {
        asked_[*sent] = request.id;
    } else {
        answer_back(request.id, shared_.messages.fault(*exchange, sent.error()));
    }
}

void ProxyPair::from_server(ChannelEvent event)
{
    const bool is_answer = event.kind == ChannelEvent::Kind::Message;
    const auto found = asked_.find(event.request_id);
    if (found == asked_.end() || (!is_answer && event.kind != ChannelEvent::Kind::Aborted)) {
        return;
    }
    const std::uint32_t id = found->second;
    asked_.erase(found);
    if (is_answer) {
        answer_back(id, event.body);
    } else if (const ProxyExchange* const exchange = exchange_of(id)) {
        answer_back(id, shared_.messages.fault(*exchange, event.status));
    }
}

void ProxyPair::answer_back(std::uint32_t id, std::span<const std::byte> body)
{
    const ProxyExchange* const exchange = exchange_of(id);
    if (back_.is_open() && !send_body(back_.channel(), id, body) && exchange != nullptr) {
        const auto fault = shared_.messages.fault(*exchange, status::Bad_ResponseTooLarge);
        static_cast<void>(send_body(back_.channel(), id, fault));
    }
}

} // namespace

struct SecureProxy::Impl final : public Acceptor {
    /// Takes the connection in between, whose other end has just been connected.
    struct Between final : public Acceptor {
        [[nodiscard]] bool accept(const std::shared_ptr<Link>& link,
                                  std::string_view /*peer_address*/) override
        {
            pair->begin_back(link);
            return true;
        }
        ProxyPair* pair{nullptr};
    };

    Impl(World& world, std::string_view url, std::string_view server_url,
         Array<EndpointDescription> endpoints, const SecureProxyParts& parts)
        : random{world.new_chance(Actor::Other).next()}, log{world.new_log(Actor::Other)},
          shared{
              world,
              {messages_config(url, server_url, std::move(endpoints), parts), world.clock(), log},
              {},
              {},
              {},
              std::string{server_url},
              // No host has such a name.
              "opc.tcp://between." + std::to_string(world.new_chance(Actor::Other).next()),
              first_channel_id(world)}
    {
        channel::ChannelEnvironment& plain = shared.between;
        plain.random = parts.random != nullptr ? parts.random : &random;
        plain.wall_clock = &world.clock();
        plain.log = &log;
        plain.validator = &accept_any;
        shared.to_clients = plain;
        shared.to_clients.identity = parts.identity;
        shared.to_clients.key_log = parts.key_log;
        shared.to_server = shared.to_clients;
        if (parts.client_validator != nullptr) {
            shared.to_clients.validator = parts.client_validator;
        }
        if (parts.server_validator != nullptr) {
            shared.to_server.validator = parts.server_validator;
        }
        is_listening = channel::EndpointUrl::parse(server_url) &&
                       world.network().listen(url, *this) &&
                       world.network().listen(shared.between_url, between) &&
                       world.network().exempt(url) && world.network().exempt(server_url);
    }
    ~Impl() override
    {
        shared.world.network().unlisten(*this);
        shared.world.network().unlisten(between);
    }

    static detail::ProxyEndpoints::Config messages_config(std::string_view url,
                                                          std::string_view server_url,
                                                          Array<EndpointDescription> endpoints,
                                                          const SecureProxyParts& parts)
    {
        detail::ProxyEndpoints::Config config;
        config.proxy_url = parts.public_url.empty() ? std::string{url} : parts.public_url;
        config.server_url = channel::EndpointUrl::parse(server_url).value_or(config.server_url);
        config.server_url_text = std::string{server_url};
        for (EndpointDescription& endpoint : endpoints) {
            config.endpoints.push_back(std::move(endpoint));
        }
        config.identity = parts.identity;
        return config;
    }
    /// Key logs name channels by their ids, which must not be those of another run. Half of the
    /// range is left to count.
    static std::uint32_t first_channel_id(World& world)
    {
        return static_cast<std::uint32_t>(world.new_chance(Actor::Other).next() >> 33U);
    }
    [[nodiscard]] bool accept(const std::shared_ptr<Link>& link,
                              std::string_view peer_address) override
    {
        std::erase_if(pairs, [](const auto& pair) { return pair->has_ended(); });
        if (pairs.size() == max_proxy_connections) {
            return false;
        }
        auto pair = std::make_unique<ProxyPair>(shared, std::string{peer_address});
        between.pair = pair.get();
        if (!pair->begin(link, peer_address)) {
            return false;
        }
        pairs.push_back(std::move(pair));
        return true;
    }

    SeededRandom random;
    LogSink& log;
    crypto::InsecureAcceptAnyCertificate accept_any;
    ProxyState shared;
    Between between;
    std::vector<std::unique_ptr<ProxyPair>> pairs;
    bool is_listening{false};
};

SecureProxy::SecureProxy(World& world, std::string_view url, std::string_view server_url,
                         Array<EndpointDescription> endpoints, const SecureProxyParts& parts)
    : impl_{std::make_unique<Impl>(world, url, server_url, std::move(endpoints), parts)}
{
}

SecureProxy::~SecureProxy() = default;

bool SecureProxy::is_listening() const
{
    return impl_->is_listening;
}

} // namespace busbar::harness
