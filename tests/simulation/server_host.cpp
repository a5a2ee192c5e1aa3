#include "server_host.hpp"

#include <utility>

namespace busbar::test {

using namespace std::chrono_literals;

/// The server's end of a link.
class ServerHost::Peer final : public LinkEnd {
public:
    Peer(ServerHost& host, server::Connection connection, std::shared_ptr<SimulatedLink> link)
        : host_{host}, connection_{std::move(connection)}, link_{std::move(link)},
          deadline_{host.scheduler_, [this] {
                        connection_.handle_deadline(host_.scheduler_.now());
                        update();
                        host_.settle();
                    }}
    {
        update();
    }

    [[nodiscard]] std::span<const std::byte> output() const override
    {
        return connection_.output();
    }
    void consume(std::size_t size) override { connection_.consume(size); }
    void feed(std::span<const std::byte> in) override
    {
        static_cast<void>(connection_.feed(in, host_.scheduler_.now()));
        update();
        host_.settle();
    }
    void link_lost() override { end(); }

    void update()
    {
        while (connection_.next_event()) {
        }
        link_->flush(SimulatedLink::Server);
        if (connection_.is_closed() && connection_.output().empty()) {
            link_->close(SimulatedLink::Server);
            end();
        } else {
            deadline_.set(connection_.next_deadline());
        }
    }

private:
    void end()
    {
        deadline_.cancel();
        if (!std::exchange(has_ended_, true)) {
            host_.scheduler_.after(0ns, [&host = host_, id = connection_.id()] { //
                host.forget(id);
            });
        }
    }

    ServerHost& host_;
    server::Connection connection_;
    std::shared_ptr<SimulatedLink> link_;
    bool has_ended_{false};
    Alarm deadline_;
};

ServerHost::ServerHost(Scheduler& scheduler, const WallClock& clock, Chance chance,
                       server::ServerConfig config)
    : scheduler_{scheduler}, chance_{chance}, random_{chance_.next()},
      deadline_{scheduler,
                [this] {
                    server_->handle_deadline(scheduler_.now());
                    settle();
                }},
      completions_{scheduler, [this] {
                       server_->handle_completions(scheduler_.now());
                       settle();
                   }}
{
    const server::ServerEnvironment environment{&random_, &clock,  &log_, &validator_,
                                                &users_,  nullptr, this};
    server_ = std::make_unique<server::Server>(
        server::Server::create(std::move(config), environment).value());
    server_->start(scheduler.now());
    settle();
}

ServerHost::~ServerHost()
{
    peers_.clear();
}

bool ServerHost::accept(const std::shared_ptr<SimulatedLink>& link, std::string_view peer_address)
{
    auto connection = server_->connect(peer_address, scheduler_.now());
    if (!connection) {
        return false;
    }
    const std::uint64_t id = connection->id();
    auto peer = std::make_unique<Peer>(*this, *std::move(connection), link);
    link->attach(SimulatedLink::Server, *peer);
    peers_.emplace(id, std::move(peer));
    settle();
    return true;
}

void ServerHost::wake()
{
    // Threads get their turn at once, as a rule, and sometimes when there were more scans.
    if (!completions_.is_set()) {
        completions_.set_after(chance_.one_in(8) ? chance_.between(0ms, 250ms)
                                                 : chance_.between(0ms, 2ms));
    }
}

void ServerHost::settle()
{
    log_.text.clear();
    while (const auto id = server_->next_changed()) {
        if (const auto found = peers_.find(*id); found != peers_.end()) {
            found->second->update();
        }
    }
    deadline_.set(server_->next_deadline());
}

void ServerHost::forget(std::uint64_t id)
{
    peers_.erase(id);
    settle();
}

} // namespace busbar::test
