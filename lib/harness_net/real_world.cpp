#include <busbar/harness_net/real_world.hpp>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <random>
#include <vector>

#include <asio/executor_work_guard.hpp>
#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/core/text.hpp>
#include <busbar/net/system.hpp>

#include "socket_end.hpp"

namespace busbar::harness {

using asio::ip::tcp;

namespace {

/// Real servers at one address, for connections of the world.
class Way final : public Acceptor {
public:
    Way(asio::io_context& context, channel::EndpointUrl address, LogSink& log)
        : context_{context}, address_{std::move(address)}, log_{log}
    {
    }

    [[nodiscard]] bool accept(const std::shared_ptr<Link>& link,
                              std::string_view /*peer_address*/) override
    {
        asio::error_code error;
        const auto found =
            tcp::resolver{context_}.resolve(address_.host, std::to_string(address_.port), error);
        if (error) {
            tell(error.message());
            return false;
        }
        const auto end = std::make_shared<detail::SocketEnd>(tcp::socket{context_}, Side::Server);
        link->attach(Side::Server, *end);
        end->begin(link, found, [this](const std::string& why) { tell(why); });
        ends.push_back(end);
        return true;
    }

    std::vector<std::weak_ptr<detail::SocketEnd>> ends;

private:
    void tell(const std::string& why)
    {
        log_.write(LogLevel::Warning, "sockets",
                   "cannot connect to " + printable(address_.host) + ":" +
                       std::to_string(address_.port) + ": " + why);
    }

    asio::io_context& context_;
    channel::EndpointUrl address_;
    LogSink& log_;
};

std::uint64_t new_seed()
{
    return std::getenv("BUSBAR_SEED") != nullptr ? World::seed_from_environment()
                                                 : std::random_device{}();
}

} // namespace

/// The sockets, served while the scheduler waits.
class RealWorld::Sockets final : public Pacer {
public:
    explicit Sockets(World& world) : world_{world} {}

    [[nodiscard]] TimePoint now() const override
    {
        return TimePoint{std::chrono::steady_clock::now() - begin_};
    }
    void wait_until(TimePoint end) override
    {
        // Threads that raise a signal are seen after this time.
        constexpr Duration most = std::chrono::milliseconds{1};
        context_.run_one_for(std::clamp(end - now(), Duration{0}, most));
    }

    [[nodiscard]] Result<std::string> open(std::string_view address, std::uint16_t port);
    Result<void> forward(std::string_view from, std::string_view to);
    [[nodiscard]] std::size_t count();
    void stop();

private:
    struct Listening {
        tcp::acceptor acceptor;
        std::string url;
    };
    using Ends = std::vector<std::weak_ptr<detail::SocketEnd>>;

    void accept_next(Listening& listening);
    void take(const Listening& listening, tcp::socket socket);
    template <typename Work>
    void for_each_end(Work work);

    World& world_;
    std::chrono::steady_clock::time_point begin_{std::chrono::steady_clock::now()};
    asio::io_context context_{1};
    /// Without sockets there is no work, for which the context would stop.
    asio::executor_work_guard<asio::io_context::executor_type> work_{context_.get_executor()};
    std::vector<std::unique_ptr<Listening>> listening_;
    std::vector<std::unique_ptr<Way>> ways_;
    Ends ends_;
};

Result<std::string> RealWorld::Sockets::open(std::string_view address, std::uint16_t port)
{
    asio::error_code error;
    const auto ip = asio::ip::make_address(std::string{address}, error);
    auto made = std::make_unique<Listening>(Listening{tcp::acceptor{context_}, {}});
    const auto step = [&](auto work) {
        if (!error) {
            work();
        }
    };
    const tcp::endpoint wanted{ip, port};
    step([&] { made->acceptor.open(wanted.protocol(), error); });
    step([&] { made->acceptor.set_option(tcp::acceptor::reuse_address{true}, error); });
    step([&] { made->acceptor.bind(wanted, error); });
    step([&] { made->acceptor.listen(asio::socket_base::max_listen_connections, error); });
    tcp::endpoint bound;
    step([&] { bound = made->acceptor.local_endpoint(error); });
    if (error) {
        world_.log().write(LogLevel::Error, "sockets",
                           printable(address) + ":" + std::to_string(port) + ": " +
                               error.message());
        return fail(status::Bad_CommunicationError);
    }
    const std::string host = bound.address().to_string();
    made->url = "opc.tcp://" + (bound.address().is_v6() ? "[" + host + "]" : host) + ":" +
                std::to_string(bound.port());
    accept_next(*made);
    listening_.push_back(std::move(made));
    return listening_.back()->url;
}

void RealWorld::Sockets::accept_next(Listening& listening)
{
    listening.acceptor.async_accept([this, &listening](asio::error_code error, tcp::socket socket) {
        if (error == asio::error::operation_aborted) {
            return;
        }
        if (!error) {
            take(listening, std::move(socket));
        }
        accept_next(listening);
    });
}

void RealWorld::Sockets::take(const Listening& listening, tcp::socket socket)
{
    asio::error_code error;
    const tcp::endpoint peer = socket.remote_endpoint(error);
    const auto end = std::make_shared<detail::SocketEnd>(std::move(socket), Side::Client);
    auto link = error ? fail(status::Bad_ConnectionClosed)
                      : world_.network().connect(listening.url, *end, peer.address().to_string());
    if (!link) {
        return; // the socket closes
    }
    end->begin(*std::move(link));
    ends_.push_back(end);
}

Result<void> RealWorld::Sockets::forward(std::string_view from, std::string_view to)
{
    auto address = channel::EndpointUrl::parse(to);
    if (!address) {
        return fail(address.error());
    }
    auto way = std::make_unique<Way>(context_, *std::move(address), world_.log());
    if (auto listens = world_.network().listen(from, *way); !listens) {
        return listens;
    }
    ways_.push_back(std::move(way));
    return {};
}

template <typename Work>
void RealWorld::Sockets::for_each_end(Work work)
{
    const auto look_at = [&](Ends& ends) {
        std::erase_if(ends, [](const auto& end) { return end.expired(); });
        for (const auto& known : Ends{ends}) {
            if (const auto end = known.lock()) {
                work(*end);
            }
        }
    };
    look_at(ends_);
    for (const auto& way : ways_) {
        look_at(way->ends);
    }
}

std::size_t RealWorld::Sockets::count()
{
    std::size_t count = 0;
    for_each_end([&](detail::SocketEnd&) { ++count; });
    return count;
}

void RealWorld::Sockets::stop()
{
    for (const auto& listening : listening_) {
        asio::error_code ignored;
        listening->acceptor.close(ignored);
    }
    for_each_end([](detail::SocketEnd& end) { end.stop(); });
    for (const auto& way : ways_) {
        world_.network().unlisten(*way);
    }
    context_.poll(); // the handlers of what was closed let go of it
}

RealWorld::RealWorld()
    : World{new_seed(), net::SystemWallClock{}.now()}, sockets_{std::make_unique<Sockets>(*this)}
{
    scheduler().set_pacer(sockets_.get());
}

RealWorld::~RealWorld()
{
    sockets_->stop();
    scheduler().set_pacer(nullptr);
}

Result<std::string> RealWorld::open(std::string_view address, std::uint16_t port)
{
    return sockets_->open(address, port);
}

Result<void> RealWorld::reach(std::string_view url)
{
    return sockets_->forward(url, url);
}

Result<void> RealWorld::forward(std::string_view from, std::string_view to)
{
    return sockets_->forward(from, to);
}

std::size_t RealWorld::socket_count() const
{
    return sockets_->count();
}

} // namespace busbar::harness
