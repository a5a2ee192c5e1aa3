#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <busbar/types/session.hpp>

#include "client_port.hpp"
#include "harness_names.hpp"
#include "support/identity.hpp"
#include "support/server_fixture.hpp"
#include "trace.hpp"

namespace busbar::test {

/// What all attackers of a simulation share.
struct HostileParts {
    Scheduler& scheduler;
    const WallClock& clock;
    const Weather& weather;
    ServerHost& host;
    Trace& trace;
    /// How many clients there are beside them.
    std::size_t others;
};

/// A connection on which some bytes are sent, whatever comes back.
class HostileSocket final : public LinkEnd {
public:
    HostileSocket(const HostileParts& parts, const std::string& address, Chance chance,
                  std::vector<std::byte> bytes);
    ~HostileSocket() override;

    [[nodiscard]] bool has_ended() const { return has_ended_; }

    // LinkEnd
    [[nodiscard]] std::span<const std::byte> output() const override
    {
        return std::span{bytes_}.subspan(sent_);
    }
    void consume(std::size_t size) override { sent_ += size; }
    void feed(std::span<const std::byte> /*in*/) override {}
    void link_lost() override { has_ended_ = true; }

private:
    std::vector<std::byte> bytes_;
    std::size_t sent_{0};
    std::shared_ptr<Link> link_;
    bool has_ended_{false};
};

/// What happens to the bytes of a HostilePort on their way.
struct Tampering {
    /// The first bytes are recorded there, if it is set.
    std::shared_ptr<std::vector<std::byte>> record;
    /// Set: the last byte of what is sent from now on does not arrive, nor does anything after it.
    bool withholds{false};
    bool has_withheld{false};
};

/// A client's connection of an attacker, which does one thing when its channel is open.
class HostilePort final : private ClientPort::Owner {
public:
    using Then = std::function<void(HostilePort&)>;

    /// With `record` the channel is a secure one, and what it sends is kept there.
    HostilePort(const HostileParts& parts, const std::string& address, Chance chance, Then then,
                std::shared_ptr<std::vector<std::byte>> record = nullptr);
    ~HostilePort() override;

    /// A session, activated by a user of that name with that password; then `then`.
    void log_in(const std::string& name, const std::string& password, Then then);
    void create_session(std::function<void(const CreateSessionResponse&)> then);
    template <typename Response, typename Request>
    void send(
        Request request, std::function<void(Result<Response>)> then = [](const auto&) {})
    {
        request.request_header.authentication_token = token_;
        port_->call<Response>(request, std::move(then));
    }
    [[nodiscard]] const std::shared_ptr<Tampering>& tampering() const { return tampering_; }
    [[nodiscard]] bool has_ended() const { return has_ended_; }

private:
    void channel_opened() override { then_(*this); }
    void channel_closed() override { has_ended_ = true; }

    const HostileParts& parts_;
    SeededRandom random_;
    NullLog log_;
    crypto::InsecureAcceptAnyCertificate validator_;
    std::shared_ptr<Tampering> tampering_{std::make_shared<Tampering>()};
    Then then_;
    bool is_secure_;
    NodeId token_;
    bool has_ended_{false};
    std::unique_ptr<ClientPort> port_;
};

} // namespace busbar::test
