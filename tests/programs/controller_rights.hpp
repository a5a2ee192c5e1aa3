#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/node_id.hpp>
#include <busbar/core/types.hpp>
#include <busbar/core/variant.hpp>
#include <busbar/crypto/certificate_validator.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/net/blocking_client.hpp>
#include <busbar/net/system.hpp>
#include <busbar/types/method.hpp>

#include "product/access/part_rights.hpp"
#include "programs/controllers.hpp"

/// A busbar-controller with everything that can be administered, those who log in there, and which
/// row of the tables of rights each of its Methods and Variables belongs to.
namespace busbar::test {

using administration::detail::Rights;
using administration::detail::Roles;

/// What a node's row says. Arguments of a Method belong to its row.
struct RowOfNode {
    Rights rights;
    std::uint16_t channel;
};

/// A Method or a Variable that was found in the running controller.
struct FoundNode {
    std::string path; // "Server/ServerConfiguration/ApplyChanges"
    NodeId id;
    NodeId object; // the node above
    bool is_method;
    bool is_argument;
    bool is_writable;
    RowOfNode row;
};

/// Everything that lies below Objects and Server.
struct Crawl {
    /// Of administration and product.
    std::vector<FoundNode> nodes;
    /// Holds those that are of neither, such as the variables of the PLC.
    std::size_t others{0};
    /// Those that no table has.
    std::vector<std::string> unknown;

    /// Null if there is none.
    [[nodiscard]] const FoundNode* find(std::string_view path) const;
};

enum class Channel : std::uint8_t { None, Sign, SignAndEncrypt };

/// A session with the controller, closed with the object.
class RightsClient {
public:
    /// An empty name is an anonymous user. Fails the test if there is no session.
    RightsClient(const class RightsPlant& plant, const std::string& user, Channel channel);

    [[nodiscard]] net::BlockingClient& blocking() { return client_; }
    template <typename Response, typename Request>
    [[nodiscard]] Result<Response> call(Request request)
    {
        return client_.call<Response>(std::move(request));
    }
    /// One Method; a service fault is its status.
    [[nodiscard]] CallMethodResult on(const NodeId& object, const NodeId& method,
                                      std::vector<Variant> inputs);
    [[nodiscard]] Variant read(const NodeId& variable);
    /// Hands the session on to another user; fails the test if that is refused.
    void change_user(const std::string& user);
    /// The same with a password; the name of the status.
    [[nodiscard]] std::string try_user(const std::string& user, const std::string& password);

private:
    NullLog log_;
    crypto::SystemRandom random_;
    net::SystemWallClock wall_clock_;
    crypto::InsecureAcceptAnyCertificate any_;
    channel::ChannelEnvironment environment_;
    net::BlockingClient client_;
};

/// The controller. Users have the name of their role; "chief" has all of them, "nobody" none, and
/// "pat" those that rules give.
class RightsPlant {
public:
    static constexpr const char* password = "patience is all";

    enum class Mode : std::uint8_t { Variables, Model };
    explicit RightsPlant(Mode mode);

    [[nodiscard]] std::string url() const { return controller_->url(); }
    [[nodiscard]] const channel::ApplicationIdentity& identity() const { return identity_; }
    [[nodiscard]] ::pid_t process() const { return controller_->process(); }
    [[nodiscard]] RightsClient& chief() { return *chief_; }
    [[nodiscard]] const Crawl& crawl() const { return crawl_; }
    /// A rule that gives the role to "pat", and takes it again. Fails the test if it does not.
    void give(const std::string& role) { change_rule(role, "AddIdentity"); }
    void take(const std::string& role) { change_rule(role, "RemoveIdentity"); }
    /// The Call that takes it.
    [[nodiscard]] CallRequest taking(const std::string& role) const;

private:
    void change_rule(const std::string& role, const std::string& method);
    [[nodiscard]] CallMethodRequest rule_call(const std::string& role,
                                              const std::string& method) const;

    ScratchFolder scratch_;
    channel::ApplicationIdentity identity_;
    std::optional<Controller> controller_;
    std::optional<RightsClient> chief_;
    Crawl crawl_;
};

} // namespace busbar::test
