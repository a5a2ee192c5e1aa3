// Reads the time of a server's clock three times: with callbacks, with futures, in a coroutine.
// usage: EXAMPLE_PASSWORD=... three-clients URL
#include <cstdio>
#include <cstdlib>
#include <thread>

#include <asio/executor_work_guard.hpp>
#include <asio/io_context.hpp>
#include <asio/use_future.hpp>
#ifdef ASIO_HAS_CO_AWAIT
#include <asio/co_spawn.hpp>
#include <asio/detached.hpp>
#include <asio/use_awaitable.hpp>
#endif

#include <busbar/client/attributes.hpp>
#include <busbar/client/value_text.hpp>
#include <busbar/net/application.hpp>
#include <busbar/net/async_client.hpp>
#include <busbar/types/ids.hpp>

using namespace busbar;
using namespace std::chrono_literals;

namespace {

int shown = 0;

void show(const char* how, const Result<ReadResponse>& response)
{
    if (!response || response->results.size() != 1) {
        std::fprintf(stderr, "%s: no answer\n", how);
        return;
    }
    std::printf("%s: %s\n", how, client::to_text(response->results[0].value).c_str());
    ++shown;
}

ReadRequest read_time()
{
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Neither;
    request.nodes_to_read = {client::attribute_of(NodeId{0, id::Server_ServerStatus_CurrentTime})};
    return request;
}

/// Everything happens in run(), which returns when there is nothing left to do.
void with_callbacks(const client::ClientConfig& config, const channel::ChannelEnvironment& outside)
{
    asio::io_context context;
    net::AsyncClient client{context.get_executor(), config, outside};
    client.connect(10s, [&](const Result<void>& connected) {
        if (!connected) {
            client.close([] {});
            return;
        }
        client.call<ReadResponse>(read_time(), [&](const Result<ReadResponse>& response) {
            show("callbacks", response);
            client.close([] {});
        });
    });
    context.run();
}

/// One thread serves the connection, another one waits.
void with_futures(const client::ClientConfig& config, const channel::ChannelEnvironment& outside)
{
    asio::io_context context;
    auto work = asio::make_work_guard(context);
    std::thread thread{[&] { context.run(); }};
    {
        net::AsyncClient client{context.get_executor(), config, outside};
        const Result<void> connected = client.connect(10s, asio::use_future).get();
        if (connected) {
            show("futures", client.call<ReadResponse>(read_time(), asio::use_future).get());
        }
        client.close(asio::use_future).get();
        work.reset();
        thread.join();
    }
}

#ifdef ASIO_HAS_CO_AWAIT
asio::awaitable<void> read_once(net::AsyncClient& client)
{
    const Result<void> connected = co_await client.connect(10s, asio::use_awaitable);
    if (connected) {
        const Result<ReadResponse> response =
            co_await client.call<ReadResponse>(read_time(), asio::use_awaitable);
        show("coroutine", response);
    }
    co_await client.close(asio::use_awaitable);
}

void in_a_coroutine(const client::ClientConfig& config, const channel::ChannelEnvironment& outside)
{
    asio::io_context context;
    net::AsyncClient client{context.get_executor(), config, outside};
    asio::co_spawn(context, read_once(client), asio::detached);
    context.run();
}
constexpr int ways = 3;
#else
void in_a_coroutine(const client::ClientConfig&, const channel::ChannelEnvironment&) {}
constexpr int ways = 2; // the compiler has no coroutines
#endif

} // namespace

int main(int argc, char** argv)
{
    const char* const password = std::getenv("EXAMPLE_PASSWORD");
    if (argc < 2 || password == nullptr) {
        std::fprintf(stderr, "usage: EXAMPLE_PASSWORD=... three-clients URL\n");
        return 2;
    }
    net::StderrLog log{LogLevel::Warning};
    const auto application = net::Application::open(
        {"urn:example:three-clients", "Three clients", "three_clients_pki"}, log);
    if (!application) {
        std::fprintf(stderr, "%s\n", text(application.error()).c_str());
        return 1;
    }
    client::ClientConfig config = (*application)->client_config(argv[1]);
    config.identity = client::NamedUser{"operator", password};
    const channel::ChannelEnvironment& outside = (*application)->client_environment();
    with_callbacks(config, outside);
    with_futures(config, outside);
    in_a_coroutine(config, outside);
    return shown == ways ? 0 : 1;
}
