#include "moody_server.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <busbar/core/text.hpp>

namespace busbar::test {

using namespace std::chrono_literals;
using harness::decode_body;
using harness::encode_body;

namespace {

constexpr Duration change_interval = 20s;

/// The services that can be ill.
constexpr std::array services{
    FindServersRequest::binary_encoding_id,
    RegisterServerRequest::binary_encoding_id,
    RegisterServer2Request::binary_encoding_id,
    GetEndpointsRequest::binary_encoding_id,
    CreateSessionRequest::binary_encoding_id,
    ActivateSessionRequest::binary_encoding_id,
    CloseSessionRequest::binary_encoding_id,
    ReadRequest::binary_encoding_id,
    WriteRequest::binary_encoding_id,
    CallRequest::binary_encoding_id,
    BrowseRequest::binary_encoding_id,
    BrowseNextRequest::binary_encoding_id,
    TranslateBrowsePathsToNodeIdsRequest::binary_encoding_id,
    RegisterNodesRequest::binary_encoding_id,
    UnregisterNodesRequest::binary_encoding_id,
    CreateSubscriptionRequest::binary_encoding_id,
    ModifySubscriptionRequest::binary_encoding_id,
    DeleteSubscriptionsRequest::binary_encoding_id,
    SetPublishingModeRequest::binary_encoding_id,
    TransferSubscriptionsRequest::binary_encoding_id,
    RepublishRequest::binary_encoding_id,
    PublishRequest::binary_encoding_id,
    CreateMonitoredItemsRequest::binary_encoding_id,
    ModifyMonitoredItemsRequest::binary_encoding_id,
    SetMonitoringModeRequest::binary_encoding_id,
    SetTriggeringRequest::binary_encoding_id,
    DeleteMonitoredItemsRequest::binary_encoding_id,
};

/// All bad codes that have a name.
const std::vector<StatusCode>& bad_codes()
{
    static const std::vector<StatusCode> codes = [] {
        std::vector<StatusCode> all;
        for (std::uint32_t code = 0x8001'0000; code < 0x8200'0000; code += 0x1'0000) {
            if (!name(StatusCode{code}).empty()) {
                all.emplace_back(code);
            }
        }
        return all;
    }();
    return codes;
}

void refuse_result(StatusCode& result, StatusCode why)
{
    result = why;
}
void refuse_result(DataValue& result, StatusCode why)
{
    result = DataValue{why};
}
template <typename T>
void refuse_result(T& result, StatusCode why)
{
    result.status_code = why;
}
template <typename Response>
void refuse_results(Response& response, StatusCode why)
{
    if constexpr (requires { response.results; }) {
        for (auto& result : response.results) {
            refuse_result(result, why);
        }
    } else if constexpr (requires { response.add_results; }) {
        for (StatusCode& result : response.add_results) {
            result = why;
        }
    } else if constexpr (requires { response.configuration_results; }) {
        for (StatusCode& result : response.configuration_results) {
            result = why;
        }
    }
}

/// Endpoints in front of the right one, each with something that no client can use.
void add_odd_endpoints(Array<EndpointDescription>& endpoints, Chance& chance)
{
    Array<EndpointDescription> odd;
    for (std::size_t i = 0; i < 20; ++i) {
        EndpointDescription& each = odd.emplace_back(endpoints[0]);
        switch (chance.below(7)) {
        case 0:
            each.security_policy_uri = "urn:unknown";
            break;
        case 1:
            each.security_mode = MessageSecurityMode{chance.pick<std::int32_t>({0, 2, 3, 77})};
            break;
        case 2:
            each.user_identity_tokens.clear();
            break;
        case 3:
            each.user_identity_tokens[0].token_type = UserTokenType{99};
            break;
        case 4:
            each.user_identity_tokens[0].security_policy_uri = "urn:unknown";
            break;
        case 5:
            each.transport_profile_uri = "urn:unknown";
            break;
        default:
            each.endpoint_url = chance.pick<const char*>(
                {"", "opc.tcp://elsewhere:4840", "http://moody", "opc.tcp://moody:99999"});
        }
    }
    odd.push_back(endpoints[0]);
    endpoints = std::move(odd);
}

/// What a server says that knows no bounds.
template <typename Response>
void exaggerate(Response& response, Chance& chance)
{
    const double number = chance.pick(
        {0.0, -1.0, 1e300, std::nan(""), std::numeric_limits<double>::infinity(), 1e-300});
    const auto count = chance.pick<std::uint32_t>({0, 1, 0x7FFF'FFFF, 0xFFFF'FFFF});
    if constexpr (requires { response.revised_publishing_interval; }) {
        response.revised_publishing_interval = number;
        response.revised_max_keep_alive_count = count;
        response.revised_lifetime_count = count;
    } else if constexpr (requires { response.revised_session_timeout; }) {
        response.revised_session_timeout = number;
    } else if constexpr (requires { response.results[0].continuation_point; }) {
        for (auto& result : response.results) {
            result.continuation_point = ByteString{std::vector<std::byte>(8, std::byte{1})};
        }
    } else if constexpr (requires { response.more_notifications; }) {
        response.more_notifications = true;
    } else if constexpr (requires { response.endpoints; }) {
        add_odd_endpoints(response.endpoints, chance);
    }
}

} // namespace

/// The server's end of one connection.
class MoodyServer::Peer final : public LinkEnd {
public:
    Peer(MoodyServer& server, std::uint64_t id, channel::ServerChannelConfig config,
         const channel::ChannelEnvironment& environment, std::shared_ptr<Link> link)
        : server_{server}, id_{id}, link_{std::move(link)}, channel_{std::move(config), environment,
                                                                     server.world_.now()},
          deadline_{server.world_.scheduler(),
                    [this] {
                        channel_.handle_deadline(server_.world_.now());
                        update();
                    }},
          due_alarm_{server.world_.scheduler(), [this] { send_due(); }}
    {
        deadline_.set(channel_.next_deadline());
    }
    ~Peer() override
    {
        if (link_ != nullptr) {
            link_->leave(Side::Server);
        }
    }

    [[nodiscard]] std::uint64_t id() const { return id_; }
    [[nodiscard]] bool has_ended() const { return link_ == nullptr; }
    void send(std::uint32_t request_id, std::vector<std::byte> body, Duration delay)
    {
        const TimePoint time = server_.world_.now() + delay;
        const auto place =
            std::upper_bound(due_.begin(), due_.end(), time,
                             [](TimePoint when, const Due& other) { return when < other.time; });
        due_.insert(place, Due{time, request_id, std::move(body)});
        due_alarm_.set(due_.front().time);
    }
    void hang_up()
    {
        if (link_ != nullptr) {
            link_->cut();
        }
    }

    // LinkEnd
    [[nodiscard]] std::span<const std::byte> output() const override { return channel_.output(); }
    void consume(std::size_t size) override { channel_.consume(size); }
    void feed(std::span<const std::byte> in) override
    {
        if (server_.is_deaf_) {
            return;
        }
        received_.insert(received_.end(), in.begin(), in.end());
        take_messages();
        update();
    }
    void link_lost() override
    {
        link_.reset();
        deadline_.cancel();
        due_alarm_.cancel();
    }

private:
    struct Due {
        TimePoint time;
        std::uint32_t request_id;
        std::vector<std::byte> body;
    };

    /// Feeds whole messages (Part 6, 6.7.2) and leaves out what renews the channel. Without
    /// security the sequence numbers of the following ones can be corrected.
    void take_messages()
    {
        std::size_t taken = 0;
        while (received_.size() - taken >= header_size) {
            const std::span<std::byte> rest = std::span{received_}.subspan(taken);
            const std::size_t size = std::max<std::size_t>(number_at(rest, 4), header_size);
            if (rest.size() < size) {
                break;
            }
            taken += size;
            const std::span<std::byte> message = rest.first(size);
            if (message[0] == std::byte{'O'} && is_open_ &&
                (server_.ignores_renewals_ || ignored_ != 0)) {
                ++ignored_;
                ++server_.ignored_renewals_;
                continue;
            }
            if (ignored_ != 0 && size >= sequence_offset + 4) { // a MSG or CLO
                const std::uint32_t number = number_at(message, sequence_offset) - ignored_;
                for (std::size_t i = 0; i < 4; ++i) {
                    message[sequence_offset + i] = std::byte(number >> 8 * i);
                }
            }
            static_cast<void>(channel_.feed(message, server_.world_.now()));
        }
        received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(taken));
    }
    [[nodiscard]] static std::uint32_t number_at(std::span<const std::byte> bytes, std::size_t at)
    {
        std::uint32_t number = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            number |= std::to_integer<std::uint32_t>(bytes[at + i]) << 8 * i;
        }
        return number;
    }

    void update()
    {
        while (auto event = channel_.next_event()) {
            is_open_ = true;
            if (event->kind == channel::ChannelEvent::Kind::Message) {
                server_.handle({*this, event->request_id, event->body});
            }
            if (link_ == nullptr) {
                return;
            }
        }
        send_due();
    }
    void send_due()
    {
        while (link_ != nullptr && !due_.empty() && due_.front().time <= server_.world_.now()) {
            const Due due = std::move(due_.front());
            due_.pop_front();
            static_cast<void>(channel_.send(
                due.request_id, [&](binary::Writer& writer) { writer.bytes(due.body); }));
        }
        if (link_ == nullptr) {
            return;
        }
        link_->flush(Side::Server);
        if (channel_.is_closed()) {
            std::exchange(link_, nullptr)->close(Side::Server);
            deadline_.cancel();
            due_alarm_.cancel();
            return;
        }
        deadline_.set(channel_.next_deadline());
        due_alarm_.set(due_.empty() ? no_deadline : due_.front().time);
    }

    static constexpr std::size_t header_size = 8;
    /// Of the sequence number in a message without security: after header, channel and token.
    static constexpr std::size_t sequence_offset = 16;

    MoodyServer& server_;
    std::uint64_t id_;
    std::shared_ptr<Link> link_;
    channel::ServerChannel channel_;
    std::vector<std::byte> received_;
    std::uint32_t ignored_{0}; // renewals of this channel
    bool is_open_{false};
    std::deque<Due> due_;
    Alarm deadline_;
    Alarm due_alarm_;
};

MoodyServer::MoodyServer(World& world, std::string_view url)
    : world_{world}, url_{url}, chance_{world.new_chance(harness::Actor::Server)},
      random_{chance_.next()}
{
    static_cast<void>(world.network().listen(url, *this));
}

MoodyServer::~MoodyServer()
{
    world_.network().unlisten(*this);
}

void MoodyServer::be_well()
{
    ailments_.clear();
    is_deaf_ = false;
    ignores_renewals_ = false;
}

void MoodyServer::change_moods()
{
    be_well();
    if (chance_.one_in(20)) {
        is_deaf_ = true;
        return;
    }
    ignores_renewals_ = chance_.one_in(5);
    // Mostly one or two services, now and then all.
    const std::size_t count = chance_.one_in(10) ? services.size() : 1 + chance_.below(3);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t service =
            count == services.size() ? services[i] : services[chance_.below(services.size())];
        Ailment ailment;
        ailment.mood =
            chance_.pick({Mood::Well, Mood::Silent, Mood::Silent, Mood::Silent, Mood::Refuses,
                          Mood::Refuses, Mood::Refuses, Mood::RefusesResults, Mood::RefusesResults,
                          Mood::Empty, Mood::Endless, Mood::Late, Mood::Strange, Mood::HangsUp});
        ailment.status = bad_codes()[chance_.below(bad_codes().size())];
        ailment.delay = chance_.between(100ms, 15s);
        ailments_[service] = ailment;
    }
}

void MoodyServer::forget_sessions()
{
    sessions_.clear();
    if (chance_.one_in(2)) {
        forget_subscriptions();
    }
}

void MoodyServer::forget_subscriptions()
{
    subscriptions_.clear(); // when their last messages were sent is still asked for
}

std::string MoodyServer::ailments() const
{
    std::string text = is_deaf_ ? "deaf" : ignores_renewals_ ? "ignores renewals" : "";
    for (const auto& [service, ailment] : ailments_) {
        text += " " + std::to_string(service) + ":" +
                std::to_string(static_cast<int>(ailment.mood)) + ":" +
                std::string{name(ailment.status)};
    }
    return text;
}

TimePoint MoodyServer::last_message(std::uint32_t subscription) const
{
    const auto found = messages_.find(subscription);
    return found != messages_.end() ? found->second : TimePoint{};
}

bool MoodyServer::accept(const std::shared_ptr<Link>& link, std::string_view /*peer_address*/)
{
    std::erase_if(peers_, [](const auto& entry) { return entry.second->has_ended(); });
    channel::ServerChannelConfig config;
    config.channel_id = static_cast<std::uint32_t>(++last_peer_);
    config.allowed = {channel::SecuritySetting{}};
    const channel::ChannelEnvironment environment{
        .random = &random_, .wall_clock = &world_.clock(), .log = &log_, .validator = &accept_any_};
    auto peer = std::make_unique<Peer>(*this, last_peer_, std::move(config), environment, link);
    link->attach(Side::Server, *peer);
    peers_.emplace(last_peer_, std::move(peer));
    return true;
}

std::int64_t MoodyServer::value() const
{
    return world_.now().time_since_epoch() / change_interval;
}

MoodyServer::Ailment MoodyServer::ailment_of(std::uint32_t service) const
{
    const auto found = ailments_.find(service);
    return found != ailments_.end() ? found->second : Ailment{};
}

void MoodyServer::send(Peer& peer, std::uint32_t request_id, std::vector<std::byte> body,
                       Duration delay)
{
    peer.send(request_id, std::move(body), delay);
}

void MoodyServer::refuse(const Incoming& incoming, std::uint32_t handle, StatusCode status,
                         Duration delay)
{
    ServiceFault fault;
    fault.response_header.request_handle = handle;
    fault.response_header.timestamp = world_.clock().now();
    fault.response_header.service_result = status;
    send(incoming.peer, incoming.request_id, *encode_body(fault), delay);
}

template <typename Request, typename Response>
bool MoodyServer::serve(const Incoming& incoming,
                        Result<Response> (MoodyServer::*answer)(const Request&))
{
    const auto request = decode_body<Request>(incoming.body);
    if (!request) {
        return false;
    }
    const Ailment ailment = ailment_of(Request::binary_encoding_id);
    const std::uint32_t handle = request->request_header.request_handle;
    switch (ailment.mood) {
    case Mood::Silent:
        return true;
    case Mood::HangsUp:
        incoming.peer.hang_up();
        return true;
    case Mood::Refuses:
        refuse(incoming, handle, ailment.status, 0s);
        return true;
    default:
        break;
    }
    Result<Response> response = (this->*answer)(*request);
    if (!response) {
        refuse(incoming, handle, response.error(), 0s);
        return true;
    }
    if (ailment.mood == Mood::RefusesResults) {
        refuse_results(*response, ailment.status);
    } else if (ailment.mood == Mood::Empty) {
        *response = Response{};
    } else if (ailment.mood == Mood::Endless) {
        exaggerate(*response, chance_);
    }
    const Duration delay = ailment.mood == Mood::Late ? ailment.delay : Duration{0};
    if (ailment.mood == Mood::Strange) {
        CancelResponse strange;
        strange.response_header.request_handle = handle;
        send(incoming.peer, incoming.request_id, *encode_body(strange), delay);
        return true;
    }
    response->response_header.request_handle = handle;
    response->response_header.timestamp = world_.clock().now();
    send(incoming.peer, incoming.request_id, *encode_body(*response), delay);
    return true;
}

void MoodyServer::handle(const Incoming& incoming)
{
    ++requests_;
    using S = MoodyServer;
    const bool is_served =
        publish(incoming) || serve(incoming, &S::read) || serve(incoming, &S::get_endpoints) ||
        serve(incoming, &S::create_session) || serve(incoming, &S::activate_session) ||
        serve(incoming, &S::close_session) || serve(incoming, &S::write) ||
        serve(incoming, &S::call) || serve(incoming, &S::browse) ||
        serve(incoming, &S::browse_next) || serve(incoming, &S::translate) ||
        serve(incoming, &S::create) || serve(incoming, &S::modify) || serve(incoming, &S::remove) ||
        serve(incoming, &S::set_mode) || serve(incoming, &S::transfer) ||
        serve(incoming, &S::republish) || serve(incoming, &S::create_items) ||
        serve(incoming, &S::delete_items) || serve(incoming, &S::modify_items) ||
        serve(incoming, &S::set_monitoring) || serve(incoming, &S::set_triggering) ||
        serve(incoming, &S::register_nodes) || serve(incoming, &S::unregister_nodes) ||
        serve(incoming, &S::find_servers) || serve(incoming, &S::register_server) ||
        serve(incoming, &S::register_server2);
    if (!is_served) {
        refuse(incoming, 0, status::Bad_ServiceUnsupported, 0s);
    }
}

/// Publish waits for its time, unless it is ill.
bool MoodyServer::publish(const Incoming& incoming)
{
    const auto request = decode_body<PublishRequest>(incoming.body);
    if (!request) {
        return false;
    }
    const Ailment ailment = ailment_of(PublishRequest::binary_encoding_id);
    const std::uint32_t handle = request->request_header.request_handle;
    const auto session = session_of(request->request_header);
    const std::uint32_t token = request->request_header.authentication_token.numeric();
    const bool has_any = std::any_of(subscriptions_.begin(), subscriptions_.end(),
                                     [&](auto& each) { return each.second.session == token; });
    if (ailment.mood == Mood::HangsUp) {
        incoming.peer.hang_up();
    } else if (ailment.mood == Mood::Refuses) {
        refuse(incoming, handle, ailment.status, 0s);
    } else if (ailment.mood == Mood::Empty || ailment.mood == Mood::Strange) {
        PublishResponse response;
        response.response_header.request_handle = handle;
        send(incoming.peer, incoming.request_id, *encode_body(response), 1s);
    } else if (ailment.mood == Mood::Silent) {
        return true;
    } else if (!session) {
        refuse(incoming, handle, session.error(), 0s);
    } else if (!has_any) {
        refuse(incoming, handle, status::Bad_NoSubscription, 0s);
    } else if ((*session)->publishes.size() >= 20) {
        refuse(incoming, handle, status::Bad_TooManyPublishRequests, 0s);
    } else {
        (*session)->publishes.push_back({incoming.peer.id(), incoming.request_id, handle});
    }
    return true;
}

void MoodyServer::be_due(std::uint32_t id)
{
    const auto found = subscriptions_.find(id);
    if (found == subscriptions_.end()) {
        return;
    }
    Subscription& subscription = found->second;
    subscription.alarm->set_after(subscription.interval);
    const auto session = sessions_.find(subscription.session);
    ++subscription.idle_count;
    ++subscription.unheard_count;
    const bool has_news = subscription.last_value != value() && !subscription.items.empty();
    const bool is_first = subscription.last_number == 0;
    if (session != sessions_.end() && !session->second.publishes.empty()) {
        subscription.unheard_count = 0;
        if (has_news || is_first || subscription.idle_count >= subscription.keep_alive_count) {
            const PendingPublish publish = session->second.publishes.front();
            session->second.publishes.pop_front();
            notify(id, subscription, publish);
        }
    }
    if (subscription.unheard_count > subscription.lifetime_count) {
        // Its alarm, whose action this is, goes with the next one.
        world_.scheduler().after(0s, [this, id] { subscriptions_.erase(id); });
    }
}

void MoodyServer::notify(std::uint32_t id, Subscription& subscription,
                         const PendingPublish& publish)
{
    const auto peer = peers_.find(publish.peer);
    const Ailment ailment = ailment_of(PublishRequest::binary_encoding_id);
    subscription.idle_count = 0;
    PublishResponse response;
    response.response_header.request_handle = publish.request_handle;
    response.response_header.timestamp = world_.clock().now();
    response.subscription_id = id;
    NotificationMessage& message = response.notification_message;
    message.sequence_number = subscription.last_number + 1;
    message.publish_time = world_.clock().now();
    if (subscription.last_value != value() && !subscription.items.empty()) {
        subscription.last_value = value();
        ++subscription.last_number;
        DataChangeNotification data;
        for (const auto& [server_id, handle] : subscription.items) {
            data.monitored_items.push_back({handle, DataValue{Variant{value()}}});
        }
        message.notification_data.push_back(ExtensionObject::from(data));
    }
    if (ailment.mood == Mood::RefusesResults) {
        refuse_results(response, ailment.status);
    } else if (ailment.mood == Mood::Endless) {
        response.more_notifications = true;
    }
    if (peer == peers_.end() || peer->second->has_ended()) {
        return;
    }
    const Duration delay = ailment.mood == Mood::Late ? ailment.delay : Duration{0};
    messages_[id] = world_.now() + delay;
    send(*peer->second, publish.request_id, *encode_body(response), delay);
}

} // namespace busbar::test
