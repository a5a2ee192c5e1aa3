#include "hostile_ends.hpp"

#include <utility>

#include "login_requests.hpp"
#include "support/login.hpp"

namespace busbar::test {

namespace {

/// Keeps back what an attacker does not want to arrive, and records.
class TamperingFilter final : public LinkFilter {
public:
    explicit TamperingFilter(std::shared_ptr<Tampering> tampering)
        : tampering_{std::move(tampering)}
    {
    }

    void pass(Link& link, Side from, std::span<const std::byte> bytes) override
    {
        constexpr std::size_t most = 16'384;
        if (from == Side::Client && tampering_->record != nullptr &&
            tampering_->record->size() < most) {
            tampering_->record->insert(tampering_->record->end(), bytes.begin(), bytes.end());
        }
        if (from == Side::Client && tampering_->withholds) {
            if (std::exchange(tampering_->has_withheld, true)) {
                return;
            }
            bytes = bytes.first(bytes.size() - 1);
        }
        link.send(from, bytes);
    }

private:
    std::shared_ptr<Tampering> tampering_;
};

} // namespace

HostileSocket::HostileSocket(const HostileParts& parts, const std::string& address, Chance chance,
                             std::vector<std::byte> bytes)
    : bytes_{std::move(bytes)}, link_{
                                    std::make_shared<Link>(parts.scheduler, parts.weather, chance)}
{
    link_->attach(Side::Client, *this);
    if (!parts.host.accept(link_, address)) {
        has_ended_ = true;
        return;
    }
    link_->flush(Side::Client);
}

HostileSocket::~HostileSocket()
{
    if (!has_ended_) {
        link_->leave(Side::Client);
    }
}

HostilePort::HostilePort(const HostileParts& parts, const std::string& address, Chance chance,
                         Then then, std::shared_ptr<std::vector<std::byte>> record)
    : parts_{parts}, random_{chance.next()}, then_{std::move(then)}, is_secure_{record != nullptr}
{
    tampering_->record = std::move(record);
    const auto link =
        std::make_shared<Link>(parts.scheduler, parts.weather, Chance{chance.next(), 1});
    link->set_filter(std::make_unique<TamperingFilter>(tampering_));
    channel::ClientChannelConfig config;
    config.endpoint_url = "opc.tcp://localhost:4840";
    if (is_secure_) {
        config.security = setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt);
        config.server_certificate = server_identity().certificates.front();
    }
    const channel::ChannelEnvironment environment{.random = &random_,
                                                  .wall_clock = &parts.clock,
                                                  .log = &log_,
                                                  .validator = &validator_,
                                                  .identity = &client_identity()};
    ClientPort::Owner& owner = *this;
    port_ =
        std::make_unique<ClientPort>(parts.scheduler, std::move(config), environment, link, owner);
    link->attach(Side::Client, *port_);
    if (parts.host.accept(link, address)) {
        port_->update();
    } else {
        port_->close(false);
    }
}

HostilePort::~HostilePort()
{
    port_->close(false);
}

void HostilePort::create_session(std::function<void(const CreateSessionResponse&)> then)
{
    port_->call<CreateSessionResponse>(session_request(is_secure_),
                                       [then = std::move(then)](const auto& response) {
                                           if (response) {
                                               then(*response);
                                           }
                                       });
}

void HostilePort::log_in(const std::string& name, const std::string& password, Then then)
{
    create_session(
        [this, name, password, then = std::move(then)](const CreateSessionResponse& created) {
            token_ = created.authentication_token;
            send<ActivateSessionResponse>(
                activation_request(*port_->security().policy, name, password, created.server_nonce),
                [this, then](const Result<ActivateSessionResponse>& activated) {
                    if (activated) {
                        then(*this);
                    }
                });
        });
}

} // namespace busbar::test
