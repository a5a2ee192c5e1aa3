#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/channel/server_channel.hpp>
#include <busbar/harness/scripted_server.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/discovery.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/session.hpp>
#include <busbar/types/subscription.hpp>
#include <busbar/types/view.hpp>

#include "harness_names.hpp"

namespace busbar::test {

/// How a service of a MoodyServer answers.
enum class Mood : std::uint8_t {
    Well,
    Silent,         // never
    Refuses,        // with a ServiceFault
    RefusesResults, // the service is good, every result in it bad
    Empty,          // a response without contents
    Endless,        // there is always more, and revised values are beyond all bounds
    Late,
    Strange, // a response of another service
    HangsUp, // the connection breaks
};

/// A server without security and with few services, each of which has a mood of its own. It can
/// forget its sessions or Subscriptions, or be deaf: take connections and read nothing. It can
/// answer everything but the renewal of a channel. Servers may register with it.
///
/// Its variables change every 20 seconds.
class MoodyServer final : public harness::Acceptor {
public:
    MoodyServer(World& world, std::string_view url);
    ~MoodyServer() override;

    /// Answers everything from now on as Part 4 has it.
    void be_well();
    /// Some services get other moods.
    void change_moods();
    void forget_sessions();
    void forget_subscriptions();
    /// What ails it, for a trace.
    [[nodiscard]] std::string ailments() const;

    /// When a Publish response of that Subscription was sent last.
    [[nodiscard]] TimePoint last_message(std::uint32_t subscription) const;
    /// Requests that arrived.
    [[nodiscard]] std::uint64_t requests() const { return requests_; }
    /// Renewals of channels that were not answered.
    [[nodiscard]] std::uint64_t ignored_renewals() const { return ignored_renewals_; }

    // Acceptor
    [[nodiscard]] bool accept(const std::shared_ptr<Link>& link,
                              std::string_view peer_address) override;

private:
    class Peer;
    struct Ailment {
        Mood mood{Mood::Well};
        StatusCode status;
        Duration delay{0};
    };
    struct PendingPublish {
        std::uint64_t peer;
        std::uint32_t request_id;
        std::uint32_t request_handle;
    };
    struct Session {
        bool is_active{false};
        std::deque<PendingPublish> publishes;
    };
    struct Subscription {
        std::uint32_t session;
        Duration interval;
        std::uint32_t keep_alive_count;
        std::uint32_t lifetime_count;
        std::map<std::uint32_t, std::uint32_t> items; // client's handles by the server's
        std::uint32_t last_item{0};
        std::uint32_t last_number{0};
        std::uint32_t idle_count{0};
        std::uint32_t unheard_count{0};
        std::int64_t last_value{-1};
        std::unique_ptr<Alarm> alarm;
    };
    /// One request and where it came from.
    struct Incoming {
        Peer& peer;
        std::uint32_t request_id;
        std::span<const std::byte> body;
    };

    void handle(const Incoming& incoming);
    template <typename Request, typename Response>
    bool serve(const Incoming& incoming, Result<Response> (MoodyServer::*answer)(const Request&));
    bool publish(const Incoming& incoming);
    void send(Peer& peer, std::uint32_t request_id, std::vector<std::byte> body, Duration delay);
    void refuse(const Incoming& incoming, std::uint32_t handle, StatusCode status, Duration delay);
    void be_due(std::uint32_t subscription);
    void notify(std::uint32_t id, Subscription& subscription, const PendingPublish& publish);
    [[nodiscard]] std::int64_t value() const;
    [[nodiscard]] Ailment ailment_of(std::uint32_t service) const;
    [[nodiscard]] Result<Session*> session_of(const RequestHeader& header);

    Result<FindServersResponse> find_servers(const FindServersRequest& request);
    Result<RegisterServerResponse> register_server(const RegisterServerRequest& request);
    Result<RegisterServer2Response> register_server2(const RegisterServer2Request& request);
    Result<GetEndpointsResponse> get_endpoints(const GetEndpointsRequest& request);
    Result<CreateSessionResponse> create_session(const CreateSessionRequest& request);
    Result<ActivateSessionResponse> activate_session(const ActivateSessionRequest& request);
    Result<CloseSessionResponse> close_session(const CloseSessionRequest& request);
    Result<ReadResponse> read(const ReadRequest& request);
    Result<WriteResponse> write(const WriteRequest& request);
    Result<CallResponse> call(const CallRequest& request);
    Result<BrowseResponse> browse(const BrowseRequest& request);
    Result<BrowseNextResponse> browse_next(const BrowseNextRequest& request);
    Result<TranslateBrowsePathsToNodeIdsResponse>
    translate(const TranslateBrowsePathsToNodeIdsRequest& request);
    Result<RegisterNodesResponse> register_nodes(const RegisterNodesRequest& request);
    Result<UnregisterNodesResponse> unregister_nodes(const UnregisterNodesRequest& request);
    Result<CreateSubscriptionResponse> create(const CreateSubscriptionRequest& request);
    Result<ModifySubscriptionResponse> modify(const ModifySubscriptionRequest& request);
    Result<DeleteSubscriptionsResponse> remove(const DeleteSubscriptionsRequest& request);
    Result<SetPublishingModeResponse> set_mode(const SetPublishingModeRequest& request);
    Result<TransferSubscriptionsResponse> transfer(const TransferSubscriptionsRequest& request);
    Result<RepublishResponse> republish(const RepublishRequest& request);
    Result<CreateMonitoredItemsResponse> create_items(const CreateMonitoredItemsRequest& request);
    Result<ModifyMonitoredItemsResponse> modify_items(const ModifyMonitoredItemsRequest& request);
    Result<SetMonitoringModeResponse> set_monitoring(const SetMonitoringModeRequest& request);
    Result<SetTriggeringResponse> set_triggering(const SetTriggeringRequest& request);
    Result<DeleteMonitoredItemsResponse> delete_items(const DeleteMonitoredItemsRequest& request);

    World& world_;
    std::string url_;
    Chance chance_;
    harness::SeededRandom random_;
    crypto::InsecureAcceptAnyCertificate accept_any_;
    NullLog log_;
    bool is_deaf_{false};
    bool ignores_renewals_{false};
    std::uint64_t ignored_renewals_{0};
    std::map<std::uint32_t, Ailment> ailments_; // by the encoding id of the request
    std::map<std::uint32_t, Session> sessions_; // by authentication token
    std::map<std::uint32_t, Subscription> subscriptions_;
    std::map<std::uint32_t, TimePoint> messages_;
    std::uint32_t last_id_{0};
    std::uint64_t requests_{0};
    std::map<std::uint64_t, std::unique_ptr<Peer>> peers_;
    std::uint64_t last_peer_{0};
};

} // namespace busbar::test
